// The stated error against the true one, on synthetic renders whose means are known exactly.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "core/accuracy/bias_floor.h"
#include "core/accuracy/calibration.h"
#include "core/accuracy/error_estimate.h"
#include "core/accuracy/packed_difference.h"
#include "tests/synthetic_render.h"

namespace talbot {
namespace {

using synthetic::Picture;

// All claims of a few renders of every synthetic scene, from `from` samples on.
Calibration claims_of(bool sobol, uint32_t size, uint64_t from, uint32_t seeds,
                      const char* only = nullptr) {
    Calibration all;
    for (const synthetic::Scene& scene : synthetic::scenes()) {
        if (only != nullptr && std::string(only) != scene.name) continue;
        for (uint32_t seed = 0; seed < seeds; ++seed) {
            Picture picture(scene, size, sobol, 17 * seed + 1);
            ErrorTracker tracker;
            tracker.reset(0);
            for (uint64_t n = 1; n <= 256; n *= 2) {
                picture.render_until(n);
                tracker.observe(picture.film, n, static_cast<double>(n));
                const ErrorEstimate& e = tracker.estimate();
                if (n < from) continue;
                all.errors.push_back({all.errors.size() / 8, n, e.relrmse_percent, e.lo95, e.hi95,
                                      100 * std::sqrt(picture.true_relmse()), e.exponent,
                                      Trust::green});
            }
        }
    }
    return all;
}

TEST(Accuracy, IndependentSamplesAreEstimatedWithinOnePerCent) {
    Calibration all = claims_of(false, 48, 32, 3);
    const auto off = [&] { return std::abs(std::log(summarise({&all}).ratio)); };
    constexpr double kLimit = 0.015;
    EXPECT_LT(off(), kLimit);
    EXPECT_GT(summarise({&all}).coverage, 0.9);
    // Negative control: a planted error of 2 %.
    for (ErrorClaim& c : all.errors) c.estimate /= 1.02;
    EXPECT_GT(off(), kLimit);
}

TEST(Accuracy, ScrambledPointsAreEstimated) {
    Calibration all;
    for (const synthetic::Scene& scene : synthetic::scenes()) {
        const Calibration one = claims_of(true, 40, 16, 3, scene.name);
        const CalibrationSummary s = summarise({&one});
        std::printf("%s: ratio %.3f, coverage %.3f, width %.3f\n", scene.name, s.ratio, s.coverage,
                    s.mean_width);
        if (std::string(scene.name) == "smooth") {
            // Nothing but smooth light converges faster than the estimate believes: too high, not
            // too low.
            EXPECT_GT(s.ratio, 0.95);
            EXPECT_LT(s.ratio, 1.3);
            continue;
        }
        all.errors.insert(all.errors.end(), one.errors.begin(), one.errors.end());
    }
    const CalibrationSummary s = summarise({&all});
    EXPECT_GT(s.ratio, 0.95);
    EXPECT_LT(s.ratio, 1.05);
    EXPECT_GT(s.coverage, 0.85);
}

TEST(Accuracy, ExposureChangesTheMetricOfAllOctaves) {
    // The dark half of each picture weighs more the brighter it is developed.
    for (const synthetic::Scene& scene : synthetic::scenes()) {
        for (const float ev : {-4.0f, 3.0f}) {
            Picture picture(scene, 40, true, 9);
            ErrorTracker from_start, later;
            from_start.reset(ev);
            later.reset(0);
            for (uint64_t n = 1; n <= 64; n *= 2) {
                picture.render_until(n);
                from_start.observe(picture.film, n, static_cast<double>(n));
                later.observe(picture.film, n, static_cast<double>(n));
            }
            const ErrorEstimate before = later.estimate();
            later.set_exposure(ev, 40);
            const double asked = from_start.estimate().relrmse_percent;
            const double truth =
                100 * std::sqrt(picture.true_relmse(metric_constant(static_cast<double>(ev))));
            const double changed = later.estimate().relrmse_percent;
            // Exact but for the octaves before the last, which are taken along by one factor.
            EXPECT_NEAR(changed / asked, 1, 0.15) << scene.name << " " << ev;
            EXPECT_GT(truth, 0.65 * later.estimate().lo95) << scene.name << " " << ev;
            EXPECT_LT(truth, 1.5 * later.estimate().hi95) << scene.name << " " << ev;
            EXPECT_EQ(later.estimate().samples, 64u);
            EXPECT_EQ(later.estimate().exposure_ev, static_cast<double>(ev));
            // What the metric of 0 EV would have said is another figure altogether.
            EXPECT_GT(std::abs(std::log(before.relrmse_percent / asked)), 0.02) << scene.name;
            later.set_exposure(0, 40);
            EXPECT_NEAR(later.estimate().relrmse_percent / before.relrmse_percent, 1, 1e-6);
        }
    }
}

TEST(Accuracy, PromisesAreBrokenByAPlantedError) {
    // Claims that are right by construction: ln truth is Gaussian about ln estimate.
    std::mt19937 random(3);
    std::normal_distribution<double> normal;
    Calibration right;
    for (uint64_t i = 0; i < 3000; ++i) {
        const double truth = 5 * std::exp(0.1 * normal(random));
        right.errors.push_back(
            {i, 64, 5, 5 * std::exp(-0.196), 5 * std::exp(0.196), truth, 1, Trust::green});
    }
    EXPECT_TRUE(broken_promises(summarise({&right}), true).empty());
    Calibration narrow = right, shifted = right;
    for (ErrorClaim& c : narrow.errors) {
        c.lo95 = 5 * std::exp(-0.15);
        c.hi95 = 5 * std::exp(0.15);
    }
    for (ErrorClaim& c : shifted.errors) c.estimate *= 1.06;
    EXPECT_EQ(broken_promises(summarise({&narrow}), true).size(), 1u);
    EXPECT_EQ(broken_promises(summarise({&shifted}), true).size(), 1u);
    // A red light promises nothing.
    for (ErrorClaim& c : narrow.errors) c.trust = Trust::red;
    EXPECT_EQ(summarise({&narrow}).claims, 0u);
}

TEST(Accuracy, RareBrightPathsTurnTheLightRed) {
    // A light that one path in 40000 finds, 2000 times as bright as the rest: a twentieth of all
    // light.
    const uint32_t size = 64;
    Film film(size, size);
    NonFiniteCount counts;
    ErrorTracker tracker;
    tracker.reset(0);
    std::mt19937 random(5);
    std::bernoulli_distribution found(1.0 / 40000);
    for (uint64_t n = 0; n < 64; ++n) {
        for (uint32_t y = 0; y < size; ++y)
            for (uint32_t x = 0; x < size; ++x)
                film.add(x, y, Rgb(found(random) ? 1000.0f : 0.5f), true, n, counts);
        tracker.observe(film, n + 1, static_cast<double>(n + 1));
    }
    const ErrorEstimate& e = tracker.estimate();
    EXPECT_NE(e.trust, Trust::green) << e.top_share << " " << e.tail_index;
    if (e.trust == Trust::red) {
        EXPECT_FALSE(e.seconds_to(e.relrmse_percent / 2).valid);
    }
}

// A picture in which one sample of `odds` is that much brighter than nothing.
ErrorTracker sparse_picture(uint32_t size, uint64_t samples, double odds) {
    Film film(size, size);
    NonFiniteCount counts;
    ErrorTracker tracker;
    tracker.reset(0);
    std::mt19937 random(5);
    std::bernoulli_distribution found(1 / odds);
    for (uint64_t n = 0; n < samples; ++n) {
        for (uint32_t y = 0; y < size; ++y)
            for (uint32_t x = 0; x < size; ++x)
                film.add(x, y, Rgb(found(random) ? static_cast<float>(odds) : 0.0f), true, n,
                         counts);
        tracker.observe(film, n + 1, static_cast<double>(n + 1));
    }
    return tracker;
}

TEST(Accuracy, AnImageOfUnknownBrightnessIsNotGreen) {
    // The standard deviation of the brightness is sqrt((odds - 1) / samples) / size.
    const ErrorTracker small = sparse_picture(32, 64, 50);
    EXPECT_NEAR(small.estimate().brightness_sd, std::sqrt(49 / 64.0) / 32, 0.2 / 32);
    EXPECT_EQ(small.estimate().trust, Trust::amber) << small.estimate().why;
    const ErrorTracker large = sparse_picture(256, 64, 50);
    EXPECT_NEAR(large.estimate().brightness_sd, std::sqrt(49 / 64.0) / 256, 0.2 / 256);
    EXPECT_EQ(large.estimate().trust, Trust::green) << large.estimate().why;
}

TEST(Accuracy, AFewBrightPixelsAreRememberedForTwoDoublings) {
    // One sample between 16 and 32 makes 15 % of the error then, and half of that at each doubling.
    constexpr uint32_t kSide = 64;
    constexpr float kBright = 44;
    for (const bool bright : {false, true}) {
        Film film(kSide, kSide);
        NonFiniteCount counts;
        ErrorTracker tracker;
        tracker.reset(0);
        std::mt19937 random(7);
        std::uniform_real_distribution<float> value(0, 1);
        for (uint64_t n = 1; n <= 256; ++n) {
            for (uint32_t y = 0; y < kSide; ++y)
                for (uint32_t x = 0; x < kSide; ++x)
                    film.add(x, y, Rgb(value(random)), true, n, counts);
            if (n == 20 && bright) film.pixel(9, 9).sum[0].add(kBright);
            if (n == 20 && bright) film.pixel(9, 9).sum[1].add(kBright);
            if (n == 20 && bright) film.pixel(9, 9).sum[2].add(kBright);
            tracker.observe(film, n, static_cast<double>(n));
            const ErrorEstimate& e = tracker.estimate();
            if (n == 32) {
                EXPECT_EQ(e.top_share > 0.1, bright) << e.top_share;
            } else if (n == 64 || n == 128) {
                EXPECT_LT(e.top_share, 0.1);
                EXPECT_EQ(e.trust, bright ? Trust::amber : Trust::green) << n << " " << e.why;
            } else if (n == 256) {
                EXPECT_EQ(e.trust, Trust::green) << e.why;
            }
        }
    }
}

TEST(Accuracy, ATargetIsMetWithNineInTen) {
    ErrorEstimate e;
    EXPECT_FALSE(e.meets(5));
    e.valid = true;
    e.relrmse_percent = 4;
    e.hi95 = 4 * std::exp(1.96 * 0.1);
    EXPECT_FALSE(e.meets(4 * std::exp(0.127)));
    EXPECT_TRUE(e.meets(4 * std::exp(0.129)));
}

// What was not seen yet may still come.
TEST(Accuracy, AnEvenImageIsNoImageWithoutError) {
    ErrorTracker tracker;
    tracker.reset(0);
    Film film(32, 32);
    for (uint64_t n = 1; n <= 64; n *= 2) {
        for (FilmPixel& p : film.pixels()) p.samples = n;
        tracker.observe(film, n, 1);
    }
    const ErrorEstimate even = tracker.estimate();
    EXPECT_FALSE(even.valid);
    EXPECT_FALSE(even.meets(100));
    EXPECT_FALSE(even.seconds_to(1).valid);
    EXPECT_EQ(even.trust, Trust::amber) << even.why;
    // One bright sample in one pixel, and there is an error, which no one should trust.
    film.pixels()[5].sum[0].add(1);
    for (FilmPixel& p : film.pixels()) p.samples = 128;
    tracker.observe(film, 128, 1);
    EXPECT_TRUE(tracker.estimate().valid);
    EXPECT_EQ(tracker.estimate().trust, Trust::red) << tracker.estimate().why;
}

TEST(Accuracy, AFewPixelsAreNotGreen) {
    for (const uint32_t size : {16u, 32u}) {
        Picture picture(synthetic::scenes()[0], size, false, 3);
        ErrorTracker tracker;
        tracker.reset(0);
        for (uint64_t n = 1; n <= 64; n *= 2) {
            picture.render_until(n);
            tracker.observe(picture.film, n, static_cast<double>(n));
        }
        EXPECT_EQ(tracker.estimate().trust == Trust::green, size == 32) << tracker.estimate().why;
    }
}

TEST(Accuracy, FirmPredictionsAreKept) {
    int firm = 0, kept = 0, all = 0;
    for (const synthetic::Scene& scene : synthetic::scenes()) {
        const int firm_before = firm, kept_before = kept;
        for (uint32_t seed = 0; seed < 2; ++seed) {
            Picture picture(scene, 64, true, 101 * seed + 7);
            ErrorTracker tracker;
            tracker.reset(0);
            std::vector<ErrorEstimate> estimates;
            std::vector<double> truths;
            for (uint64_t n = 1; n <= 256; n *= 2) {
                picture.render_until(n);
                tracker.observe(picture.film, n, static_cast<double>(n));
                if (n < 16) continue;
                estimates.push_back(tracker.estimate());
                truths.push_back(100 * std::sqrt(picture.true_relmse()));
            }
            for (std::size_t i = 0; i < estimates.size(); ++i) {
                for (std::size_t j = i + 1; j < estimates.size(); ++j) {
                    const ErrorEstimate::Prediction p = estimates[i].seconds_to(truths[j]);
                    ++all;
                    if (!p.firm) continue;
                    ++firm;
                    EXPECT_EQ(estimates[i].trust, Trust::green);
                    const double ratio = estimates[j].seconds / (estimates[i].seconds + p.seconds);
                    kept += PredictionClaim::within(ratio) ? 1 : 0;
                }
            }
        }
        std::printf("%s: %d firm, %d kept\n", scene.name, firm - firm_before, kept - kept_before);
    }
    std::printf("%d of %d predictions are firm, %d of these kept\n", firm, all, kept);
    EXPECT_GT(firm, all / 8);
    EXPECT_GE(kept, 0.9 * firm);
}

TEST(Accuracy, OnlyFirmPredictionsArePromised) {
    Calibration c;
    c.errors.push_back({0, 64, 5, 4, 6, 5, 1, Trust::green});
    for (uint64_t i = 0; i < 100; ++i) {
        PredictionClaim claim;
        claim.predicted = 100;
        claim.actual = i % 3 == 0 ? 150 : 100;
        claim.trust = Trust::green;
        claim.firm = i % 3 != 0;
        c.predictions.push_back(claim);
    }
    const auto broken = [&] {
        const std::vector<std::string> lines = broken_promises(summarise({&c}), true);
        return std::any_of(lines.begin(), lines.end(), [](const std::string& line) {
            return line.find("firm predictions") != std::string::npos;
        });
    };
    EXPECT_FALSE(broken());
    EXPECT_NEAR(summarise({&c}).all_predictions_close, 0.66, 1e-9);
    for (PredictionClaim& claim : c.predictions) claim.firm = true;
    EXPECT_TRUE(broken());
}

TEST(Accuracy, StopsThatWereChosenSayNothingOfBrightness) {
    Calibration c;
    for (uint64_t seed = 0; seed < 10; ++seed) {
        c.stops.push_back({seed, 64, 50, 45, -3, Trust::green});
        c.stops.push_back({seed, 64, 20, 18, 0.1, Trust::green});
    }
    EXPECT_LT(summarise({&c}).stop_brightness_percent, -1);
    EXPECT_FALSE(broken_promises(summarise({&c}), false).empty());
    c.open_targets = {50};
    EXPECT_NEAR(summarise({&c}).stop_brightness_percent, 0.1, 1e-9);
}

TEST(Accuracy, StopsAreHeldToTheirRangeFrom32SamplesOn) {
    Calibration c;
    c.errors.push_back({0, 64, 4, 3, 5, 4, 1, Trust::green});
    for (uint64_t seed = 0; seed < 20; ++seed) {
        c.stops.push_back({seed, 64, 20, 18, 0, Trust::green});
        c.stops.push_back({seed, 20, 50, 30, 0, Trust::green});
    }
    const CalibrationSummary s = summarise({&c});
    EXPECT_EQ(s.stops, 20u);
    EXPECT_EQ(s.stops_kept, 1);
    EXPECT_NEAR(s.stop_ratio, 0.9, 1e-9);
    for (StopClaim& stop : c.stops) stop.samples = 64;
    EXPECT_EQ(summarise({&c}).stops_kept, 0.5);
}

TEST(Accuracy, PackedDifferencesKeepTheirMeanSquare) {
    std::mt19937 random(11);
    std::normal_distribution<float> normal;
    double exact = 0, packed = 0, worst = 0;
    for (int i = 0; i < 100000; ++i) {
        const float scale = std::exp(6 * normal(random));
        const Rgb d(scale * normal(random), scale * normal(random), scale * normal(random));
        const Rgb back = unpack_difference(pack_difference(d));
        const float most = std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)});
        for (int c = 0; c < 3; ++c) {
            worst = std::max(worst, double(std::abs(back[c] - std::abs(d[c])) / most));
            exact += double(d[c] / most) * double(d[c] / most);
            packed += double(back[c] / most) * double(back[c] / most);
        }
    }
    EXPECT_LT(worst, 0.0045);
    EXPECT_NEAR(packed / exact, 1, 0.002);
    EXPECT_EQ(unpack_difference(pack_difference(Rgb(0))), Rgb(0));
}

