// Whether the stated errors are true: claims beside the truth, and what they add up to. The truth
// comes from a reference of many more samples, whose own variance is subtracted.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/accuracy/error_estimate.h"
#include "core/film/image.h"

namespace talbot {

// A converged image from independent renders, with the variance of its pixels' means between them.
struct Reference {
    ImageRgba image;
    std::vector<Rgb> variance;
    uint64_t samples = 0;  // a pixel, of all renders together
};

// The mean of at least two independent renders of the same thing, all with the same number of
// samples.
Reference make_reference(const std::vector<const Film*>& renders);

// relMSE of a film against a reference without the reference's own variance; may come out negative
// where the film is no worse than the reference.
double true_relmse(const Film& film, const Reference& reference, double metric_constant);

// Mean of a film over the reference's, minus 1, in per cent; 0 where the reference is black.
double brightness_percent(const Film& film, const Reference& reference);

// relMSE-weighted squared difference of two films with the reference in the denominator: what an
// octave's difference would be if the converged image were known.
double relative_difference(const Film& a, const Film& b, const Reference& reference,
                           double metric_constant);

// What the error of a render was said to be, and what it was.
struct ErrorClaim {
    uint64_t seed = 0;
    uint64_t samples = 0;
    double estimate = 0;  // relRMSE in per cent, as everything here
    double lo95 = 0;
    double hi95 = 0;
    double truth = 0;
    double exponent = 1;
    Trust trust = Trust::unknown;

    bool inside() const { return lo95 <= truth && truth <= hi95; }
};

// From the start of a render to a target error, predicted on the way and taken: in samples a pixel,
// which is what the estimate answers for, and in seconds, where the clock of a machine with other
// work comes in.
struct PredictionClaim {
    uint64_t seed = 0;
    uint64_t samples = 0;  // when it was made
    double target_percent = 0;
    double predicted = 0;
    double lo95 = 0;
    double hi95 = 0;
    double actual = 0;
    double predicted_seconds = 0;
    double actual_seconds = 0;
    Trust trust = Trust::unknown;
    bool firm = false;  // the predicted value itself is promised, not its band alone

    static bool within(double ratio) { return ratio >= 0.8 && ratio <= 1.25; }
    bool close() const { return within(actual / predicted); }
    bool close_in_seconds() const { return within(actual_seconds / predicted_seconds); }
};

// A render that ended by its target error.
struct StopClaim {
    uint64_t seed = 0;
    uint64_t samples = 0;
    double target_percent = 0;
    double truth = 0;
    double brightness_percent = 0;  // of its mean against the reference's
    Trust trust = Trust::unknown;

    double ratio() const { return truth / target_percent; }
    bool kept() const { return ratio() >= 0.75 && ratio() <= 1.05; }
};

struct Calibration {
    std::string scene;
    std::vector<ErrorClaim> errors;
    std::vector<PredictionClaim> predictions;
    std::vector<StopClaim> stops;
    // Targets that some render had not met at its end, or met before it was watched: those that
    // stopped at them are a choice, which says nothing of their brightness.
    std::vector<double> open_targets;
};

struct CalibrationSummary {
    std::size_t claims = 0;         // with a green light; everything below is of these
    double coverage = 0;            // share of truths inside the 95 % interval
    double coverage_sd = 0;         // by seeds, for the claims of one render are not independent
    double ratio = 1;               // geometric mean of estimate over truth
    double mean_width = 0;          // of ln(hi95 / lo95)
    std::size_t predictions = 0;    // with a green light
    double predictions_inside = 0;  // share of these with the actual value in the 95 % band
    std::size_t predictions_firm = 0;
    // Of the firm ones: share with actual over predicted within 0.8 to 1.25, the same by the clock,
    // and the geometric mean of that ratio.
    double predictions_close = 0;
    double predictions_close_seconds = 0;
    double prediction_ratio = 1;
    double all_predictions_close = 0;  // firm or not
    std::size_t stops = 0;             // at 32 samples or more
    double stops_kept = 0;             // share of these with truth over target within 0.75 to 1.05
    double stop_ratio = 1;             // geometric mean of truth over target
    // Of how many renders that stopped with a green light, whichever samples they had, the mean
    // brightness and its standard deviation: a rule that stops where light is still missing makes
    // pictures too dark.
    std::size_t lit_stops = 0;
    double stop_brightness_percent = 0;
    double stop_brightness_sd = 0;
    double green = 0;  // share of all claims from kTrustSamples samples on, by light
    double amber = 0;
    double red = 0;
};

CalibrationSummary summarise(const std::vector<const Calibration*>& scenes);

// The promises that a summary breaks beyond doubt (two standard deviations), one line each. `whole`
// asks for what holds over all scenes; a single scene is held to less.
std::vector<std::string> broken_promises(const CalibrationSummary& summary, bool whole);

}  // namespace talbot
