// Pearson's chi-square test of counts against expected counts.
#pragma once

#include <algorithm>
#include <numeric>
#include <string>
#include <vector>

#include "oracles/stats/distribution_tails.h"

namespace talbot::stats {

struct Chi2Result {
    double statistic = 0;
    int degrees = 0;
    double p = 1;  // probability of a statistic at least as large if the expectations are true

    std::string text() const {
        return "chi2 " + std::to_string(statistic) + " with " + std::to_string(degrees) +
               " degrees, p " + std::to_string(p);
    }
};

// Cells expecting fewer than `least` counts are pooled, smallest first. `fitted`: how many
// parameters the expectations took from the data (1 when they were scaled to the observed total). A
// count in a cell that expects nothing gives p = 0.
inline Chi2Result chi2_test(const std::vector<double>& observed,
                            const std::vector<double>& expected, int fitted = 0, double least = 5) {
    std::vector<std::size_t> order(observed.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(),
              [&](std::size_t a, std::size_t b) { return expected[a] < expected[b]; });
    Chi2Result r;
    double pooled_observed = 0;
    double pooled_expected = 0;
    const auto close_cell = [&r](double o, double e) {
        r.statistic += (o - e) * (o - e) / e;
        ++r.degrees;
    };
    for (const std::size_t i : order) {
        if (!(expected[i] > 0) && observed[i] > 0)
            return {std::numeric_limits<double>::infinity(), 1, 0};
        if (expected[i] >= least && pooled_expected == 0) {
            close_cell(observed[i], expected[i]);
            continue;
        }
        pooled_observed += observed[i];
        pooled_expected += expected[i];
        if (pooled_expected >= least) {
            close_cell(pooled_observed, pooled_expected);
            pooled_observed = pooled_expected = 0;
        }
    }
    r.degrees -= fitted;
    if (r.degrees > 0) r.p = chi2_tail(r.statistic, r.degrees);
    return r;
}

}  // namespace talbot::stats
