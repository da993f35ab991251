// The sampler: stratified as a (0,2)-sequence in every pair, uniform, in [0, 1), independent
// between pixels and pairs.
#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <vector>

#include "core/integrate/pixel_filter.h"
#include "core/integrate/sampler.h"

namespace talbot {
namespace {

// Second Sobol' dimension from its direction numbers.
uint32_t sobol_by_direction_numbers(uint32_t index) {
    uint32_t direction = 1u << 31;
    uint32_t value = 0;
    for (int bit = 0; bit < 32; ++bit) {
        if ((index >> bit) & 1u) value ^= direction;
        direction ^= direction >> 1;
    }
    return value;
}

TEST(Sampler, ButterfliesAreTheSecondSobolDimension) {
    for (uint32_t i = 0; i < 100000; ++i) {
        const uint32_t index = hash32(i);
        ASSERT_EQ(reverse_bits(sobol_second_reversed(index)), sobol_by_direction_numbers(index));
    }
}

// Number of elementary intervals of area 1/256 that do not hold exactly one of 256 consecutive
// points.
int broken_intervals(SamplerKind kind, uint64_t start, uint32_t pair) {
    int broken = 0;
    for (int kx = 0; kx <= 8; ++kx) {
        std::vector<int> count(256, 0);
        for (uint64_t i = 0; i < 256; ++i) {
            const Vec2f u = Sampler(kind, 11, 3, 5, start + i).pair(pair);
            const int x = static_cast<int>(u.x * static_cast<float>(1 << kx));
            const int y = static_cast<int>(u.y * static_cast<float>(1 << (8 - kx)));
            ++count[static_cast<std::size_t>(x * (1 << (8 - kx)) + y)];
        }
        for (int c : count) broken += c != 1;
    }
    return broken;
}

TEST(Sampler, SobolPairsFillElementaryIntervals) {
    for (uint32_t pair = 0; pair < 40; ++pair) {
        EXPECT_EQ(broken_intervals(SamplerKind::sobol, 0, pair), 0);
        EXPECT_EQ(broken_intervals(SamplerKind::sobol, 256 * 7, pair), 0);
    }
    EXPECT_EQ(broken_intervals(SamplerKind::sobol, (uint64_t{1} << 52), 3), 0);
    EXPECT_EQ(broken_intervals(SamplerKind::sobol, (uint64_t{1} << 32), 100000), 0);
    // The control: independent numbers do not.
    EXPECT_GT(broken_intervals(SamplerKind::independent, 0, 1), 100);
}

TEST(Sampler, NeverReachesOne) {
    for (uint32_t i = 0; i < 512; ++i) {
        EXPECT_LT(unit_float(0xFFFFFFFFu - i), 1.0f);
        EXPECT_GE(unit_float(i), 0.0f);
    }
    EXPECT_EQ(unit_float(0xFFFFFFFFu), 1 - 0x1p-24f);
    // The control: scaling all 32 bits rounds up to 1.
    EXPECT_EQ(static_cast<float>(0xFFFFFFFFu) * 0x1p-32f, 1.0f);
}

TEST(Sampler, PixelsSeedsAndPairsAreUncorrelated) {
    constexpr int kCount = 20000;
    for (SamplerKind kind : {SamplerKind::sobol, SamplerKind::independent}) {
        double pixels = 0, seeds = 0, pairs = 0, axes = 0;
        for (uint32_t i = 0; i < kCount; ++i) {
            const double a = Sampler(kind, 1, i, 7, 0).pair(2).x - 0.5f;
            pixels += a * (Sampler(kind, 1, i + 1, 7, 0).pair(2).x - 0.5f);
            seeds += a * (Sampler(kind, 2, i, 7, 0).pair(2).x - 0.5f);
            pairs += a * (Sampler(kind, 1, i, 7, 0).pair(3).x - 0.5f);
            axes += a * (Sampler(kind, 1, i, 7, 0).pair(2).y - 0.5f);
        }
        for (double sum : {pixels, seeds, pairs, axes}) {
            EXPECT_LT(std::abs(sum / kCount * 12), 4 / std::sqrt(static_cast<double>(kCount)));
        }
    }
}

TEST(Sampler, NoRepeatsWhereTheIndexPasses32Bits) {
    std::set<std::pair<float, float>> seen;
    for (uint64_t i = (uint64_t{1} << 32) - 8; i < (uint64_t{1} << 32) + 8; ++i) {
        const Vec2f u = Sampler(SamplerKind::sobol, 0, 1, 1, i).pair(0);
        seen.insert({u.x, u.y});
    }
    EXPECT_EQ(seen.size(), 16u);
}

TEST(PixelFilter, BlackmanHarrisHasItsMoments) {
    double mean = 0, variance = 0;
    constexpr int kCount = 1 << 16;
    for (int i = 0; i < kCount; ++i) {
        const float u = (static_cast<float>(i) + 0.5f) / kCount;
        const double x = sample_pixel_filter(FilterKind::blackman_harris, Vec2f(u, 0.5f)).x - 0.5;
        mean += x / kCount;
        variance += x * x / kCount;
    }
    // Second moment of the window over its 3.3 px support, by quadrature of its definition.
    double weight = 0, moment = 0;
    for (int i = 0; i < kCount; ++i) {
        const double x = (i + 0.5) / kCount;
        const double a = 2 * 3.14159265358979323846 * x;
        const double w =
            0.35875 - 0.48829 * std::cos(a) + 0.14128 * std::cos(2 * a) - 0.01168 * std::cos(3 * a);
        weight += w;
        moment += w * (x - 0.5) * (x - 0.5) * 3.3 * 3.3;
    }
    EXPECT_NEAR(mean, 0, 1e-4);
    EXPECT_NEAR(variance / (moment / weight), 1, 5e-3);
}

// The vector of a vertex's numbers holds the same bits as the numbers one by one.
TEST(Sampler, NumbersOfAVertexAreThoseOfItsPairs) {
    for (const SamplerInfo& info : kSamplers) {
        for (uint32_t i = 0; i < 1000; ++i) {
            const Sampler sampler(info.kind, 7 + i % 3, i % 61, i / 61, (uint64_t{i} << 27) + i);
            const uint32_t bounce = i % 70;
            const Bounce numbers = sampler.bounce(bounce);
            EXPECT_EQ(numbers.light(), sampler.pair(bounce, BouncePair::light));
            EXPECT_EQ(numbers.bsdf(), sampler.pair(bounce, BouncePair::bsdf));
            EXPECT_EQ(numbers.light_choice(), sampler.single(bounce, BouncePair::light_choice));
            EXPECT_EQ(numbers.lobe(), sampler.single(bounce, BouncePair::lobe));
            EXPECT_EQ(numbers.roulette(), sampler.single(bounce, BouncePair::roulette));
        }
    }
}

}  // namespace
}  // namespace talbot
