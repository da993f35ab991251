#include "core/accuracy/efficiency_verdict.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "core/math/sample_bits.h"

namespace talbot {
namespace {

constexpr int kResamples = 400;
constexpr double kLevel = 0.05;
// Of the logarithm of a time ratio, while too few pairs were measured to see it.
constexpr double kUnknownTimeSd = 0.5;
constexpr std::size_t kLeastPairs = 4;

struct LogRatio {
    double mean = 0;
    double sd = 0;
    double freedom = std::numeric_limits<double>::infinity();  // degrees of
};

// ln (sum of a / sum of b), with the standard deviation that drawing blocks anew shows.
LogRatio bootstrap(std::span<const BlockVariances> blocks) {
    double a = 0, b = 0;
    for (const BlockVariances& v : blocks) {
        a += v.a;
        b += v.b;
    }
    // A few noisy blocks are a small sample, however many quiet ones stand beside them.
    double concentration = 0;
    for (const BlockVariances& v : blocks) {
        const double share = 0.5 * (v.a / a + v.b / b);
        concentration += share * share;
    }
    LogRatio ratio{std::log(a / b), 0, std::max(1.0, 1 / concentration - 1)};
    const uint32_t count = static_cast<uint32_t>(blocks.size());
    double sum = 0, square = 0;
    int used = 0;
    uint32_t counter = 0;
    for (int i = 0; i < kResamples; ++i) {
        double drawn_a = 0, drawn_b = 0;
        for (uint32_t k = 0; k < count; ++k) {
            const BlockVariances& v = blocks[(uint64_t{hash32(++counter)} * count) >> 32];
            drawn_a += v.a;
            drawn_b += v.b;
        }
        if (!(drawn_a > 0) || !(drawn_b > 0)) continue;
        const double x = std::log(drawn_a / drawn_b);
        sum += x;
        square += x * x;
        ++used;
    }
    if (used < 2) return ratio;
    const double mean = sum / used;
    ratio.sd = std::sqrt(std::max(0.0, square / used - mean * mean) * used / (used - 1));
    return ratio;
}

// The trimmed mean over pairs of ln (a / b), for other work on the machine makes outliers, and its
// standard deviation from the winsorised values (Tukey, McLaughlin 1963).
LogRatio time_ratio(std::span<const TimePair> pairs) {
    constexpr double kTrimmed = 0.2;  // at each end
    std::vector<double> ratios;
    for (const TimePair& p : pairs) {
        if (p.a > 0 && p.b > 0) ratios.push_back(std::log(p.a / p.b));
    }
    if (ratios.empty()) return {0, kUnknownTimeSd};
    std::sort(ratios.begin(), ratios.end());
    const std::size_t count = ratios.size();
    if (count < kLeastPairs) return {ratios[count / 2], kUnknownTimeSd};
    const std::size_t cut = static_cast<std::size_t>(kTrimmed * static_cast<double>(count));
    const double low = ratios[cut], high = ratios[count - 1 - cut];
    double kept = 0, sum = 0, square = 0;
    for (std::size_t i = 0; i < count; ++i) {
        if (i >= cut && i < count - cut) kept += ratios[i];
        const double x = std::clamp(ratios[i], low, high);
        sum += x;
        square += x * x;
    }
    const double n = static_cast<double>(count), left = static_cast<double>(count - 2 * cut);
    const double variance = std::max(0.0, square - sum * sum / n) / (left * (left - 1));
    return {kept / left, std::sqrt(variance), left - 1};
}

// |z| that a standard Gaussian exceeds with this probability.
double two_sided_quantile(double probability) {
    double low = 0, high = 40;
    for (int i = 0; i < 60; ++i) {
        const double middle = 0.5 * (low + high);
        (std::erfc(middle / std::sqrt(2.0)) > probability ? low : high) = middle;
    }
    return high;
}

// The same of Student's t, in its expansion by 1 / freedom (Abramowitz, Stegun 26.7.5).
double student_quantile(double z, double freedom) {
    const double z3 = z * z * z, z5 = z3 * z * z;
    return z + (z3 + z) / (4 * freedom) + (5 * z5 + 16 * z3 + 3 * z) / (96 * freedom * freedom);
}

std::string times(double ratio) {
    char text[32];
    std::snprintf(text, sizeof(text), ratio < 9.95 ? "%.2f" : "%.0f", ratio);
    return text;
}

std::string sentence(const EfficiencyVerdict& v) {
    const bool b = v.winner == Winner::b;
    if (v.winner == Winner::none)
        return "no difference yet (" + times(v.ratio) + "x, " + times(v.lo95) + " to " +
               times(v.hi95) + ")";
    const double ratio = b ? v.ratio : 1 / v.ratio;
    const double low = b ? v.lo95 : 1 / v.hi95, high = b ? v.hi95 : 1 / v.lo95;
    return std::string(b ? "B" : "A") + " is " + times(ratio) + "x (" + times(low) + " to " +
           times(high) + ") more efficient on this view";
}

}  // namespace

EfficiencyVerdict compare_efficiency(std::span<const BlockVariances> blocks,
                                     std::span<const TimePair> times, uint64_t looks) {
    EfficiencyVerdict verdict;
    double a = 0, b = 0;
    for (const BlockVariances& v : blocks) {
        a += v.a;
        b += v.b;
    }
    const bool comparable = std::isfinite(a) && std::isfinite(b) && a > 0 && b > 0;
    if (!comparable || blocks.size() < 2 || looks == 0) {
        verdict.text = "no noise to compare yet";
        return verdict;
    }
    const LogRatio error = bootstrap(blocks), time = time_ratio(times);
    // Looks k = 1, 2, ... may err with 0.05 / (k (k + 1)) each, 0.05 in all.
    const double k = static_cast<double>(looks);
    const double z = two_sided_quantile(kLevel / (k * (k + 1)));
    const double half = std::hypot(student_quantile(z, error.freedom) * error.sd,
                                   student_quantile(z, time.freedom) * time.sd);
    const double log_ratio = error.mean + time.mean;
    verdict.valid = true;
    verdict.ratio = std::exp(log_ratio);
    verdict.lo95 = std::exp(log_ratio - half);
    verdict.hi95 = std::exp(log_ratio + half);
    verdict.error_ratio = std::exp(error.mean);
    verdict.time_ratio = std::exp(time.mean);
    verdict.winner = verdict.lo95 > 1 ? Winner::b : verdict.hi95 < 1 ? Winner::a : Winner::none;
    verdict.text = sentence(verdict);
    return verdict;
}

}  // namespace talbot
