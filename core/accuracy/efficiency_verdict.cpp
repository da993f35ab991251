#include "core/accuracy/efficiency_verdict.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>

#include "core/math/sample_bits.h"

namespace talbot {
namespace {

constexpr int kResamples = 400;
// Both intervals are approximate, for noise has tails and load on a machine comes in waves: half of
// the 5 % that may err is kept back.
constexpr double kLevel = 0.025;
// Two runs of one program differ by so much in speed for good, by where their memory lies: standard
// deviation of the logarithm, which no number of pairs removes.
constexpr double kPlaceSd = 0.005;
// Of the logarithm of a time ratio, while too few pairs were measured to see it.
constexpr double kUnknownTimeSd = 0.5;
constexpr std::size_t kLeastPairs = 8;
constexpr std::size_t kStretches = 8;  // of time, each of many pairs

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

// Standard deviation of the mean of values in their order, by the means of stretches of them: other
// work on the machine lasts longer than one value.
double stretched_sd(const std::vector<double>& values) {
    double sum = 0, square = 0;
    for (std::size_t i = 0; i < kStretches; ++i) {
        const std::size_t begin = i * values.size() / kStretches;
        const std::size_t end = (i + 1) * values.size() / kStretches;
        double mean = 0;
        for (std::size_t k = begin; k < end; ++k) mean += values[k];
        mean /= static_cast<double>(end - begin);
        sum += mean;
        square += mean * mean;
    }
    const double n = static_cast<double>(kStretches);
    return std::sqrt(std::max(0.0, square - sum * sum / n) / (n * (n - 1)));
}

// The trimmed mean over pairs of ln (a / b), for other work on the machine makes outliers, and its
// standard deviation from the winsorised values (Tukey, McLaughlin 1963), or from stretches of them
// where that is more.
LogRatio time_ratio(std::span<const TimePair> pairs) {
    constexpr double kTrimmed = 0.2;  // at each end
    std::vector<double> in_order;
    for (const TimePair& p : pairs) {
        if (p.a > 0 && p.b > 0) in_order.push_back(std::log(p.a / p.b));
    }
    if (in_order.empty()) return {0, kUnknownTimeSd};
    std::vector<double> ratios = in_order;
    std::sort(ratios.begin(), ratios.end());
    const std::size_t count = ratios.size();
    if (count < kLeastPairs) return {ratios[count / 2], kUnknownTimeSd};
    const std::size_t cut = static_cast<std::size_t>(kTrimmed * static_cast<double>(count));
    const double low = ratios[cut], high = ratios[count - 1 - cut];
    double kept = 0, sum = 0, square = 0;
    for (std::size_t i = 0; i < count; ++i) {
        if (i >= cut && i < count - cut) kept += ratios[i];
        double& x = in_order[i];
        x = std::clamp(x, low, high);
        sum += x;
        square += x * x;
    }
    const double n = static_cast<double>(count), left = static_cast<double>(count - 2 * cut);
    const double variance = std::max(0.0, square - sum * sum / n) / (left * (left - 1));
    LogRatio ratio{kept / left, std::sqrt(variance), left - 1};
    if (count >= 2 * kStretches) {
        // Winsorised values vary less than those that the trimmed mean stands for.
        const double sd = stretched_sd(in_order) * n / left;
        if (sd > ratio.sd) ratio = {ratio.mean, sd, static_cast<double>(kStretches - 1)};
    }
    return ratio;
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

std::string times(double ratio) {
    char text[32];
    std::snprintf(text, sizeof(text), ratio < 9.95 ? "%.2f" : "%.0f", ratio);
    return text;
}

std::string sentence(const EfficiencyVerdict& v) {
    const bool b = v.winner == Winner::b;
    // Beyond this the interval says nothing.
    constexpr double kWidest = 100;
    if (v.winner == Winner::none && !(v.hi95 < kWidest * v.lo95))
        return "no difference yet: too few renders to tell";
    if (v.winner == Winner::none)
        return "no difference yet (" + times(v.ratio) + "x, " + times(v.lo95) + " to " +
               times(v.hi95) + ")";
    const double ratio = b ? v.ratio : 1 / v.ratio;
    const double low = b ? v.lo95 : 1 / v.hi95, high = b ? v.hi95 : 1 / v.lo95;
    return std::string(b ? "B" : "A") + " is " + times(ratio) + "x (" + times(low) + " to " +
           times(high) + ") more efficient on this view";
}

}  // namespace

double level_of_look(double level, uint64_t k) {
    const double look = static_cast<double>(k);
    return level / (look * (look + 1));
}

double student_quantile(double probability, double freedom) {
    if (!std::isfinite(freedom)) return two_sided_quantile(probability);
    const double n = freedom;
    if (n == 2) return std::sqrt(2 / (probability * (2 - probability)) - 2);
    if (n == 1) return 1 / std::tan(probability * std::numbers::pi / 2);
    const double a = 1 / (n - 0.5), b = 48 / (a * a);
    double c = ((20700 * a / b - 98) * a - 16) * a + 96.36;
    const double d = ((94.5 / (b + c) - 3) / b + 1) * std::sqrt(a * std::numbers::pi / 2) * n;
    double y = std::pow(d * probability, 2 / n);
    if (y > 0.05 + a) {
        const double x = -two_sided_quantile(probability);
        y = x * x;
        if (n < 5) c += 0.3 * (n - 4.5) * (x + 0.6);
        c = (((0.05 * d * x - 5) * x - 7) * x - 2) * x + b + c;
        y = (((((0.4 * y + 6.3) * y + 36) * y + 94.5) / c - y - 3) / b + 1) * x;
        y = std::expm1(a * y * y);
    } else {
        y = ((1 / (((n + 6) / (n * y) - 0.089 * d - 0.822) * (n + 2) * 3) + 0.5 / (n + 4)) * y -
             1) *
                (n + 1) / (n + 2) +
            1 / y;
    }
    return std::sqrt(n * y);
}

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
    const double level = level_of_look(kLevel, looks);
    const double half = std::hypot(student_quantile(level, error.freedom) * error.sd,
                                   student_quantile(level, time.freedom) * time.sd,
                                   two_sided_quantile(level) * kPlaceSd);
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