// Two renders with the same random numbers, one of which is darker by `bias`.
BiasFloor planted_floor(double bias, uint32_t seed) {
    Film films[2][2] = {{Film(48, 48), Film(48, 48)}, {Film(48, 48), Film(48, 48)}};
    NonFiniteCount counts;
    std::mt19937 random(seed);
    std::exponential_distribution<float> value(1);
    std::bernoulli_distribution cut(bias);
    for (uint64_t n = 0; n < 32; ++n) {
        for (uint32_t y = 0; y < 48; ++y) {
            for (uint32_t x = 0; x < 48; ++x) {
                const Rgb full(0.2f + value(random));
                // A rare path that is lost when it is cut; and unbiased noise between the two.
                const Rgb less = cut(random) ? Rgb(0) : full;
                const Rgb noise(0.1f * (value(random) - 1));
                for (int late = n < 16 ? 0 : 1; late < 2; ++late) {
                    films[0][late].add(x, y, less + glm::max(noise, -less), true, n, counts);
                    films[1][late].add(x, y, full, true, n, counts);
                }
            }
        }
    }
    return measure_floor(films[0][0], films[0][1], films[1][0], films[1][1]);
}

TEST(Accuracy, PlantedBiasIsFoundAndMeasured) {
    for (uint32_t seed = 1; seed <= 3; ++seed) {
        const BiasFloor floor = planted_floor(0.05, seed);
        EXPECT_TRUE(floor.significant);
        // 5 % of a mean of 1.2, relative to sqrt(1.44 + 0.01).
        EXPECT_NEAR(floor.relrmse_percent, 5, 0.5);
        EXPECT_LT(floor.brightness_percent, -4);
    }
    int false_alarms = 0;
    for (uint32_t seed = 1; seed <= 20; ++seed)
        false_alarms += planted_floor(0, seed).significant ? 1 : 0;
    EXPECT_LE(false_alarms, 1);
}

}  // namespace
}  // namespace talbot
