// The lists of samples to look at: the same whatever the order, and complete against a sort.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "core/film/film.h"

namespace talbot {
namespace {

constexpr uint32_t kSide = 16;

bool same(const NotedSample& a, const NotedSample& b) {
    return a.x == b.x && a.y == b.y && a.sample == b.sample;
}

// Grey noise, and now and then a firefly.
float brightness(uint32_t x, uint32_t y, uint64_t sample) {
    std::mt19937 random(static_cast<uint32_t>(sample * 65536 + y * 256 + x));
    const double u = std::uniform_real_distribution<double>(0, 1)(random);
    const double v = std::uniform_real_distribution<double>(0.5, 1.5)(random);
    return static_cast<float>(u < 0.02 ? 1000 * v : v);
}

struct Outcome {
    Film film{kSide, kSide};
    SampleLog log;
};

// Rows dealt to so many workers, from the top or from below, pass by pass.
Outcome render(unsigned workers, bool upwards, uint64_t passes) {
    Outcome out;
    NonFiniteCount counts;
    for (uint64_t pass = 0; pass < passes; ++pass) {
        std::vector<SampleLog> logs(workers, out.log.fork());
        for (uint32_t row = 0; row < kSide; ++row) {
            const uint32_t y = upwards ? kSide - 1 - row : row;
            for (uint32_t x = 0; x < kSide; ++x) {
                out.film.add(x, y, Rgb(brightness(x, y, pass)), true, pass, counts,
                             logs[row % workers]);
            }
        }
        for (const SampleLog& log : logs) out.log.merge(log);
        out.log.prune(out.film);
    }
    return out;
}

TEST(SampleLog, HoldsTheLargestOutliersWhateverTheOrder) {
    constexpr uint64_t kPasses = 200;
    const Outcome a = render(1, false, kPasses);
    const Outcome b = render(3, true, kPasses);
    const std::vector<NotedSample> first = a.log.outliers(32);
    const std::vector<NotedSample> second = b.log.outliers(32);
    ASSERT_EQ(first.size(), 32u);
    ASSERT_EQ(second.size(), 32u);
    for (std::size_t i = 0; i < first.size(); ++i) EXPECT_TRUE(same(first[i], second[i])) << i;
    // Against all samples, sorted, of those that stand out of the finished film.
    std::vector<NotedSample> all;
    for (uint64_t s = 0; s < kPasses; ++s) {
        for (uint32_t y = 0; y < kSide; ++y) {
            for (uint32_t x = 0; x < kSide; ++x) {
                const double value = static_cast<double>(brightness(x, y, s));
                const double others = a.film.pixel(x, y).largest_sum() - value;
                if (value * (kPasses - 1) > kOutlierRatio * others)
                    all.push_back({x, y, s, Rgb(static_cast<float>(value)), SampleFault::none});
            }
        }
    }
    std::sort(all.begin(), all.end(),
              [](const NotedSample& p, const NotedSample& q) { return p.largest() > q.largest(); });
    ASSERT_GE(all.size(), 32u);
    std::size_t found = 0;
    for (std::size_t i = 0; i < 32; ++i) {
        found += std::any_of(first.begin(), first.end(),
                             [&](const NotedSample& s) { return same(s, all[i]); });
    }
    // One is missed only if its pixel had an outlier before that made it look ordinary.
    EXPECT_GE(found, 28u);
}

TEST(SampleLog, EvenPixelsHaveNoOutliers) {
    Film film(4, 4);
    SampleLog log;
    NonFiniteCount counts;
    for (uint64_t s = 0; s < 50; ++s) {
        for (uint32_t i = 0; i < 16; ++i)
            film.add(i % 4, i / 4, Rgb(i < 8 ? 1000.0f : 0.5f), true, s, counts, log);
    }
    EXPECT_TRUE(log.outliers(32).empty()) << "a lamp is bright, but no outlier";
}

TEST(SampleLog, AFirstSampleIsJudgedByTheSecond) {
    Film film(2, 1);
    SampleLog log;
    NonFiniteCount counts;
    film.add(1, 0, Rgb(500), true, 40, counts, log);
    film.add(1, 0, Rgb(1), true, 41, counts, log);
    ASSERT_EQ(log.outliers(8).size(), 1u);
    EXPECT_EQ(log.outliers(8)[0].sample, 40u);
    EXPECT_EQ(log.outliers(8)[0].radiance, Rgb(500));
    // A pixel that is as bright as that in the end has none.
    for (uint64_t s = 42; s < 90; ++s) film.add(1, 0, Rgb(400), true, s, counts, log);
    log.prune(film);
    for (const NotedSample& noted : log.outliers(8)) EXPECT_NE(noted.sample, 40u);
}

TEST(SampleLog, UnusableSamplesAreListedInOrderAndCounted) {
    Film film(8, 8);
    SampleLog log;
    NonFiniteCount counts;
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const float inf = std::numeric_limits<float>::infinity();
    film.add(3, 1, Rgb(0, inf, 0), true, 7, counts, log);
    film.add(2, 1, Rgb(-1, 0, 0), true, 7, counts, log);
    film.add(5, 5, Rgb(0x1p60f, 0, 0), true, 9, counts, log);
    film.add(1, 1, Rgb(nan, inf, -1), true, 2, counts, log);
    film.add(1, 1, Rgb(-0.0f, 0, 0), true, 3, counts, log);
    ASSERT_EQ(log.unusable().size(), 4u);
    EXPECT_EQ(log.unusable()[0].fault, SampleFault::nan);
    EXPECT_EQ(log.unusable()[1].fault, SampleFault::negative);
    EXPECT_EQ(log.unusable()[2].fault, SampleFault::infinite);
    EXPECT_EQ(log.unusable()[3].fault, SampleFault::overflow);
    EXPECT_EQ(counts.total(), 4u);
    EXPECT_TRUE(log.outliers(8).empty()) << "what is not usable does not count as large";
    for (uint64_t s = 0; s < 200; ++s) film.add(0, 0, Rgb(nan), true, 500 - s, counts, log);
    EXPECT_EQ(log.unusable().size(), SampleLog::kMostUnusable);
    EXPECT_EQ(log.unusable().front().sample, 2u);
    EXPECT_TRUE(std::is_sorted(
        log.unusable().begin(), log.unusable().end(),
        [](const NotedSample& a, const NotedSample& b) { return a.sample < b.sample; }));
}

}  // namespace
}  // namespace talbot
