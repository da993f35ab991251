// Tail probabilities of the distributions that the statistical tests refer to, in double, accurate
// to about 1e-12.
#pragma once

#include <cmath>
#include <limits>

namespace talbot::stats {

// Regularised upper incomplete gamma function Q(a, x), a > 0: power series below a + 1, continued
// fraction (Lentz) above.
inline double upper_gamma(double a, double x) {
    if (!(x > 0)) return 1;
    const double front = std::exp(a * std::log(x) - x - std::lgamma(a));
    constexpr double kTiny = 1e-300;
    constexpr double kPrecision = 1e-15;
    if (x < a + 1) {
        double term = 1 / a;
        double sum = term;
        for (double n = a + 1; term > sum * kPrecision; ++n) {
            term *= x / n;
            sum += term;
        }
        return 1 - front * sum;
    }
    double b = x + 1 - a;
    double c = 1 / kTiny;
    double d = 1 / b;
    double h = d;
    for (int i = 1; i < 100000; ++i) {
        const double an = -i * (i - a);
        b += 2;
        d = 1 / (an * d + b);
        c = b + an / c;
        h *= c * d;
        if (std::abs(c * d - 1) < kPrecision) break;
    }
    return front * h;
}

// Regularised incomplete beta function I_x(a, b) by its continued fraction (Lentz).
inline double incomplete_beta(double a, double b, double x) {
    if (!(x > 0)) return 0;
    if (!(x < 1)) return 1;
    if (x > (a + 1) / (a + b + 2)) return 1 - incomplete_beta(b, a, 1 - x);
    const double front = std::exp(std::lgamma(a + b) - std::lgamma(a) - std::lgamma(b) +
                                  a * std::log(x) + b * std::log1p(-x)) /
                         a;
    constexpr double kTiny = 1e-300;
    constexpr double kPrecision = 1e-15;
    const auto guard = [](double v) { return std::abs(v) < kTiny ? kTiny : v; };
    double c = 1;
    double d = 1 / guard(1 - (a + b) * x / (a + 1));
    double h = d;
    for (int m = 1; m < 100000; ++m) {
        const double even = m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m));
        d = 1 / guard(1 + even * d);
        c = guard(1 + even / c);
        h *= c * d;
        const double odd = -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1));
        d = 1 / guard(1 + odd * d);
        c = guard(1 + odd / c);
        h *= c * d;
        if (std::abs(c * d - 1) < kPrecision) break;
    }
    return front * h;
}

// P(chi^2 with that many degrees of freedom > x).
inline double chi2_tail(double x, double degrees) {
    return upper_gamma(0.5 * degrees, 0.5 * x);
}

// P(|normal| > |z|).
inline double normal_two_sided(double z) {
    return std::erfc(std::abs(z) / std::sqrt(2.0));
}

// P(|Student t| > |t|).
inline double student_two_sided(double t, double degrees) {
    return incomplete_beta(0.5 * degrees, 0.5, degrees / (degrees + t * t));
}

// Significance of one of n independent tests so that together they raise a false alarm with this
// probability (Sidak).
inline double sidak(double familywise, int n) {
    return -std::expm1(std::log1p(-familywise) / n);
}

// False alarms of a whole test program.
inline constexpr double kFalseAlarm = 1e-4;

}  // namespace talbot::stats
