// The statistical tests judged on closed forms, on honest generators and on planted faults.
#include <gtest/gtest.h>

#include "oracles/stats/chi2.h"
#include "oracles/stats/random.h"
#include "oracles/stats/ttest.h"
#include "oracles/stats/ztest.h"

namespace talbot::stats {
namespace {

TEST(Tails, ChiSquareMatchesClosedForms) {
    for (const double x : {0.1, 1.0, 3.0, 10.0, 80.0}) {
        EXPECT_NEAR(chi2_tail(x, 2), std::exp(-x / 2), 1e-12);
        EXPECT_NEAR(chi2_tail(x, 1), std::erfc(std::sqrt(x / 2)), 1e-12);
        EXPECT_NEAR(chi2_tail(x, 4), std::exp(-x / 2) * (1 + x / 2), 1e-12);
    }
    // Large degrees: the median of chi^2_k is near k (1 - 2 / (9 k))^3.
    EXPECT_NEAR(chi2_tail(1000 * std::pow(1 - 2.0 / 9000, 3), 1000), 0.5, 1e-4);
}

TEST(Tails, StudentMatchesClosedForms) {
    for (const double t : {0.0, 0.3, 1.0, 5.0, 40.0}) {
        EXPECT_NEAR(student_two_sided(t, 1), 1 - 2 / std::acos(-1.0) * std::atan(t), 1e-12);
        EXPECT_NEAR(student_two_sided(t, 2), 1 - t / std::sqrt(2 + t * t), 1e-12);
        EXPECT_NEAR(student_two_sided(t, 1e6), normal_two_sided(t), 1e-5);
    }
}

TEST(Tails, SidakKeepsTheFamily) {
    EXPECT_NEAR(1 - std::pow(1 - sidak(1e-4, 1000), 1000), 1e-4, 1e-10);
    EXPECT_DOUBLE_EQ(sidak(0.05, 1), 0.05);
}

constexpr int kTrials = 400;

// Share of trials below p = 0.05, and whether any is below the family's significance.
struct Outcome {
    double below = 0;
    double smallest = 1;

    void add(double p) {
        below += p < 0.05 ? 1.0 / kTrials : 0.0;
        smallest = std::min(smallest, p);
    }
};

Outcome chi2_outcome(double fault) {
    Outcome outcome;
    constexpr int kCells = 20;
    constexpr int kDraws = 4000;
    for (int trial = 0; trial < kTrials; ++trial) {
        Random random(static_cast<uint64_t>(trial) + 1);
        std::vector<double> observed(kCells, 0.0);
        const std::vector<double> expected(kCells, double{kDraws} / kCells);
        for (int i = 0; i < kDraws; ++i) {
            const double u = random();
            const double x = u * (1 - fault + fault * u);  // density no longer 1 when fault > 0
            ++observed[static_cast<std::size_t>(x * kCells)];
        }
        outcome.add(chi2_test(observed, expected, 1).p);
    }
    return outcome;
}

TEST(Chi2, HonestDrawsPassAndBiasedOnesFail) {
    const Outcome honest = chi2_outcome(0);
    EXPECT_NEAR(honest.below, 0.05, 0.035);
    EXPECT_GT(honest.smallest, sidak(kFalseAlarm, kTrials));
    const Outcome biased = chi2_outcome(0.2);
    EXPECT_GT(biased.below, 0.99);
}

TEST(Chi2, PoolsThinCellsAndRefusesImpossibleCounts) {
    const Chi2Result pooled = chi2_test({1, 0, 2, 100}, {1, 1, 3, 98});
    EXPECT_EQ(pooled.degrees, 2);
    EXPECT_GT(pooled.p, 0.1);
    EXPECT_EQ(chi2_test({1, 99}, {0, 100}).p, 0);
}

Outcome mean_outcome(double shift, int draws, bool student) {
    Outcome outcome;
    for (int trial = 0; trial < kTrials; ++trial) {
        Random random(static_cast<uint64_t>(trial) + 77);
        Moments m;
        for (int i = 0; i < draws; ++i) m.add(random() + shift);
        outcome.add(student ? t_test(m, 0.5) : z_test(m, 0.5));
    }
    return outcome;
}

TEST(ZTest, HonestMeansPassAndShiftedOnesFail) {
    const Outcome honest = mean_outcome(0, 1000, false);
    EXPECT_NEAR(honest.below, 0.05, 0.035);
    EXPECT_GT(honest.smallest, sidak(kFalseAlarm, kTrials));
    EXPECT_GT(mean_outcome(0.06, 1000, false).below, 0.99);
    EXPECT_EQ(z_test(1, 1, 0), 1);
    EXPECT_EQ(z_test(1, 1.5, 0), 0);
}

TEST(TTest, HonestMeansPassAndShiftedOnesFail) {
    const Outcome honest = mean_outcome(0, 8, true);
    EXPECT_NEAR(honest.below, 0.05, 0.035);
    EXPECT_GT(honest.smallest, sidak(kFalseAlarm, kTrials));
    EXPECT_GT(mean_outcome(0.6, 8, true).below, 0.95);
    // With so few draws the z-test sees faults that are not there.
    EXPECT_GT(mean_outcome(0, 4, false).below, 0.085);
}

TEST(TTest, WelchComparesUnequalStreams) {
    Outcome same;
    Outcome different;
    for (int trial = 0; trial < kTrials; ++trial) {
        Random random(static_cast<uint64_t>(trial) + 991);
        Moments narrow;
        Moments wide;
        Moments shifted;
        for (int i = 0; i < 12; ++i) narrow.add(random());
        for (int i = 0; i < 40; ++i) {
            const double x = 0.5 + 5 * (random() - 0.5);
            wide.add(x);
            shifted.add(x + 1.5);
        }
        same.add(welch_test(narrow, wide));
        different.add(welch_test(narrow, shifted));
    }
    EXPECT_NEAR(same.below, 0.05, 0.035);
    EXPECT_GT(different.below, 0.95);
}

TEST(ZTest, ProportionsAreJudged) {
    EXPECT_GT(proportion_test(510, 1000, 0.5), 0.5);
    EXPECT_LT(proportion_test(600, 1000, 0.5), 1e-9);
}

}  // namespace
}  // namespace talbot::stats
