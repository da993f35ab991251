// The kinds of sampler beside the default: each uniform in every dimension, each stratified as its
// kind promises, none correlated where it must not be, and named in the documentation.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <functional>
#include <sstream>
#include <vector>

#include "core/integrate/sampler.h"
#include "oracles/stats/chi2.h"
#include "oracles/stats/ztest.h"

namespace talbot {
namespace {

// Pairs of the camera, of the first and of later vertices, past Halton's table, of media.
const uint32_t kPairs[] = {0, 1, 2, 3, 6, 40, 126, 127, 900, medium_pair(3), 0xFFFFFFFFu};

// What the numbers of one pair look like in 16 x 16 cells, over pixels and samples.
double uniformity(SamplerKind kind, uint32_t pair, const std::function<float(float)>& fault) {
    constexpr int kSide = 16;
    constexpr uint32_t kPixels = 30;
    constexpr uint32_t kSamples = 48;  // no multiple of what any kind stratifies over
    std::vector<double> observed(kSide * kSide, 0);
    for (uint32_t y = 0; y < kPixels; ++y) {
        for (uint32_t x = 0; x < kPixels; ++x) {
            for (uint32_t i = 0; i < kSamples; ++i) {
                const Vec2f u = Sampler(kind, 17, x, y, i).pair(pair);
                EXPECT_TRUE(u.x >= 0 && u.x < 1 && u.y >= 0 && u.y < 1);
                const int column = static_cast<int>(fault(u.x) * kSide);
                const int row = static_cast<int>(u.y * kSide);
                ++observed[static_cast<std::size_t>(row * kSide + column)];
            }
        }
    }
    const std::vector<double> expected(observed.size(),
                                       kPixels * kPixels * kSamples / double(observed.size()));
    return stats::chi2_test(observed, expected).p;
}

TEST(SamplerKinds, EveryDimensionIsUniform) {
    const double limit = stats::sidak(stats::kFalseAlarm, kSamplers.size() * std::size(kPairs));
    for (const SamplerInfo& info : kSamplers) {
        for (const uint32_t pair : kPairs)
            EXPECT_GT(uniformity(info.kind, pair, [](float u) { return u; }), limit)
                << info.name << ", pair " << pair;
    }
    // The control: numbers that are moved by up to four per cent.
    const auto bent = [](float u) { return u + 0.16f * u * (1 - u); };
    EXPECT_LT(uniformity(SamplerKind::independent, 2, bent), limit);
    EXPECT_LT(uniformity(SamplerKind::halton, 2, bent), limit);
}

// Cells of a grid of columns x rows that do not hold exactly `each` of these points.
int wrong_cells(const std::vector<Vec2f>& points, uint32_t columns, uint32_t rows, int each = 1) {
    std::vector<int> count(std::size_t{columns} * rows, 0);
    for (const Vec2f& p : points) {
        // In double: a float product may round up to the next cell.
        const auto column = static_cast<std::size_t>(static_cast<double>(p.x) * columns);
        const auto row = static_cast<std::size_t>(static_cast<double>(p.y) * rows);
        ++count[row * columns + column];
    }
    int wrong = 0;
    for (const int c : count) wrong += c != each;
    return wrong;
}

std::vector<Vec2f> points_of(SamplerKind kind, uint32_t pair, uint64_t first, uint64_t count) {
    std::vector<Vec2f> points;
    for (uint64_t i = first; i < first + count; ++i)
        points.push_back(Sampler(kind, 5, 12, 34, i).pair(pair));
    return points;
}

TEST(SamplerKinds, StratifiedSetsFillCellsRowsAndColumns) {
    for (const uint32_t pair : kPairs) {
        for (const uint64_t first : {uint64_t{0}, uint64_t{64 * 5}, (uint64_t{1} << 32) - 64}) {
            const std::vector<Vec2f> set = points_of(SamplerKind::stratified, pair, first, 64);
            EXPECT_EQ(wrong_cells(set, 8, 8), 0) << "pair " << pair << ", from " << first;
            EXPECT_EQ(wrong_cells(set, 64, 1), 0) << "pair " << pair << ", from " << first;
            EXPECT_EQ(wrong_cells(set, 1, 64), 0) << "pair " << pair << ", from " << first;
        }
    }
    // The controls: half a set later, and independent numbers.
    EXPECT_GT(wrong_cells(points_of(SamplerKind::stratified, 2, 32, 64), 8, 8), 8);
    EXPECT_GT(wrong_cells(points_of(SamplerKind::independent, 2, 0, 64), 8, 8), 8);
}

TEST(SamplerKinds, HaltonPairsFillTheBoxesOfTheirBases) {
    // Pair 0 has bases 2 and 3, pair 1 5 and 7, pair 2 11 and 13.
    EXPECT_EQ(wrong_cells(points_of(SamplerKind::halton, 0, 0, 144), 16, 9), 0);
    EXPECT_EQ(wrong_cells(points_of(SamplerKind::halton, 0, 144 * 3, 144), 16, 9), 0);
    EXPECT_EQ(wrong_cells(points_of(SamplerKind::halton, 0, 0, 144), 4, 3, 12), 0);
    EXPECT_EQ(wrong_cells(points_of(SamplerKind::halton, 1, 0, 35), 5, 7), 0);
    EXPECT_EQ(wrong_cells(points_of(SamplerKind::halton, 1, 35 * 4, 35 * 5), 25, 7), 0);
    EXPECT_EQ(wrong_cells(points_of(SamplerKind::halton, 2, 143, 143), 11, 13), 0);
    // The last of the table: bases 1607 and 1609.
    EXPECT_EQ(wrong_cells(points_of(SamplerKind::halton, 126, 0, 1607), 1607, 1), 0);
    EXPECT_EQ(wrong_cells(points_of(SamplerKind::halton, 126, 0, 1609), 1, 1609), 0);
    // The controls: the boxes of other bases, and past the table.
    EXPECT_GT(wrong_cells(points_of(SamplerKind::halton, 1, 0, 144), 16, 9), 8);
    EXPECT_GT(wrong_cells(points_of(SamplerKind::halton, 127, 0, 144), 16, 9), 8);
}

// The elementary intervals of 2^log_count points.
int wrong_intervals(const std::vector<Vec2f>& points, uint32_t log_count) {
    int wrong = 0;
    for (uint32_t k = 0; k <= log_count; ++k)
        wrong += wrong_cells(points, 1u << k, 1u << (log_count - k));
    return wrong;
}

// Samples first..first+count-1 of an aligned square of pixels.
std::vector<Vec2f> square_of(SamplerKind kind, uint32_t pair, uint32_t x0, uint32_t y0,
                             uint32_t side, uint64_t first, uint64_t count) {
    std::vector<Vec2f> points;
    for (uint32_t y = y0; y < y0 + side; ++y) {
        for (uint32_t x = x0; x < x0 + side; ++x) {
            for (uint64_t i = first; i < first + count; ++i)
                points.push_back(Sampler(kind, 5, x, y, i).pair(pair));
        }
    }
    return points;
}

TEST(SamplerKinds, ZSobolFillsIntervalsInPixelsAndOverThem) {
    for (const uint32_t pair : kPairs) {
        EXPECT_EQ(wrong_intervals(points_of(SamplerKind::zsobol, pair, 64, 64), 6), 0);
        EXPECT_EQ(wrong_intervals(points_of(SamplerKind::zsobol, pair, 256, 256), 8), 0);
        EXPECT_EQ(wrong_intervals(square_of(SamplerKind::zsobol, pair, 16, 40, 8, 0, 1), 6), 0);
        EXPECT_EQ(wrong_intervals(square_of(SamplerKind::zsobol, pair, 4096, 8, 4, 1, 1), 4), 0);
        EXPECT_EQ(wrong_intervals(square_of(SamplerKind::zsobol, pair, 16, 40, 4, 4, 4), 6), 0);
    }
    // The controls: a square across the curve, and the default, whose pixels know nothing of each
    // other.
    EXPECT_GT(wrong_intervals(square_of(SamplerKind::zsobol, 2, 12, 44, 8, 0, 1), 6), 8);
    EXPECT_GT(wrong_intervals(square_of(SamplerKind::sobol, 2, 16, 40, 8, 0, 1), 6), 8);
}

// Variance of the mean error of 4x4 pixels with n samples each over that of independent pixels, for
// the area under a diagonal edge.
double low_frequency_noise(SamplerKind kind, uint64_t n) {
    stats::Moments blocks, pixels;
    for (uint32_t by = 0; by < 32; ++by) {
        for (uint32_t bx = 0; bx < 32; ++bx) {
            double block = 0;
            for (uint32_t k = 0; k < 16; ++k) {
                double pixel = 0;
                for (uint64_t i = 0; i < n; ++i) {
                    const Vec2f u = Sampler(kind, 9, 4 * bx + k % 4, 4 * by + k / 4, i).pair(3);
                    pixel += u.x + u.y < 0.8f ? 1.0 : 0.0;
                }
                pixels.add(pixel / static_cast<double>(n));
                block += pixel / static_cast<double>(n) / 16;
            }
            blocks.add(block);
        }
    }
    return blocks.variance() * 16 / pixels.variance();
}

TEST(SamplerKinds, ErrorsOfZSobolAreBlueNoise) {
    EXPECT_LT(low_frequency_noise(SamplerKind::zsobol, 1), 0.35);
    EXPECT_LT(low_frequency_noise(SamplerKind::zsobol, 4), 0.6);
    EXPECT_NEAR(low_frequency_noise(SamplerKind::sobol, 1), 1, 0.2);
    EXPECT_NEAR(low_frequency_noise(SamplerKind::stratified, 1), 1, 0.2);
}

TEST(SamplerKinds, PixelsSeedsPairsAndSamplesAreUncorrelated) {
    constexpr int kCount = 20000;
    const double limit = 4.5 / std::sqrt(static_cast<double>(kCount));
    for (const SamplerInfo& info : kSamplers) {
        double pixels = 0, seeds = 0, pairs = 0, axes = 0, samples = 0, control = 0;
        for (uint32_t i = 0; i < kCount; ++i) {
            const auto at = [&](uint64_t seed, uint32_t x, uint64_t n) {
                return Sampler(info.kind, seed, x, 7 + 64 * i, n);
            };
            const double a = at(1, 12, 0).pair(2).x - 0.5f;
            // The next pixel but that of a Z-curve's block, whose numbers complement each other.
            pixels += a * (at(1, 12 + 4096, 0).pair(2).x - 0.5f);
            seeds += a * (at(2, 12, 0).pair(2).x - 0.5f);
            pairs += a * (at(1, 12, 0).pair(3).x - 0.5f);
            axes += a * (at(1, 12, 0).pair(2).y - 0.5f);
            // Two samples of one Halton sequence complement each other.
            if (info.kind != SamplerKind::halton) samples += a * (at(1, 12, 512).pair(2).x - 0.5f);
            control += a * (at(1, 12, 0).pair(2).x - 0.5f);
        }
        for (const double sum : {pixels, seeds, pairs, axes, samples})
            EXPECT_LT(std::abs(sum / kCount * 12), limit) << info.name;
        EXPECT_GT(std::abs(control / kCount * 12), limit) << "equal numbers are seen";
    }
}

// Root mean square error of the mean of n samples of a smooth function, over pixels.
double smooth_error(SamplerKind kind, uint64_t n) {
    double sum = 0;
    constexpr uint32_t kPixels = 400;
    for (uint32_t pixel = 0; pixel < kPixels; ++pixel) {
        double mean = 0;
        for (uint64_t i = 0; i < n; ++i) {
            const Vec2f u = Sampler(kind, 3, pixel, 2 * pixel, i).pair(2);
            mean += static_cast<double>(u.x) * static_cast<double>(u.y) / static_cast<double>(n);
        }
        sum += (mean - 0.25) * (mean - 0.25);
    }
    return std::sqrt(sum / kPixels);
}

TEST(SamplerKinds, AllButIndependentConvergeSooner) {
    const double independent = smooth_error(SamplerKind::independent, 256);
    // The variance of u v is 1/9 - 1/16.
    EXPECT_NEAR(independent, std::sqrt((1.0 / 9 - 1.0 / 16) / 256), 0.1 * independent);
    for (const SamplerKind kind :
         {SamplerKind::sobol, SamplerKind::stratified, SamplerKind::halton, SamplerKind::zsobol})
        EXPECT_LT(smooth_error(kind, 256), 0.25 * independent) << static_cast<int>(kind);
}

TEST(SamplerKinds, EachIsNamedInTheDocumentation) {
    for (const char* file : {"/README.md", "/docs/interaction.md", "/docs/sampling.md"}) {
        std::ifstream in(std::string(TALBOT_SOURCE_DIR) + file);
        std::stringstream text;
        text << in.rdbuf();
        for (const SamplerInfo& info : kSamplers)
            EXPECT_NE(text.str().find("`" + std::string(info.name) + "`"), std::string::npos)
                << info.name << " in " << file;
    }
}

}  // namespace
}  // namespace talbot
