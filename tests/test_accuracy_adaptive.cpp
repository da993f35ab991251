// Adaptive sampling on synthetic pictures whose means are known: counts, what they save, that the
// stated error still holds, and that rare light is not lost.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <functional>

#include "core/accuracy/error_estimate.h"
#include "tests/synthetic_render.h"

namespace talbot {
namespace {

// A picture that is sampled by its tracker's plan, as a session does it.
struct AdaptivePicture {
    using Sample = std::function<Rgb(uint32_t x, uint32_t y, uint64_t index)>;
    Film film;
    ErrorTracker tracker;
    Sample sample;
    uint64_t passes = 0;

    AdaptivePicture(uint32_t size, bool adaptive, Sample s)
        : film(size, size), sample(std::move(s)) {
        tracker.reset(0, 0, adaptive);
    }

    void render_until(uint64_t end) {
        NonFiniteCount counts;
        const std::size_t columns = (film.width() + kErrorBlock - 1) / kErrorBlock;
        for (; passes < end; ++passes) {
            const SamplingPlan& plan = tracker.plan();
            for (uint32_t y = 0; y < film.height(); ++y) {
                for (uint32_t x = 0; x < film.width(); ++x) {
                    const std::size_t block = y / kErrorBlock * columns + x / kErrorBlock;
                    const uint64_t target =
                        plan.empty() ? passes + 1 : plan.samples(block, passes + 1);
                    while (film.pixel(x, y).samples < target) {
                        const uint64_t index = film.pixel(x, y).samples;
                        film.add(x, y, sample(x, y, index), true, index, counts);
                    }
                }
            }
            tracker.observe(film, passes + 1, static_cast<double>(passes + 1));
        }
    }

    double samples_a_pixel() const {
        return static_cast<double>(film.total_samples()) /
               static_cast<double>(film.pixels().size());
    }
};

double random_unit(uint32_t seed, uint32_t pixel, uint64_t index) {
    using synthetic::mix;
    return synthetic::unit(mix(mix(seed, pixel), static_cast<uint32_t>(index)));
}

constexpr uint32_t kSize = 48;

// Dim and calm, but for a noisy third on the right.
AdaptivePicture uneven(bool adaptive, uint32_t seed) {
    return {kSize, adaptive, [seed](uint32_t x, uint32_t y, uint64_t index) {
                const double spread = x < 2 * kSize / 3 ? 0.05 : 0.5;
                const double u = random_unit(seed, y * kSize + x, index);
                return Rgb(static_cast<float>(0.5 + spread * (2 * u - 1)));
            }};
}

double true_relmse(const AdaptivePicture& p) {
    double sum = 0;
    for (const FilmPixel& pixel : p.film.pixels()) {
        const double e = pixel.sum[0].value() / static_cast<double>(pixel.samples) - 0.5;
        sum += e * e / 0.26;
    }
    return sum / static_cast<double>(p.film.pixels().size());
}

TEST(Adaptive, CountsArePowersOfTwoAndLagByEightAtMost) {
    AdaptivePicture p = uneven(true, 1);
    p.render_until(32);
    EXPECT_EQ(p.film.min_samples(), 32u);
    for (const uint64_t n : {64u, 128u, 512u, 2048u}) {
        p.render_until(n);
        uint64_t most = 0;
        for (const FilmPixel& pixel : p.film.pixels()) {
            EXPECT_TRUE(std::has_single_bit(pixel.samples));
            EXPECT_GE(pixel.samples * 8, n);
            most = std::max(most, pixel.samples);
        }
        EXPECT_EQ(most, n);
    }
    // All pixels of a block are alike; the calm blocks have a tenth of the noise.
    EXPECT_LE(p.film.pixel(0, 0).samples, 512u);
    EXPECT_EQ(p.film.pixel(7, 7).samples, p.film.pixel(0, 0).samples);
    EXPECT_EQ(p.film.pixel(kSize - 1, 0).samples, 2048u);
}

TEST(Adaptive, SavesSamplesAndTheStatedErrorHolds) {
    double log_ratio = 0, inside = 0, claims = 0, gain = 0;
    constexpr uint32_t kSeeds = 16;
    for (uint32_t seed = 1; seed <= kSeeds; ++seed) {
        AdaptivePicture p = uneven(true, seed), all = uneven(false, seed);
        for (const uint64_t n : {64u, 128u, 256u}) {
            p.render_until(n);
            const ErrorEstimate& e = p.tracker.estimate();
            const double truth = 100 * std::sqrt(true_relmse(p));
            log_ratio += std::log(e.relrmse_percent / truth);
            inside += e.lo95 <= truth && truth <= e.hi95 ? 1 : 0;
            ++claims;
        }
        all.render_until(256);
        gain += true_relmse(all) * all.samples_a_pixel() / (true_relmse(p) * p.samples_a_pixel()) /
                kSeeds;
    }
    std::printf("estimate over truth %.3f, inside %.3f, efficiency %.2f\n",
                std::exp(log_ratio / claims), inside / claims, gain);
    EXPECT_NEAR(std::exp(log_ratio / claims), 1, 0.05);
    EXPECT_GT(inside / claims, 0.88);
    // By the law of the counts 1 / (mean of sigma)^2 over mean of sigma^2 is 2.1; a factor of 8 in
    // counts, and blocks beside the noisy ones that are taken along, leave less.
    EXPECT_GT(gain, 1.4);
}

TEST(Adaptive, RareLightIsNotDarkened) {
    // One sample in 100 finds a light of size 100 on an eighth of the picture; the rest is grey.
    const auto picture = [](uint32_t seed) {
        return AdaptivePicture(32, true, [seed](uint32_t x, uint32_t y, uint64_t index) {
            if (x >= 16 || y >= 8) return Rgb(1);
            return Rgb(random_unit(seed, y * 32 + x, index) < 0.01 ? 100.0f : 0.0f);
        });
    };
    double sum = 0, square = 0;
    constexpr double kSeeds = 48;
    for (uint32_t seed = 1; seed <= kSeeds; ++seed) {
        AdaptivePicture p = picture(seed);
        p.render_until(256);
        double mean = 0;
        for (uint32_t y = 0; y < 8; ++y)
            for (uint32_t x = 0; x < 16; ++x)
                mean += p.film.pixel(x, y).sum[0].value() /
                        static_cast<double>(p.film.pixel(x, y).samples) / 128;
        sum += mean;
        square += mean * mean;
    }
    const double mean = sum / kSeeds;
    const double sd = std::sqrt((square / kSeeds - mean * mean) / (kSeeds - 1));
    EXPECT_LT(std::abs(mean - 1), std::max(0.005, 3 * sd)) << sd;
}

TEST(Adaptive, APartOfARenderIsNeverAdaptive) {
    ErrorTracker tracker;
    tracker.reset(0, 8, true);
    EXPECT_FALSE(tracker.state().adaptive);
}

}  // namespace
}  // namespace talbot
