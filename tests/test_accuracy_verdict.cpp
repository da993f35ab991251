// The verdict of an A/B comparison on synthetic block sums: how often it is wrong, how often it
// finds a planted inefficiency, and what its interval holds.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "core/accuracy/efficiency_verdict.h"

namespace talbot {
namespace {

// Blocks whose variances differ by orders of magnitude from place to place, as in pictures; each is
// known from a few renders only.
class Comparison {
  public:
    explicit Comparison(uint32_t seed) : random_(seed) {}

    std::vector<BlockVariances> blocks(double b_over_a, double freedom) {
        std::vector<BlockVariances> result(200);
        std::lognormal_distribution<double> level(0, 1.5);
        std::gamma_distribution<double> estimate(freedom / 2, 2 / freedom);
        for (BlockVariances& v : result) {
            const double truth = level(random_);
            v = {truth * estimate(random_), truth * b_over_a * estimate(random_)};
        }
        return result;
    }

    // Load that comes and goes and hits both sides, load that lasts for some pairs and hits one
    // (of standard deviation `lasting`), and noise of each.
    std::vector<TimePair> times(double b_over_a, int count, double lasting = 0) {
        std::normal_distribution<double> normal;
        std::vector<TimePair> pairs;
        double load = 0, of_one = 0;
        for (int i = 0; i < count; ++i) {
            load = 0.9 * load + 0.2 * normal(random_);
            of_one = 0.7 * of_one + 0.7 * lasting * normal(random_);
            const double both = std::exp(load);
            pairs.push_back({both * std::exp(of_one + 0.05 * normal(random_)),
                             b_over_a * both * std::exp(0.05 * normal(random_))});
        }
        return pairs;
    }

  private:
    std::mt19937 random_;
};

// Share of runs with that winner, at any of `looks` looks with ever better figures.
double share_won(Winner winner, double error_ratio, double time_ratio, int runs, int looks,
                 double lasting = 0) {
    int won = 0;
    for (int run = 0; run < runs; ++run) {
        Comparison c(static_cast<uint32_t>(run) + 1);
        bool seen = false;
        for (int look = 1; look <= looks; ++look) {
            const auto blocks = c.blocks(error_ratio, 20.0 * look);
            const auto times = c.times(time_ratio, 20 * look, lasting);
            const EfficiencyVerdict v =
                compare_efficiency(blocks, times, static_cast<uint64_t>(look));
            seen = seen || v.winner == winner;
        }
        won += seen ? 1 : 0;
    }
    return won / static_cast<double>(runs);
}

TEST(AccuracyVerdict, AgainstItselfNothingWinsInMoreThanOneOfTwenty) {
    const double wrong = share_won(Winner::a, 1, 1, 400, 6) + share_won(Winner::b, 1, 1, 400, 6);
    std::printf("a winner in %.1f %% of runs\n", 100 * wrong);
    EXPECT_LE(wrong, 0.05);
}

TEST(AccuracyVerdict, LoadThatLastsIsNoDifference) {
    const double wrong =
        share_won(Winner::a, 1, 1, 300, 6, 0.1) + share_won(Winner::b, 1, 1, 300, 6, 0.1);
    std::printf("a winner in %.1f %% of runs\n", 100 * wrong);
    EXPECT_LE(wrong, 0.05);
}

TEST(AccuracyVerdict, StudentQuantilesAreThoseOfTables) {
    const double table[][3] = {{0.05, 1, 12.706}, {0.05, 2, 4.303},  {0.05, 3, 3.182},
                               {0.01, 5, 4.032},  {0.002, 4, 7.173}, {0.001, 7, 5.408},
                               {0.05, 30, 2.042}, {0.1, 1e9, 1.6449}};
    for (const auto& [probability, freedom, quantile] : table)
        EXPECT_NEAR(student_quantile(probability, freedom) / quantile, 1, 0.002) << freedom;
    EXPECT_NEAR(student_quantile(0.05, std::numeric_limits<double>::infinity()), 1.95996, 1e-4);
    double all = 0;
    for (uint64_t look = 1; look <= 10000; ++look) all += level_of_look(0.05, look);
    EXPECT_NEAR(all, 0.05, 1e-5);
}

TEST(AccuracyVerdict, ATenthOfWastedSamplesIsFound) {
    // B throws a tenth of its samples away: 1 / 0.9 times the time for each that counts.
    EXPECT_GE(share_won(Winner::a, 1, 1 / 0.9, 100, 6), 0.9);
    EXPECT_EQ(share_won(Winner::b, 1, 1 / 0.9, 100, 6), 0);
    // The same in error at equal time; and the other way round.
    EXPECT_GE(share_won(Winner::a, 1 / 0.9, 1, 100, 6), 0.9);
    EXPECT_GE(share_won(Winner::b, 0.9, 1, 100, 6), 0.9);
}

TEST(AccuracyVerdict, IntervalHoldsTheTruth) {
    int held = 0;
    const int runs = 300;
    for (int run = 0; run < runs; ++run) {
        Comparison c(static_cast<uint32_t>(run) + 7000);
        const EfficiencyVerdict v = compare_efficiency(c.blocks(0.5, 20), c.times(0.8, 20), 1);
        const double truth = 1 / (0.5 * 0.8);
        held += v.lo95 <= truth && truth <= v.hi95 ? 1 : 0;
    }
    // The first look may err in 2.5 % of runs.
    EXPECT_GE(held, 0.945 * runs);
    EXPECT_LT(held, runs);
}

TEST(AccuracyVerdict, SaysItInWords) {
    const std::vector<TimePair> times(50, TimePair{1, 1});
    const std::vector<BlockVariances> better(100, BlockVariances{2.3, 1});
    const EfficiencyVerdict b = compare_efficiency(better, times, 1);
    EXPECT_EQ(b.winner, Winner::b);
    EXPECT_EQ(b.text, "B is 2.30x (2.27 to 2.33) more efficient on this view");
    const std::vector<BlockVariances> worse(100, BlockVariances{1, 2.3});
    EXPECT_EQ(compare_efficiency(worse, times, 1).text,
              "A is 2.30x (2.27 to 2.33) more efficient on this view");
    const std::vector<BlockVariances> black(100);
    const EfficiencyVerdict none = compare_efficiency(black, times, 1);
    EXPECT_FALSE(none.valid);
    EXPECT_EQ(none.winner, Winner::none);
    // Without times nothing is known of half the efficiency.
    EXPECT_EQ(compare_efficiency(better, {}, 1).winner, Winner::none);
}

}  // namespace
}  // namespace talbot
