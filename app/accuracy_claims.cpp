#include "app/accuracy_claims.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "app/json_figures.h"

namespace talbot {
namespace {

using nlohmann::ordered_json;

// What --target-error is asked for in the stop test; only targets that are met on the way count.
constexpr double kTargets[] = {50, 20, 10, 5, 2, 1};
// Octaves that must have been seen before a prediction counts.
constexpr std::size_t kOctavesForPrediction = 3;

struct Milestone {
    ErrorEstimate error;
    double truth = 0;
    double cpu_seconds = 0;
    uint64_t rays = 0;
    double samples_a_pixel = 0;  // on the mean
};

// The first number of samples in (n, 2n) at which --target-error would stop, 0 if none.
uint64_t stop_within(const ErrorTracker& tracker, uint64_t n, double target) {
    for (uint64_t m = n + 1; m < 2 * n; ++m) {
        if (tracker.at(m, 0).meets(target)) return m;
    }
    return 0;
}

ordered_json octave_json(uint64_t seed, const Milestone& m, double by_reference) {
    const ErrorEstimate& e = m.error;
    ordered_json octaves = ordered_json::array();
    for (const Octave& o : e.octaves)
        octaves.push_back({o.samples, o.difference, o.standard_error, o.gain, o.active_share});
    const auto known = [&](double x) { return json_number_if(e.valid, x); };
    return {{"seed", seed},
            {"samples", e.samples},
            {"relrmse_percent", known(e.relrmse_percent)},
            {"lo95", known(e.lo95)},
            {"hi95", known(e.hi95)},
            {"truth", m.truth},
            {"exponent", e.exponent},
            {"trust", trust_name(e.trust)},
            {"difference", e.octaves.back().difference},
            {"standard_error", e.octaves.back().standard_error},
            {"difference_by_reference", by_reference},
            {"octaves", std::move(octaves)},
            {"top_share", e.top_share},
            {"tail_index", e.tail_index},
            {"energy_drift", e.energy_drift},
            {"samples_a_pixel", m.samples_a_pixel},
            {"rays", m.rays},
            {"cpu_seconds", m.cpu_seconds}};
}

// From every milestone to every later one.
void claim_predictions(const std::vector<Milestone>& milestones, uint64_t seed, uint64_t from,
                       Calibration& calibration) {
    for (std::size_t i = kOctavesForPrediction - 1; i < milestones.size(); ++i) {
        ErrorEstimate e = milestones[i].error;
        if (e.samples < from) continue;
        e.seconds_per_sample = 1;
        const double now = static_cast<double>(e.samples);
        const double cost = milestones[i].cpu_seconds / now;
        for (std::size_t j = i + 1; j < milestones.size(); ++j) {
            const double target = milestones[j].truth;
            if (!(target > 0) || !(target < e.relrmse_percent)) continue;
            const ErrorEstimate::Prediction p = e.seconds_to(target);
            if (!p.valid) continue;
            PredictionClaim claim;
            claim.seed = seed;
            claim.samples = e.samples;
            claim.target_percent = target;
            claim.predicted = now + p.seconds;
            claim.lo95 = now + p.lo95;
            claim.hi95 = now + p.hi95;
            claim.actual = static_cast<double>(milestones[j].error.samples);
            claim.predicted_seconds = claim.predicted * cost;
            claim.actual_seconds = milestones[j].cpu_seconds;
            claim.trust = e.trust;
            claim.firm = p.firm;
            calibration.predictions.push_back(claim);
        }
    }
}

// Where the render, at milestone n now, would have stopped by each target that is still open, and
// what its error was there. Ends the render up to twice n at the last of them.
class StopRule {
  public:
    StopRule(uint64_t from, uint64_t seed, double exposure_ev, const Reference& reference)
        : from_(from), seed_(seed), exposure_ev_(exposure_ev), reference_(reference) {}

    bool is_done() const { return open_.empty(); }

    // Targets that never led to a claim.
    std::vector<double> unclaimed() const {
        std::vector<double> targets = open_;
        targets.insert(targets.end(), too_early_.begin(), too_early_.end());
        return targets;
    }

    void follow(MeasuredRender& render, bool to_next, std::vector<StopClaim>& stops) {
        const uint64_t n = render.samples();
        const Trust trust = render.tracker().estimate().trust;
        const ErrorTracker tracker = render.tracker();
        // From the loosest target on, which is met first.
        std::erase_if(open_, [&](double target) {
            uint64_t stop = tracker.at(n, 0).meets(target) ? n : 0;
            if (stop == 0 && to_next) stop = stop_within(tracker, n, target);
            if (stop == 0) return false;
            // A target that is met before the first milestone says nothing about the rule.
            if (stop <= from_) {
                too_early_.push_back(target);
                return true;
            }
            render.render_unobserved(stop);
            stops.push_back({seed_, stop, target,
                             true_error_percent(render.film(), reference_, exposure_ev_),
                             brightness_percent(render.film(), reference_), trust});
            return true;
        });
    }

  private:
    std::vector<double> open_{std::begin(kTargets), std::end(kTargets)};
    std::vector<double> too_early_;
    const uint64_t from_, seed_;
    const double exposure_ev_;
    const Reference& reference_;
};

}  // namespace

void claim_seed(const AccuracyScene& scene, const RenderSettings& settings, const ClaimPlan& plan,
                const Reference& reference, WorkerPool& pool, Calibration& calibration,
                ordered_json& claims) {
    const double exposure = static_cast<double>(scene.exposure_ev);
    MeasuredRender render(scene, settings, pool);
    render.render_until(1);
    Film half = render.film();
    std::vector<Milestone> milestones;
    StopRule stop_rule(plan.from, settings.seed, exposure, reference);
    const uint64_t last = std::max(plan.to, plan.stop_to);
    for (uint64_t n = 2; n <= last && (n <= plan.to || !stop_rule.is_done()); n *= 2) {
        render.render_until(n);
        const Milestone m{render.tracker().estimate(),
                          true_error_percent(render.film(), reference, exposure),
                          render.cpu_seconds(), render.rays(),
                          static_cast<double>(render.film().total_samples()) /
                              static_cast<double>(render.film().pixels().size())};
        if (n <= plan.to) {
            const ErrorEstimate& e = m.error;
            if (n >= plan.from && e.valid) {
                calibration.errors.push_back({settings.seed, n, e.relrmse_percent, e.lo95, e.hi95,
                                              m.truth, e.exponent, e.trust});
            }
            claims.push_back(octave_json(
                settings.seed, m,
                relative_difference(render.film(), half, reference, metric_constant(exposure))));
            half = render.film();
            milestones.push_back(m);
        }
        stop_rule.follow(render, n < plan.stop_to, calibration.stops);
    }
    const std::vector<double> unclaimed = stop_rule.unclaimed();
    calibration.open_targets.insert(calibration.open_targets.end(), unclaimed.begin(),
                                    unclaimed.end());
    claim_predictions(milestones, settings.seed, plan.from, calibration);
}

}  // namespace talbot
