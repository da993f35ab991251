// Two fits: weighted non-negative least squares with one or two powers from a fixed set, by trying
// all pairs; and one power, shrunk towards what images usually have.
#include "core/accuracy/convergence_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

namespace talbot {

namespace {

constexpr std::array<double, 5> kExponents{1, 1.5, 2, 2.5, 3};
constexpr std::size_t kOctavesUsed = 4;

// Model error: octaves older than the last two count less, since the law drifts.
constexpr double kDriftPerOctave = 0.1;
constexpr double kLeastRelativeError = 0.002;
constexpr double kExponentDrift = 0.04;  // of the exponent, over the octaves to come

struct Point {
    double ratio;     // samples / last samples, <= 1
    double value;     // difference
    double relative;  // its relative standard error
};

struct Mixture {
    double v[2] = {0, 0};
    double exponent[2] = {1, 1};
    double total() const { return v[0] + v[1]; }
};

// What a term with v = 1 at the last octave contributes to the difference at `ratio`.
double difference_of_term(double exponent, double ratio) {
    return (std::exp2(exponent) - 1) * std::pow(ratio, -exponent);
}

Mixture fit_mixture(std::span<const Point> points) {
    Mixture best;
    double best_residual = HUGE_VAL;
    const auto consider = [&](double p0, double p1, double v0, double v1) {
        if (!(v0 >= 0) || !(v1 >= 0)) return;
        double residual = 0;
        for (const Point& point : points) {
            const double model =
                v0 * difference_of_term(p0, point.ratio) + v1 * difference_of_term(p1, point.ratio);
            const double r = (model / point.value - 1) / point.relative;
            residual += r * r;
        }
        // Ties go to the earlier, flatter pair.
        if (residual >= best_residual) return;
        best_residual = residual;
        best = Mixture{{v0, v1}, {p0, p1}};
    };
    for (std::size_t i = 0; i < kExponents.size(); ++i) {
        for (std::size_t j = i; j < kExponents.size(); ++j) {
            double aa = 0, ab = 0, bb = 0, ay = 0, by = 0;
            for (const Point& point : points) {
                const double weight = 1 / (point.relative * point.value);
                const double a = weight * difference_of_term(kExponents[i], point.ratio);
                const double b = weight * difference_of_term(kExponents[j], point.ratio);
                const double y = 1 / point.relative;
                aa += a * a;
                ab += a * b;
                bb += b * b;
                ay += a * y;
                by += b * y;
            }
            if (i == j) {
                consider(kExponents[i], kExponents[i], ay / aa, 0);
            } else if (points.size() > 1) {
                const double determinant = aa * bb - ab * ab;
                if (!(determinant > 0)) continue;
                consider(kExponents[i], kExponents[j], (ay * bb - by * ab) / determinant,
                         (by * aa - ay * ab) / determinant);
            }
        }
    }
    return best;
}

// One power for all octaves.
struct PowerLaw {
    double exponent = 0;
    double standard_deviation = 0;
};

// Weighted slope of ln difference over ln samples, drawn towards what images of scenes have. The
// weaker the prior the further the slope lies from it, so that clear data win.
PowerLaw fit_power(std::span<const Point> points) {
    constexpr double kPrior = 1.05, kPriorSd = 0.05, kAloneSd = 0.13;
    constexpr double kLeastSlopeSd = 0.03;  // odd and even powers of two differ
    constexpr double kMostExponent = 3;
    // The law is sure at 1 only, where all samples are independent; a slope beyond that of edges is
    // one of smooth light, of which no picture has nothing but.
    constexpr double kDoubtOfLaw = 0.1, kDoubtOfSmooth = 0.4, kEdges = 1.5;
    if (points.size() == 1) return {kPrior, kAloneSd};
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
    const double prior_variance = base * (1 + off * off / (4 * (base + slope_variance)));
    const double trust = prior_variance / (prior_variance + slope_variance);
    const double exponent = std::clamp(kPrior + trust * off, 1.0, kMostExponent);
    const double doubt =
        kDoubtOfLaw * (exponent - 1) + kDoubtOfSmooth * std::max(0.0, exponent - kEdges);
    // Where the data and the prior disagree, either may be right.
    constexpr double kDoubtOfPrior = 0.7;
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

// Standard deviation of ln v that comes from the denominators and from octaves that follow no law:
// while there are few samples, what a pixel converges to is hardly known and every doubling brings
// another stratum; later, what the last doubling changed about the denominators tells.
double law_and_denominator_sd(std::span<const Octave> octaves) {
    constexpr double kUnknown = 16, kDoubtOfUnknown = 0.4;
    constexpr double kFewSamples = 32, kDoubtOfFew = 0.2, kDoubtAlways = 0.03;
    const double gain = octaves.size() > 1 ? octaves[octaves.size() - 2].gain : 1;
    const double samples = static_cast<double>(octaves.back().samples);
    const double doubt = samples < kUnknown      ? kDoubtOfUnknown
                         : samples < kFewSamples ? kDoubtOfFew
                                                 : kDoubtAlways;
    return std::hypot(doubt, gain > 0 ? std::log(gain) : kDoubtOfUnknown);
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
    std::vector<Point> points;  // newest first
    for (std::size_t i = octaves.size(); i-- > 0 && points.size() < kOctavesUsed;) {
        const Octave& o = octaves[i];
        if (!(o.difference > 0)) break;
        const double age = static_cast<double>(points.size());
        const double drift = kDriftPerOctave * std::max(0.0, age - 1);
        const double own = std::max(o.standard_error / o.difference, kLeastRelativeError);
        points.push_back(
            {static_cast<double>(o.samples) / fit.samples, o.difference, std::hypot(own, drift)});
    }
    if (points.empty()) return fit;

    // Two views of the same octaves, one that follows them closely and one that is steady; what is
    // wrong with either is wrong with half the weight in their mean.
    const PowerLaw law = fit_power(points);
    const double steady = points[0].value * level(law.exponent);
    const double close = points.size() > 1 ? fit_mixture(points).total() : steady;
    fit.v = std::sqrt(steady * close);
    look_ahead(law.exponent, fit.terms);
    fit.exponent = fit.exponent_at(fit.samples);
    fit.exponent_sd = std::hypot(law.standard_deviation, kExponentDrift);
    // The difference scatters about its expectation, and so does the true error of this one image.
    const double own = octaves.back().standard_error / octaves.back().difference;
    const double by_exponent = level_slope(law.exponent) * law.standard_deviation;
    fit.log_v_sd =
        std::hypot(std::numbers::sqrt2 * own, by_exponent, law_and_denominator_sd(octaves));
    return fit;
}

}  // namespace talbot
