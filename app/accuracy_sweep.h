// Sweeps of `talbot accuracy`: configurations of one scene rendered in lock step, each with its
// curve of error against seconds, its bias, and its time to the target.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/accuracy_render.h"
#include "core/accuracy/bias_floor.h"

namespace talbot {

struct SweepConfig {
    std::string key;  // "base" for the settings as given
    std::string value;
    std::string flags;  // for the command line
    RenderSettings settings;
    // Whether it may converge to another picture than the base.
    bool may_be_biased = false;

    std::string label() const { return key == "base" ? key : key + "=" + value; }
};

struct CurvePoint {
    double seconds = 0;
    double cpu_seconds = 0;
    uint64_t samples = 0;  // a pixel
    uint64_t rays = 0;
    double relrmse_percent = 0;  // with the floor, if there is one
    double lo95 = 0;
    double hi95 = 0;
    double exponent = 1;
    Trust trust = Trust::unknown;
};

// Seconds from the first sample to the target; invalid where it is never met or not known.
struct TimeToTarget {
    bool valid = false;
    bool measured = false;  // reached in this run, else predicted
    double seconds = 0;
    double lo95 = 0;
    double hi95 = 0;
    std::string why;  // it is not valid
};

struct SweepResult {
    SweepConfig config;
    std::vector<CurvePoint> curve;
    BiasFloor floor;
    std::optional<double> loss_after_seconds;  // with a floor: from then on the base is better
    TimeToTarget to_target;
    ErrorEstimate last;
    bool pareto = false;  // no other configuration is both faster and better at its best point
    ImageRgba first_image;
    ImageRgba image;
    std::vector<float> block_errors;
    uint32_t width = 0, height = 0;
};

struct SweepPlan {
    std::vector<SweepConfig> configs;  // the first is the base
    double budget_seconds = 60;        // for all together
    double target_percent = 0;         // 0: chosen from the base's last error
};

// The base and one configuration for each value; a usage error names what is wrong. Without sweeps,
// a default set of what the renderer can switch.
Result<std::vector<SweepConfig>> sweep_configs(const RenderSettings& base,
                                               const std::vector<std::string>& sweeps);

struct SweepOutcome {
    double target_percent = 0;
    std::vector<SweepResult> results;  // by seconds to the target, the base among them
};
SweepOutcome run_sweep(const AccuracyScene& scene, const SweepPlan& plan, WorkerPool& pool);

// A run of one configuration with another seed that stops by its own error.
struct Verification {
    bool done = false;
    bool met = false;
    double seconds = 0;
    ErrorEstimate error;
};
Verification verify(const AccuracyScene& scene, const SweepResult& choice, double target_percent,
                    double budget_seconds, WorkerPool& pool);

}  // namespace talbot
