// One power for the last octaves, drawn towards that of independent samples by as much as the
// octaves leave open.
#include "core/accuracy/convergence_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

namespace talbot {

namespace {

constexpr std::size_t kOctavesUsed = 4;

// Model error: octaves older than the last two count less, since the law drifts.
constexpr double kDriftPerOctave = 0.06;
constexpr double kLeastRelativeError = 0.002;
constexpr double kExponentDrift = 0.04;  // of the exponent, over the octaves to come

struct Point {
    double ratio;     // samples / last samples, <= 1
    double value;     // difference
    double relative;  // its relative standard error
};

// One power for all octaves.
struct PowerLaw {
    double exponent = 0;
    double standard_deviation = 0;
};

// Weighted slope of ln difference over ln samples, drawn towards what images of scenes have. The
// prior's tails are as heavy as those of Cauchy's law: the further the slope lies from its middle
// the less it pulls, or else a picture of edges would be taken for one of many-bounce light.
PowerLaw fit_power(std::span<const Point> points) {
    constexpr double kPrior = 1.0, kPriorSd = 0.035, kTail = 1;
    constexpr double kAlone = 1.05, kAloneSd = 0.13;
    constexpr double kLeastSlopeSd = 0.065;  // odd and even powers of two differ
    constexpr double kMostExponent = 3;
    // The law is sure at 1 only, where all samples are independent; a slope far beyond that of
    // edges is one of smooth light, of which no picture has nothing but.
    constexpr double kDoubtOfLaw = 0.06, kDoubtOfSmooth = 0.6;
    constexpr double kEdges = 1.5, kRough = 1.65;
    if (points.size() == 1) return {kAlone, kAloneSd};
    double w = 0, wx = 0, wy = 0, wxx = 0, wxy = 0;
    for (const Point& p : points) {
        const double weight = 1 / (p.relative * p.relative);
        const double x = -std::log(p.ratio), y = std::log(p.value);
        w += weight;
        wx += weight * x;
        wy += weight * y;
        wxx += weight * x * x;
        wxy += weight * x * y;
    }
    const double sxx = wxx - wx * wx / w;
    const double slope = (wxy - wx * wy / w) / sxx;
    const double slope_variance = 1 / sxx + kLeastSlopeSd * kLeastSlopeSd;
    const double base = kPriorSd * kPriorSd;
    const double off = slope - kPrior;
    const double prior_variance = base * (1 + off * off / (kTail * (base + slope_variance)));
    const double trust = prior_variance / (prior_variance + slope_variance);
    const double exponent = std::clamp(kPrior + trust * off, 1.0, kMostExponent);
    const double doubt = kDoubtOfLaw * (std::min(exponent, kEdges) - 1) +
                         kDoubtOfSmooth * std::max(0.0, exponent - kRough);
    // Where the data and the prior disagree, either may be right.
    constexpr double kDoubtOfPrior = 0.2;
    const double pulled = kDoubtOfPrior * (1 - trust) * off;
    return {exponent, std::hypot(std::sqrt(trust * slope_variance), doubt, pulled)};
}

// v over the difference of the last octave, and the derivative of its logarithm by the exponent.
double level(double exponent) {
    return 1 / (std::exp2(exponent) - 1);
}
double level_slope(double exponent) {
    return std::numbers::ln2 * std::exp2(exponent) * level(exponent);
}

// What the octaves of a render tell of the next ones. An exponent between those of many-bounce
// light and of edges means that both are there, and the edges' part falls by sqrt(2) against the
// rest at every doubling. The slope is that of octaves whose middle lies two doublings back.
void look_ahead(double exponent, ConvergenceFit::Term (&terms)[2]) {
    constexpr double kBounces = 1, kEdges = 1.5, kSince = 0.5;
    terms[0] = {exponent, 1};
    terms[1] = {exponent, 0};
    if (exponent > kEdges) return;
    const double then = (exponent - kBounces) / (kEdges - kBounces);
    const double edges = kSince * then / (1 - then + kSince * then);
    terms[0] = {kBounces, 1 - edges};
    terms[1] = {kEdges, edges};
}

// ln of what the last doubling changed about the octave before by better denominators; NaN where
// that made it vanish.
double log_gain(std::span<const Octave> octaves) {
    const double gain = octaves.size() > 1 ? octaves[octaves.size() - 2].gain : 1;
    return gain > 0 ? std::log(gain) : std::numeric_limits<double>::quiet_NaN();
}

// What better denominators are still expected to make of v: those of lamps smaller than a pixel are
// too small for many doublings, and each brings a part of what is missing.
double denominators_to_come(double log_gain) {
    constexpr double kShare = 0.5;
    return log_gain < 0 ? std::exp(kShare * log_gain) : 1;
}

// Standard deviation of ln v that comes from the denominators and from octaves that follow no law:
// while there are few samples, what a pixel converges to is hardly known and every doubling brings
// another stratum; later, a part of what the last doubling changed about the denominators.
double law_and_denominator_sd(std::span<const Octave> octaves, double log_gain) {
    constexpr double kUnknown = 16, kDoubtOfUnknown = 0.5;
    constexpr double kFewSamples = 32, kDoubtOfFew = 0.22, kDoubtAlways = 0.02;
    constexpr double kDoubtOfWeights = 0.5;
    const double samples = static_cast<double>(octaves.back().samples);
    const double doubt = samples < kUnknown      ? kDoubtOfUnknown
                         : samples < kFewSamples ? kDoubtOfFew
                                                 : kDoubtAlways;
    return std::hypot(doubt, std::isnan(log_gain) ? kDoubtOfUnknown : kDoubtOfWeights * log_gain);
}

// The last octaves, newest first. Where blocks rested, an older difference is that of the newer one
// times the ratio in the blocks that did not (a chain index), for a block at rest says nothing of
// the slope.
std::vector<Point> points_of(std::span<const Octave> octaves) {
    constexpr double kLeastActive = 0.05;
    std::vector<Point> points;
    double scale = 1;
    for (std::size_t i = octaves.size(); i-- > 0 && points.size() < kOctavesUsed;) {
        const Octave& o = octaves[i];
        if (!(o.difference > 0)) break;
        const double age = static_cast<double>(points.size());
        const double drift = kDriftPerOctave * std::max(0.0, age - 1);
        const double own = std::max(o.standard_error / o.difference, kLeastRelativeError);
        const double samples = static_cast<double>(octaves.back().samples);
        points.push_back({static_cast<double>(o.samples) / samples, scale * o.difference,
                          std::hypot(own, drift)});
        if (i == 0 || o.active_share >= 1) continue;
        const double resting = (1 - o.active_share) * o.difference;
        const double before = octaves[i - 1].difference - resting;
        if (o.active_share < kLeastActive || !(before > 0)) break;
        scale *= before / (o.active_share * octaves[i - 1].difference);
    }
    return points;
}

}  // namespace

double ConvergenceFit::smooth(double n) const {
    const double log_ratio = std::log(n / samples);
    double sum = 0;
    for (const Term& term : terms) {
        if (term.share > 0) sum += term.share * std::exp(-term.exponent * log_ratio);
    }
    return v * sum;
}

double ConvergenceFit::exponent_at(double n) const {
    const double log_ratio = std::log(n / samples);
    double sum = 0, weighted = 0;
    for (const Term& term : terms) {
        if (!(term.share > 0)) continue;
        const double part = term.share * std::exp(-term.exponent * log_ratio);
        sum += part;
        weighted += part * term.exponent;
    }
    return sum > 0 ? weighted / sum : 1;
}

double ConvergenceFit::at(uint64_t n) const {
    if (n == 0) return 0;
    double sum = 0;
    double later = static_cast<double>(n);
    for (uint64_t bit = uint64_t{1} << 63; bit != 0; bit >>= 1) {
        if ((n & bit) == 0) continue;
        const double m = static_cast<double>(bit);
        later -= m;
        const double own = smooth(m);
        sum += m * m * own;
        if (later > 0) sum += 2 * m * later * (2 * smooth(2 * m) - own);
    }
    const double total = static_cast<double>(n);
    return sum / (total * total);
}

double ConvergenceFit::log_sd(double n) const {
    const double drift = exponent_sd * std::log(n / samples);
    return std::sqrt(log_v_sd * log_v_sd + drift * drift);
}

ConvergenceFit fit_convergence(std::span<const Octave> octaves) {
    ConvergenceFit fit;
    if (octaves.empty()) return fit;
    fit.samples = static_cast<double>(octaves.back().samples);
    fit.terms[0] = {1, 1};
    const std::vector<Point> points = points_of(octaves);
    if (points.empty()) return fit;

    const PowerLaw law = fit_power(points);
    const double gain = log_gain(octaves);
    fit.v = points[0].value * level(law.exponent) * denominators_to_come(gain);
    look_ahead(law.exponent, fit.terms);
    fit.exponent = fit.exponent_at(fit.samples);
    fit.exponent_sd = std::hypot(law.standard_deviation, kExponentDrift);
    // The difference scatters about its expectation, and so does the true error of this one image,
    // somewhat more: a pixel's largest errors are those that its halves share.
    constexpr double kScatterOfBoth = 2.5;
    const double own = octaves.back().standard_error / octaves.back().difference;
    const double by_exponent = level_slope(law.exponent) * law.standard_deviation;
    fit.log_v_sd = std::hypot(std::sqrt(kScatterOfBoth) * own, by_exponent,
                              law_and_denominator_sd(octaves, gain));
    return fit;
}

}  // namespace talbot
