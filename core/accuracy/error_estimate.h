// The error of a progressive image from doubling differences: with D(2N) the mean squared
// difference between the images at 2N and N samples, E D(2N) = mse(N) - mse(2N) for sequences with
// exchangeable halves, so the error follows from the differences and their exponent, for scrambled
// sequences too. Metric: relMSE = mean (x - r)^2 / (r^2 + 0.01) over pixels and channels.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/accuracy/convergence_fit.h"
#include "core/accuracy/octave_statistics.h"
#include "core/base/worker_pool.h"
#include "core/film/film.h"
#include "core/film/image.h"

namespace talbot {

enum class Trust : uint8_t { unknown, green, amber, red };
std::string_view trust_name(Trust trust);

// The constant 0.01 of the metric, as it applies to scene-linear values before an exposure of
// `exposure_ev`.
double metric_constant(double exposure_ev);

struct ErrorEstimate {
    bool valid = false;  // from 2 samples on, as soon as two of them differed
    double relrmse_percent = 0;
    double lo95 = 0;
    double hi95 = 0;
    double exponent = 1;  // p in relMSE ~ samples^-p
    double exponent_standard_error = 0;
    double seconds_exponent = 1;      // the same against seconds
    uint64_t samples = 0;             // a pixel, when it was taken
    double seconds = 0;               // of rendering, when it was taken
    double seconds_per_sample = 0;    // of all pixels, lately
    double exposure_ev = 0;           // that the metric was taken after
    double worst_blocks_percent = 0;  // relRMSE that 1 % of the 8x8 blocks exceed
    double top_share = 0;             // of the error, in the 0.1 % of pixels with the largest
    double tail_index = 0;            // Pareto index of the largest blocks
    double energy_drift = 0;   // of the image's mean over the last doubling, in standard deviations
    double brightness_sd = 0;  // of the image's mean, relative to it
    Trust trust = Trust::unknown;
    std::string why;  // one sentence for the trust
    std::vector<Octave> octaves;
    ConvergenceFit fit;  // of the octaves

    struct Prediction {
        bool valid = false;
        // Whether `seconds` is promised: the light is green, and the whole time to the target is
        // within 0.8 to 1.25 of the predicted one with a probability of nine in ten. If not, only
        // the band says something.
        bool firm = false;
        double seconds = 0;
        double lo95 = 0;
        double hi95 = 0;
    };
    // Whether the error is below a target with a probability of nine in ten: where a render that
    // was asked for it stops. Never before two samples have differed.
    bool meets(double target_percent) const;

    // Whether a render that was asked for this error ends: where it is met, and where no two of so
    // many samples differed that it would go on for ever.
    bool ends_render(double target_percent, uint64_t passes, uint64_t all_samples) const;

    // Further seconds of rendering to a target error, with a 95 % band; 0 when it is already met.
    Prediction seconds_to(double target_percent) const;

    // The error in per cent after further seconds of rendering, with a 95 % band.
    struct FutureError {
        bool valid = false;
        double relrmse_percent = 0;
        double lo95 = 0;
        double hi95 = 0;
    };
    FutureError error_after(double further_seconds) const;
};

// Follows a film through its powers of two.
class ErrorTracker {
  public:
    // The film as it was after samples [first_sample, samples); kept by a part of a render at
    // powers of two that it passes.
    struct Mark {
        uint64_t samples = 0;
        double seconds = 0;
        Film film;
    };
    // All that it knows; what a checkpoint keeps, so that a resumed run goes on as if it had never
    // stopped.
    struct State {
        float exposure_ev = 0;
        uint64_t first_sample = 0;
        uint64_t passes = 0;    // at the last observe
        bool adaptive = false;  // then blocks are sampled by `plan`,
        float plan_ev = 0;      // decided after this exposure
        SamplingPlan plan;
        uint64_t half_samples = 0;  // the last power of two
        double half_seconds = 0;
        double seconds_per_sample = 0;
        OctaveMemory memory;  // of the image there
        std::vector<Octave> octaves;
        OctaveStatistics last;
        std::vector<Mark> marks;  // only with a first_sample
    };

    // Forgets everything. The metric is taken after an exposure in EV. With a first_sample the film
    // is one part of a render, and marks are kept, from which merging can compute the octaves of
    // the whole. With `adaptive` the caller must sample by plan(); a part of a render never is.
    void reset(float exposure_ev, uint64_t first_sample = 0, bool adaptive = false);

    // The metric of an image of this width from now on, and of all octaves so far, after another
    // exposure. What is known of the last octave is weighed again, a film scan; the older ones
    // change by the same factor.
    void set_exposure(float exposure_ev, uint32_t width, WorkerPool* pool = nullptr);

    // To be called after every whole pass. Costs a film scan at powers of two, nothing otherwise. A
    // pool shortens the scan and changes no figure.
    void observe(const Film& film, uint64_t passes, double render_seconds,
                 WorkerPool* pool = nullptr);

    // As of the last octave.
    const ErrorEstimate& estimate() const { return estimate_; }

    // Extrapolated to the current number of samples and seconds.
    ErrorEstimate at(uint64_t passes, double render_seconds) const;

    // Per 8x8 block: estimated relRMSE in per cent, row by row; empty before the first octave.
    const std::vector<float>& block_errors() const { return block_errors_; }

    // How many samples the blocks get from the last octave to the next; empty: all alike.
    const SamplingPlan& plan() const { return state_.plan; }

    const State& state() const { return state_; }
    void restore(State state);

  private:
    void derive();

    State state_;
    ErrorEstimate estimate_;
    std::vector<float> block_errors_;
};

}  // namespace talbot
