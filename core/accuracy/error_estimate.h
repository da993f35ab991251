// The error of a progressive image from doubling differences: with D(2N) the mean squared difference between the images at 2N
// and N samples, E D(2N) = mse(N) - mse(2N) for sequences with exchangeable halves, so the error follows from the differences
// and their exponent, for scrambled sequences too. Metric: relMSE = mean (x - r)^2 / (r^2 + 0.01) over pixels and channels.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/film/film.h"
#include "core/film/image.h"

namespace talbot {

enum class Trust : uint8_t { unknown, green, amber, red };
std::string_view trust_name(Trust trust);

// One power of two.
struct Octave {
    uint64_t samples = 0;        // 2N
    double seconds = 0;          // of rendering up to here
    double difference = 0;       // relMSE-weighted D(2N)
    double standard_error = 0;   // of difference, from blocks
};

struct ErrorEstimate {
    bool valid = false;           // from 2 samples on
    double relrmse_percent = 0;
    double lo95 = 0;
    double hi95 = 0;
    double exponent = 1;          // p in relMSE ~ samples^-p
    double exponent_standard_error = 0;
    double seconds_exponent = 1;  // the same against seconds
    double seconds = 0;           // when it was taken
    Trust trust = Trust::unknown;
    std::string why;              // one sentence for the trust
    std::vector<Octave> octaves;

    // Further seconds of rendering to a target error, with a 95 % band; 0 when it is already met.
    struct Prediction {
        bool valid = false;
        double seconds = 0;
        double lo95 = 0;
        double hi95 = 0;
    };
    Prediction seconds_to(double target_percent) const;
};

// Follows a film through its powers of two.
class ErrorTracker {
  public:
    // Forgets everything; exposure in EV scales the metric's constant.
    void reset(float exposure_ev);

    // To be called after every whole pass. Costs a film scan at powers of two, nothing otherwise.
    void observe(const Film& film, uint64_t passes, double render_seconds);

    const ErrorEstimate& estimate() const { return estimate_; }

    // Extrapolated to the current number of samples and seconds.
    ErrorEstimate at(uint64_t passes, double render_seconds) const;

    // Per 8x8 block: estimated relRMSE in per cent, row by row; empty before the first octave.
    const std::vector<float>& block_errors() const { return block_errors_; }

  private:
    void fit();

    float exposure_scale_ = 1;
    uint32_t width_ = 0;
    uint32_t height_ = 0;
    uint64_t half_samples_ = 0;
    std::vector<Rgb> half_;
    std::vector<float> block_errors_;
    std::vector<double> block_differences_;
    double energy_ = 0;
    double half_energy_ = 0;
    ErrorEstimate estimate_;
};

}  // namespace talbot
