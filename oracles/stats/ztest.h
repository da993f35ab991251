// Tests of means whose variance is known or estimated from many samples.
#pragma once

#include <cmath>

#include "oracles/stats/distribution_tails.h"

namespace talbot::stats {

// Mean and variance of a stream, without cancellation (Welford 1962).
class Moments {
  public:
    void add(double x) {
        ++n_;
        const double delta = x - mean_;
        mean_ += delta / n_;
        square_ += delta * (x - mean_);
    }
    double n() const { return n_; }
    double mean() const { return mean_; }
    double variance() const { return n_ > 1 ? square_ / (n_ - 1) : 0; }
    double standard_error() const { return n_ > 0 ? std::sqrt(variance() / n_) : 0; }

  private:
    double n_ = 0;
    double mean_ = 0;
    double square_ = 0;
};

// p that a normal mean with this standard error lies so far from what is expected. An exact mean
// has error 0: equal or p = 0.
inline double z_test(double mean, double expected, double standard_error) {
    if (!(standard_error > 0)) return mean == expected ? 1 : 0;
    return normal_two_sided((mean - expected) / standard_error);
}
inline double z_test(const Moments& m, double expected) {
    return z_test(m.mean(), expected, m.standard_error());
}

// p that `hits` of n trials came with probability `chance` (normal approximation, continuity
// corrected).
inline double proportion_test(double hits, double n, double chance) {
    const double error = std::sqrt(n * chance * (1 - chance));
    const double distance = std::max(std::abs(hits - n * chance) - 0.5, 0.0);
    return z_test(distance, 0, error);
}

}  // namespace talbot::stats
