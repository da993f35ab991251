// How the error of a render falls with its samples: v(N) from the differences of the last octaves.
// A real image holds smooth areas (N^-3), edges (N^-3/2) and many-bounce light (N^-1) at once
// (Mitchell 1996).
#pragma once

#include <cstdint>
#include <span>

namespace talbot {

// One power of two.
struct Octave {
    uint64_t samples = 0;  // 2N
    double seconds = 0;    // of rendering up to here
    double difference =
        0;  // relMSE-weighted D(2N) = mean squared difference of the images at 2N and N
    double standard_error = 0;  // of difference, from pixels
    double gain = 1;            // of difference, when the next octave gave better denominators
    double active_share = 1;    // of difference, in blocks that did not rest in this octave
    double top_share = 0;       // of difference, in the 0.1 % of pixels with the largest
};

struct ConvergenceFit {
    struct Term {
        double exponent = 1;
        double share = 0;  // of v at the last octave
    };
    double samples = 0;  // at the last octave
    double v = 0;        // relMSE there
    double log_v_sd =
        0;  // of ln v against this image's true error, the fit's own uncertainty included
    double exponent = 1;  // p in v ~ N^-p at the last octave
    double exponent_sd = 0;
    Term terms[2];

    // The smooth law at any number of samples (> 0).
    double smooth(double n) const;

    // -d ln smooth / d ln n.
    double exponent_at(double n) const;

    // What a whole number of samples has in a scrambled sequence: the points up to n are nets of
    // the sizes of n's binary digits, and the halves of a net have covariance 2 v(2m) - v(m). Equal
    // to smooth(n) at powers of two and where the exponent is 1.
    double at(uint64_t n) const;

    // Standard deviation of ln v(n), which grows with the distance from the last octave.
    double log_sd(double n) const;
};

// Uses the last octaves with a difference; all zero or none gives v = 0.
ConvergenceFit fit_convergence(std::span<const Octave> octaves);

}  // namespace talbot
