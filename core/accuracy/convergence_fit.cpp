// Weighted non-negative least squares with one or two powers from a fixed set, by trying all pairs.
#include "core/accuracy/convergence_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace talbot {

namespace {

constexpr std::array<double, 5> kExponents{1, 1.5, 2, 2.5, 3};
constexpr std::size_t kOctavesUsed = 4;

// Model error: octaves older than the last two count less, since the law drifts.
constexpr double kDriftPerOctave = 0.1;
constexpr double kLeastRelativeError = 0.002;

// With a single octave the exponent is unknown: between the independent sampler's 1 and what edges
// give.
constexpr double kFirstShareOfOne = 0.6;

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

double mean_exponent(const Mixture& m) {
    return (m.v[0] * m.exponent[0] + m.v[1] * m.exponent[1]) / m.total();
}

// The variance of ln v that the law itself does not know, by how far the exponent is from the
// certain 1.
double model_variance(double exponent, std::size_t octaves) {
    const double sd = (octaves == 1 ? 0.3 : octaves == 2 ? 0.12 : 0.02) + 0.12 * (exponent - 1);
    return sd * sd;
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

    if (points.size() == 1) {
        fit.terms[0] = {1, kFirstShareOfOne};
        fit.terms[1] = {1.5, 1 - kFirstShareOfOne};
        const double both = kFirstShareOfOne * difference_of_term(1, 1) +
                            (1 - kFirstShareOfOne) * difference_of_term(1.5, 1);
        fit.v = points[0].value / both;
        fit.exponent = kFirstShareOfOne + 1.5 * (1 - kFirstShareOfOne);
        fit.exponent_sd = 0.3;
        fit.log_v_sd = std::sqrt(2 * points[0].relative * points[0].relative +
                                 model_variance(fit.exponent, 1));
        return fit;
    }

    const Mixture mixture = fit_mixture(points);
    fit.v = mixture.total();
    for (int i = 0; i < 2; ++i) fit.terms[i] = {mixture.exponent[i], mixture.v[i] / fit.v};
    fit.exponent = mean_exponent(mixture);
    // Delta method: each difference moved by one standard error.
    double v_variance = 0, exponent_variance = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const double own = octaves[octaves.size() - 1 - i].standard_error / points[i].value;
        double v_change = 0, exponent_change = 0;
        for (const double sign : {1.0, -1.0}) {
            std::vector<Point> moved = points;
            moved[i].value *= std::exp(sign * own);
            const Mixture other = fit_mixture(moved);
            v_change += sign * 0.5 * std::log(other.total() / fit.v);
            exponent_change += sign * 0.5 * (mean_exponent(other) - fit.exponent);
        }
        v_variance += v_change * v_change;
        exponent_variance += exponent_change * exponent_change;
    }
    // The true error of this one image scatters about its expectation as the difference does.
    const double realised = octaves.back().standard_error / octaves.back().difference;
    fit.log_v_sd =
        std::sqrt(v_variance + realised * realised + model_variance(fit.exponent, points.size()));
    const double drift = 0.02 + 0.15 * (fit.exponent - 1);
    fit.exponent_sd = std::sqrt(exponent_variance + drift * drift);
    return fit;
}

}  // namespace talbot
