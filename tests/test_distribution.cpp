// Discrete choice: masses over sixty decades of weights, zeros, the ends of [0, 1).
#include <gtest/gtest.h>

#include "core/math/distribution.h"
#include "core/math/robust.h"
#include "oracles/stats/random.h"

namespace talbot {
namespace {

std::vector<double> weights_over(double decades, std::size_t n, uint64_t seed) {
    stats::Random random(seed);
    std::vector<double> weights(n);
    for (double& w : weights) w = std::pow(10.0, decades * random.between(-0.5, 0.5));
    return weights;
}

TEST(DiscreteDistribution, MassIsWeightOverTotal) {
    for (const double decades : {0.0, 12.0, 60.0}) {
        const std::vector<double> weights = weights_over(decades, 5000, 3);
        const DiscreteDistribution d(weights);
        long double total = 0;
        for (const double w : weights) total += static_cast<long double>(w);
        double worst = 0;
        double by_difference = 0;
        double sum = 0;
        for (uint32_t i = 0; i < weights.size(); ++i) {
            const auto expected = static_cast<double>(static_cast<long double>(weights[i]) / total);
            worst = std::max(worst, std::abs(d.mass(i) / expected - 1));
            const double low = sum;
            sum += expected;
            by_difference = std::max(by_difference, std::abs((sum - low) / expected - 1));
        }
        EXPECT_LT(worst, 1e-6) << decades;
        if (decades == 60) {
            EXPECT_GT(by_difference, 0.5) << "control: differences of prefix sums";
        }
    }
}

TEST(DiscreteDistribution, NothingWithoutWeightIsPicked) {
    for (const std::vector<double>& weights :
         {std::vector<double>{0, 0, 1, 0, 2, 0, 0}, {1e-300, 1, 0}, {0, 1e-30, 1e30, 1e-30}, {5}}) {
        const DiscreteDistribution d(weights);
        for (const float u : {0.0f, 0x1p-149f, 0x1p-24f, 0.5f, 1 - 0x1p-23f, kOneMinusEpsilon}) {
            const DiscreteDistribution::Pick pick = d.sample(u);
            ASSERT_LT(pick.index, weights.size());
            EXPECT_GT(weights[pick.index], 0);
            EXPECT_GT(pick.probability, 0);
            EXPECT_TRUE(pick.u >= 0 && pick.u < 1);
            EXPECT_EQ(pick.probability, d.probability(pick.index));
        }
        for (uint32_t i = 0; i < weights.size(); ++i) EXPECT_EQ(d.mass(i) > 0, weights[i] > 0) << i;
    }
    EXPECT_TRUE(DiscreteDistribution(std::vector<double>{0, 0}).is_empty());
}

TEST(CellDistribution, MassesSumToOne) {
    std::vector<double> weights = weights_over(3, 64 * 32, 5);
    weights[777] = 1e12;
    const CellDistribution cells(weights, 64, 32);
    long double sum = 0;
    for (uint32_t row = 0; row < 32; ++row) {
        for (uint32_t column = 0; column < 64; ++column) {
            EXPECT_GT(cells.mass(column, row), 0);
            sum += static_cast<long double>(cells.mass(column, row));
        }
    }
    EXPECT_NEAR(static_cast<double>(sum), 1, 1e-12);
}

}  // namespace
}  // namespace talbot
