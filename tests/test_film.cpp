// The film: exact sums in any order, closed forms, long accumulations against integer arithmetic,
// and the policy for samples that are not finite or negative.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>
#include <thread>
#include <vector>

#include "core/film/film.h"

namespace talbot {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInf = std::numeric_limits<float>::infinity();

std::vector<float> wide_values(std::size_t count, uint32_t seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> exponent(-60, 40);
    std::vector<float> values(count);
    for (float& v : values) v = std::exp2(exponent(random));
    return values;
}

TEST(ExactSum, IsTheSameInAnyOrder) {
    std::vector<float> values = wide_values(20000, 1);
    ExactSum forward;
    for (float v : values) forward.add(v);
    std::shuffle(values.begin(), values.end(), std::mt19937(2));
    ExactSum shuffled, left, right;
    double plain = 0;
    for (float v : values) shuffled.add(v);
    for (std::size_t i = 0; i < values.size(); ++i) (i % 3 == 0 ? left : right).add(values[i]);
    left.add(right);
    EXPECT_EQ(forward, shuffled);
    EXPECT_EQ(forward, left);
    // The control: a float sum depends on the order.
    float up = 0, down = 0;
    for (float v : values) up += v;
    for (std::size_t i = values.size(); i-- > 0;) down += values[i];
    EXPECT_NE(up, down);
    for (float v : values) plain += static_cast<double>(v);
    EXPECT_NEAR(forward.value() / plain, 1, 1e-12);
}

TEST(ExactSum, ConvertsEveryMagnitude) {
    for (int e = -56; e <= 41; ++e) {
        const float x = std::ldexp(1.0f, e);
        ExactSum sum;
        sum.add(x);
        EXPECT_EQ(sum.value(), static_cast<double>(x)) << e;
        sum.add(-x);
        EXPECT_EQ(sum, ExactSum()) << e;
        sum.add(-x);
        EXPECT_EQ(sum.value(), -static_cast<double>(x)) << e;
    }
    // Full mantissas are exact from 2^-33 on and truncated by less than 2^-56 below.
    for (int e = -80; e < 41; ++e) {
        const float x = std::ldexp(0x1.fffffep0f, e - 1);
        ExactSum sum;
        sum.add(x);
        const double error = static_cast<double>(x) - sum.value();
        EXPECT_GE(error, 0) << e;
        EXPECT_LE(error, e >= -31 ? 0 : 0x1p-56) << e;
    }
    for (float x : {0.0f, -0.0f, std::numeric_limits<float>::denorm_min(), 1e-30f}) {
        ExactSum sum;
        sum.add(x);
        EXPECT_EQ(sum, ExactSum());
    }
}

TEST(ExactSum, HoldsALongRunAtItsLimit) {
    ExactSum block;
    block.add(ExactSum::kLimit);
    for (int doubling = 0; doubling < 29; ++doubling) {
        const ExactSum same = block;
        block.add(same);
    }
    EXPECT_EQ(block.value(), 0x1p70);
}

TEST(Film, MeansOfConstantsAreExact) {
    Film film(3, 2);
    NonFiniteCount counts;
    const Rgb value(0.1f, 1.0f / 3, 1234.567f);
    for (uint64_t s = 0; s < 1000; ++s) {
        for (uint32_t y = 0; y < 2; ++y) {
            for (uint32_t x = 0; x < 3; ++x) film.add(x, y, value, s % 4 == 0, s, counts);
        }
    }
    const ImageRgba image = film.image(true);
    ASSERT_EQ(image.rgb.size(), 6u);
    EXPECT_EQ(image.width, 3u);
    EXPECT_EQ(image.height, 2u);
    for (std::size_t i = 0; i < 6; ++i) {
        EXPECT_EQ(image.rgb[i], value);
        EXPECT_EQ(image.alpha[i], 0.25f);
    }
    EXPECT_EQ(film.total_samples(), 6000u);
    EXPECT_EQ(film.min_samples(), 1000u);
    EXPECT_EQ(counts.total(), 0u);
    EXPECT_TRUE(film.image(false).alpha.empty());
}

TEST(Film, EmptyAndUnevenCounts) {
    const Film none;
    EXPECT_EQ(none.total_samples(), 0u);
    EXPECT_EQ(none.min_samples(), 0u);
    EXPECT_TRUE(none.image(true).rgb.empty());
    Film film(2, 1);
    NonFiniteCount counts;
    film.add(1, 0, Rgb(2), true, 0, counts);
    film.add(1, 0, Rgb(4), false, 1, counts);
    EXPECT_EQ(film.min_samples(), 0u);
    EXPECT_EQ(film.total_samples(), 2u);
    const ImageRgba image = film.image(true);
    EXPECT_EQ(image.rgb[0], Rgb(0));
    EXPECT_EQ(image.alpha[0], 0.0f);
    EXPECT_EQ(image.rgb[1], Rgb(3));
    EXPECT_EQ(image.alpha[1], 0.5f);
    film.clear();
    EXPECT_EQ(film.total_samples(), 0u);
    EXPECT_EQ(film.pixels(), Film(2, 1).pixels());
}

// 2^24 ones stall a float sum; here the mean of a long ramp is compared with its closed form in
// integers.
TEST(Film, LongAccumulationMatchesIntegerArithmetic) {
    constexpr uint64_t kSamples = 20'000'000;
    Film film(1, 1);
    NonFiniteCount counts;
    float naive = 0;
    for (uint64_t s = 0; s < kSamples; ++s) {
        const float x = static_cast<float>(s & 0xFFFFu) * 0x1p-16f;  // exact
        film.add(0, 0, Rgb(1, x, 0.1f), false, s, counts);
        naive += 1;
    }
    EXPECT_EQ(naive, 16777216.0f);
    const uint64_t full = kSamples >> 16, rest = kSamples & 0xFFFFu;
    const uint64_t ramp = full * (65535ull * 65536 / 2) + rest * (rest - 1) / 2;
    const FilmPixel& p = film.pixel(0, 0);
    EXPECT_EQ(p.sum[0].value(), static_cast<double>(kSamples));
    EXPECT_EQ(p.sum[1].value(), static_cast<double>(ramp) * 0x1p-16);
    // 0.1f is an integer over 2^27.
    const uint64_t tenth = static_cast<uint64_t>(std::ldexp(static_cast<double>(0.1f), 27));
    EXPECT_EQ(p.sum[2].value(), static_cast<double>(tenth * kSamples) * 0x1p-27);
    // A thousand-fold more by merging: 2 10^10 samples, exact to rounding.
    Film thousand(1, 1);
    for (int i = 0; i < 1000; ++i) thousand.merge(film);
    const FilmPixel& q = thousand.pixel(0, 0);
    EXPECT_EQ(q.samples, kSamples * 1000);
    EXPECT_EQ(q.sum[0].value(), 2e10);
    EXPECT_NEAR(q.sum[1].value() / (static_cast<double>(ramp) * 1000 * 0x1p-16), 1, 1e-15);
}

TEST(Film, BadSamplesEnterAsZeroAndAreCounted) {
    Film film(4, 4);
    NonFiniteCount counts;
    film.add(3, 2, Rgb(1, kNan, -1), true, 9, counts);
    film.add(0, 1, Rgb(kInf, 1, 1), true, 7, counts);
    film.add(1, 1, Rgb(1, 1, -kInf), true, 7, counts);
    film.add(2, 2, Rgb(1, -1e-20f, 1), true, 8, counts);
    film.add(2, 3, Rgb(1, 3e38f, 2), true, 8, counts);
    film.add(0, 0, Rgb(0.0f, -0.0f, 5), true, 1, counts);
    EXPECT_EQ(counts.nan, 1u);
    EXPECT_EQ(counts.inf, 2u);
    EXPECT_EQ(counts.negative, 1u);
    EXPECT_EQ(counts.overflow, 1u);
    EXPECT_EQ(counts.total(), 5u);
    EXPECT_TRUE(counts.has_first);
    EXPECT_EQ(counts.first_sample, 7u);
    EXPECT_EQ(counts.first_x, 0u);
    EXPECT_EQ(counts.first_y, 1u);
    const ImageRgba image = film.image(true);
    EXPECT_EQ(image.rgb[2 * 4 + 3], Rgb(0));
    EXPECT_EQ(image.rgb[1 * 4 + 0], Rgb(0));
    EXPECT_EQ(image.rgb[1 * 4 + 1], Rgb(0));
    EXPECT_EQ(image.rgb[2 * 4 + 2], Rgb(0));
    EXPECT_EQ(image.rgb[3 * 4 + 2], Rgb(1, ExactSum::kLimit, 2));
    EXPECT_EQ(image.rgb[0], Rgb(0, 0, 5));
    EXPECT_EQ(image.alpha[2 * 4 + 3], 1.0f);
    EXPECT_EQ(film.total_samples(), 6u);
}

TEST(Film, EverySpecialFloatIsSortedIntoItsClass) {
    for (uint32_t high = 0; high < 0x10000u; ++high) {
        for (uint32_t low : {0u, 1u, 0xFFFFu}) {
            const float x = std::bit_cast<float>((high << 16) | low);
            Film film(1, 1);
            NonFiniteCount counts;
            film.add(0, 0, Rgb(x, 0, 0), false, 0, counts);
            EXPECT_EQ(counts.nan, std::isnan(x) ? 1u : 0u);
            EXPECT_EQ(counts.inf, std::isinf(x) ? 1u : 0u);
            EXPECT_EQ(counts.negative, x < 0 && !std::isinf(x) ? 1u : 0u);
            EXPECT_EQ(counts.overflow, x > ExactSum::kLimit && !std::isinf(x) ? 1u : 0u);
            EXPECT_EQ(counts.has_first, counts.total() != 0);
            EXPECT_EQ(film.pixel(0, 0).samples, 1u);
        }
    }
}

TEST(Film, InjectedFaultsAreCountedExactlyAndTheFirstIsDeterministic) {
    constexpr uint32_t kSize = 32;
    constexpr uint64_t kSamples = 256;
    // Rows in any order, split over two records and merged either way.
    const auto run = [&](bool reversed, bool swapped, Film& film) {
        NonFiniteCount records[2];
        for (uint32_t i = 0; i < kSize; ++i) {
            const uint32_t y = reversed ? kSize - 1 - i : i;
            for (uint32_t x = 0; x < kSize; ++x) {
                for (uint64_t s = 0; s < kSamples; ++s) {
                    const uint64_t key = (s * kSize + y) * kSize + x;
                    Rgb value(0.5f);
                    if (key % 10007 == 5000) value.y = kNan;
                    if (key % 20011 == 15000) value.z = kInf;
                    if (key % 30011 == 25000) value.x = -1;
                    film.add(x, y, value, false, s, records[y % 2]);
                }
            }
        }
        NonFiniteCount total;
        total.merge(records[swapped ? 1 : 0]);
        total.merge(records[swapped ? 0 : 1]);
        return total;
    };
    NonFiniteCount expected;
    for (uint64_t key = 0; key < kSamples * kSize * kSize; ++key) {
        if (key % 10007 == 5000) {
            ++expected.nan;
        } else if (key % 20011 == 15000) {
            ++expected.inf;
        } else if (key % 30011 == 25000) {
            ++expected.negative;
        }
    }
    Film first(kSize, kSize);
    for (int variant = 0; variant < 4; ++variant) {
        Film film(kSize, kSize);
        const NonFiniteCount counts = run(variant & 1, variant & 2, film);
        EXPECT_EQ(counts.nan, expected.nan);
        EXPECT_EQ(counts.inf, expected.inf);
        EXPECT_EQ(counts.negative, expected.negative);
        EXPECT_EQ((counts.first_sample * kSize + counts.first_y) * kSize + counts.first_x, 5000u);
        if (variant == 0) first = film;
        EXPECT_EQ(film.hash(), first.hash());
    }
    for (const Rgb& c : first.image(false).rgb) EXPECT_TRUE(std::isfinite(c.x + c.y + c.z));
}

Film random_film(uint64_t begin, uint64_t end, uint32_t width, uint32_t height) {
    Film film(width, height);
    NonFiniteCount counts;
    for (uint64_t s = begin; s < end; ++s) {
        std::mt19937 random(static_cast<uint32_t>(s) * 7919u + 1);
        std::exponential_distribution<float> value(1.0f);
        for (uint32_t y = 0; y < height; ++y) {
            for (uint32_t x = 0; x < width; ++x) {
                const float v = value(random);
                film.add(x, y, Rgb(v, v * v, 1 / (v + 1e-6f)), v > 1, s, counts);
            }
        }
    }
    return film;
}

TEST(Film, MergedShardsAreTheSingleRunToTheByte) {
    const Film whole = random_film(0, 64, 17, 9);
    for (uint64_t shards : {2u, 3u, 8u}) {
        Film merged(17, 9);
        for (uint64_t i = shards; i-- > 0;) {
            merged.merge(random_film(64 * i / shards, 64 * (i + 1) / shards, 17, 9));
        }
        EXPECT_EQ(merged.pixels(), whole.pixels());
        EXPECT_EQ(merged.hash(), whole.hash());
    }
}

TEST(Film, ThreadsMayShareAFilmByPixels) {
    Film film(64, 64);
    NonFiniteCount counts[2];
    std::vector<std::thread> threads;
    for (uint32_t t = 0; t < 2; ++t) {
        threads.emplace_back([&film, &counts, t] {
            for (uint64_t s = 0; s < 16; ++s) {
                for (uint32_t i = t; i < 64 * 64; i += 2) {
                    film.add(i % 64, i / 64, Rgb(static_cast<float>(s)), false, s, counts[t]);
                }
            }
        });
    }
    for (std::thread& thread : threads) thread.join();
    for (const Rgb& c : film.image(false).rgb) EXPECT_EQ(c, Rgb(7.5f));
}

TEST(Film, HashSeesEveryField) {
    const Film base = random_film(0, 2, 4, 3);
    const std::string hash = base.hash();
    EXPECT_EQ(hash.size(), 64u);
    EXPECT_EQ(hash, random_film(0, 2, 4, 3).hash());
    Film other = base;
    other.pixel(3, 2).samples += 1;
    EXPECT_NE(other.hash(), hash);
    other = base;
    other.pixel(0, 0).covered += 1;
    EXPECT_NE(other.hash(), hash);
    for (int c = 0; c < 3; ++c) {
        other = base;
        other.pixel(1, 1).sum[c].add(0x1p-56f);
        EXPECT_NE(other.hash(), hash);
    }
    EXPECT_NE(Film(4, 3).hash(), Film(3, 4).hash());
    // SHA-256 of eight zero bytes (FIPS 180-4; computed with an independent program).
    EXPECT_EQ(Film().hash(), "af5570f5a1810b7af78caf4bc70a660f0df51e42baf91d4de5b2328de0e83dfc");
}

}  // namespace
}  // namespace talbot
