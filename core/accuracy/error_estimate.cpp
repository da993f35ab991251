// From the differences at powers of two to an error with its interval, its trust light and what it
// will be.
#include "core/accuracy/error_estimate.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/accuracy/octave_statistics.h"
#include "core/base/check.h"

namespace talbot {

namespace {

constexpr double kMetricConstant = 0.01;
constexpr double kNormal95 = 1.96;

// The trust light. A Gaussian image has 1.3 % of its squared differences in the largest 0.1 % of
// its pixels.
constexpr uint64_t kTrustSamples = 16;
// The true error of a small image scatters by more than its own pixels show.
constexpr std::size_t kTrustPixels = 512;
constexpr double kAmberTopShare = 0.1;
constexpr double kRedTopShare = 0.5;
constexpr double kRedTailIndex = 0.7;
constexpr double kRedEnergyDrift = 5;
// A render that stops where its error looks small stops where bright paths happen to be missing;
// the bias of its brightness is a part of the standard deviation of the same.
constexpr double kAmberBrightnessSd = 0.005;

// What a firm prediction may be off by, in nine cases of ten.
constexpr double kFirmRatio = 1.25;
constexpr double kNormal90 = 1.645;
constexpr double kNormalBelow90 = 1.282;

constexpr double kRateSd =
    0.03;  // of the logarithm of seconds per sample: other programs on the machine

double percent(double relmse) {
    return 100 * std::sqrt(std::max(relmse, 0.0));
}

// The largest share of a few pixels in the last octaves: a light that turned green as soon as one
// doubling shows no such pixel would choose the moments in which they happen to be missing.
double lasting_top_share(const ErrorEstimate& e) {
    constexpr std::size_t kOctavesToForget = 3;
    double most = e.top_share;
    for (std::size_t i = e.octaves.size() - std::min(kOctavesToForget, e.octaves.size());
         i + 1 < e.octaves.size(); ++i) {
        if (e.octaves[i].samples >= kTrustSamples) most = std::max(most, e.octaves[i].top_share);
    }
    return most;
}

void judge(ErrorEstimate& e, std::size_t pixels) {
    const bool heavy = e.tail_index > kRedTailIndex && e.top_share > kAmberTopShare;
    if (std::abs(e.energy_drift) > kRedEnergyDrift) {
        e.trust = Trust::red;
        e.why = "the image's brightness still moves more than its noise explains";
    } else if (heavy || e.top_share > kRedTopShare) {
        e.trust = Trust::red;
        e.why = "unreliable: rare bright paths make most of the error";
    } else if (lasting_top_share(e) > kAmberTopShare) {
        e.trust = Trust::amber;
        e.why = "a few bright pixels make a large part of the error";
    } else if (pixels < kTrustPixels) {
        e.trust = Trust::amber;
        e.why = "too few pixels to judge";
    } else if (e.samples < kTrustSamples) {
        e.trust = Trust::amber;
        e.why = "too few samples to judge";
    } else if (e.brightness_sd > kAmberBrightnessSd) {
        e.trust = Trust::amber;
        e.why = "too noisy: the brightness of the whole image is not yet known to 1 %";
    } else {
        e.trust = Trust::green;
        e.why = "the error is spread over the image and falls steadily";
    }
}

void set_interval(ErrorEstimate& e, double relmse, double log_sd) {
    e.relrmse_percent = percent(relmse);
    const double factor = std::exp(0.5 * kNormal95 * log_sd);
    e.lo95 = e.relrmse_percent / factor;
    e.hi95 = e.relrmse_percent * factor;
}

// Brings the older octaves to the newest r, exactly for the last of them and by the same factor for
// the others, so that all are weighed alike: the noise in r makes a difference look smaller, the
// more so the earlier it was taken.
void weigh_anew(std::vector<Octave>& octaves, const OctaveStatistics& newest) {
    if (octaves.empty() || !(octaves.back().difference > 0) || !(newest.previous_difference > 0))
        return;
    const double factor = newest.previous_difference / octaves.back().difference;
    for (Octave& o : octaves) {
        o.difference *= factor;
        o.standard_error *= factor;
    }
    octaves.back().gain = factor;
}

double ratio_or_one(double now, double before) {
    const double ratio = now / before;
    return std::isfinite(ratio) && ratio > 0 ? ratio : 1;
}

// Brings all octaves from one exposure to another, by what the last of them changes.
void weigh_by(ErrorTracker::State& state, const OctaveStatistics& before,
              const OctaveStatistics& now) {
    const double factor = ratio_or_one(now.difference, before.difference);
    const double spread = ratio_or_one(now.standard_error, before.standard_error);
    for (Octave& o : state.octaves) {
        o.difference *= factor;
        o.standard_error *= spread;
    }
    OctaveStatistics& last = state.last;
    last.difference *= factor;
    last.previous_difference *= factor;
    last.standard_error *= spread;
    last.top_share = now.top_share;
    last.tail_index = now.tail_index;
    for (std::size_t i = 0; i < last.blocks.size() && i < now.blocks.size(); ++i) {
        last.blocks[i] *= static_cast<float>(ratio_or_one(static_cast<double>(now.blocks[i]),
                                                          static_cast<double>(before.blocks[i])));
    }
}

// d ln samples / d ln seconds, from the time that a sample costs now.
double samples_growth(const ErrorEstimate& e) {
    const double all = static_cast<double>(e.samples) * e.seconds_per_sample;
    return all > 0 && e.seconds > 0 ? e.seconds / all : 1;
}

}  // namespace

std::string_view trust_name(Trust trust) {
    switch (trust) {
        case Trust::unknown:
            return "unknown";
        case Trust::green:
            return "green";
        case Trust::amber:
            return "amber";
        case Trust::red:
            return "red";
    }
    return "unknown";
}

double metric_constant(double exposure_ev) {
    // Beyond this the constant, or what is divided by it, leaves the range of float.
    constexpr double kMostEv = 40;
    return kMetricConstant * std::exp2(-2 * std::clamp(exposure_ev, -kMostEv, kMostEv));
}

bool ErrorEstimate::meets(double target_percent) const {
    if (!valid) return false;
    const double bound = std::pow(hi95 / relrmse_percent, kNormalBelow90 / kNormal95);
    return relrmse_percent * bound <= target_percent;
}

bool ErrorEstimate::ends_render(double target_percent, uint64_t passes,
                                uint64_t all_samples) const {
    constexpr uint64_t kEvenPasses = 64, kEvenSamples = uint64_t{1} << 22;
    return valid ? meets(target_percent) : passes >= kEvenPasses && all_samples >= kEvenSamples;
}

ErrorEstimate::FutureError ErrorEstimate::error_after(double further_seconds) const {
    FutureError future;
    if (!valid || trust == Trust::red || !(seconds_per_sample > 0)) return future;
    const double n =
        static_cast<double>(samples) + std::max(further_seconds, 0.0) / seconds_per_sample;
    ErrorEstimate then;
    set_interval(then, fit.smooth(n), fit.log_sd(n));
    future.valid = true;
    future.relrmse_percent = then.relrmse_percent;
    future.lo95 = then.lo95;
    future.hi95 = then.hi95;
    return future;
}

ErrorEstimate::Prediction ErrorEstimate::seconds_to(double target_percent) const {
    Prediction prediction;
    if (!valid || trust == Trust::red || !(target_percent > 0)) return prediction;
    if (relrmse_percent <= target_percent) {
        prediction.valid = true;
        prediction.firm = trust == Trust::green;
        return prediction;
    }
    if (!(seconds_per_sample > 0)) return prediction;
    const double goal = (target_percent / 100) * (target_percent / 100);
    // The law falls for ever, so the logarithm of the number of samples can be bisected.
    constexpr double kMostDoublings = 60;
    const double now = static_cast<double>(samples);
    double low = 0, high = kMostDoublings;
    if (fit.smooth(now * std::exp2(high)) > goal) return prediction;
    for (int i = 0; i < 60; ++i) {
        const double middle = 0.5 * (low + high);
        (fit.smooth(now * std::exp2(middle)) > goal ? low : high) = middle;
    }
    const double n = std::max(now * std::exp2(high), now + 1);
    const double sd = std::hypot(fit.log_sd(n) / fit.exponent_at(n), kRateSd);
    const double factor = std::exp(kNormal95 * sd);
    const auto seconds_until = [&](double sample_count) {
        return std::max(0.0, sample_count - now) * seconds_per_sample;
    };
    prediction.valid = true;
    prediction.firm = trust == Trust::green && std::exp(kNormal90 * sd) <= kFirmRatio;
    prediction.seconds = seconds_until(n);
    prediction.lo95 = seconds_until(n / factor);
    prediction.hi95 = seconds_until(n * factor);
    return prediction;
}

void ErrorTracker::reset(float exposure_ev, uint64_t first_sample, bool adaptive) {
    *this = ErrorTracker();
    state_.exposure_ev = exposure_ev;
    state_.first_sample = first_sample;
    state_.adaptive = adaptive && first_sample == 0;
    state_.plan_ev = exposure_ev;
}

void ErrorTracker::set_exposure(float exposure_ev, uint32_t width, WorkerPool* pool) {
    if (exposure_ev == state_.exposure_ev) return;
    const auto weighed = [&](float ev) {
        return weigh_memory(state_.memory, width, metric_constant(static_cast<double>(ev)), pool);
    };
    if (!state_.octaves.empty() && state_.last.difference > 0) {
        const OctaveStatistics before = weighed(state_.exposure_ev), now = weighed(exposure_ev);
        weigh_by(state_, before, now);
    }
    state_.exposure_ev = exposure_ev;
    derive();
}

void ErrorTracker::observe(const Film& film, uint64_t passes, double render_seconds,
                           WorkerPool* pool) {
    if (film.pixels().empty() || passes == 0) return;
    state_.passes = passes;
    if (state_.first_sample > 0 && std::has_single_bit(state_.first_sample + passes)) {
        state_.marks.push_back({state_.first_sample + passes, render_seconds, film});
    }
    if (!std::has_single_bit(passes)) return;
    const bool doubled =
        state_.half_samples * 2 == passes && state_.memory.image.size() == film.pixels().size();
    if (doubled) {
        state_.last = compare_octave(film, state_.memory,
                                     metric_constant(static_cast<double>(state_.exposure_ev)), pool,
                                     state_.plan);
        weigh_anew(state_.octaves, state_.last);
        state_.octaves.push_back({passes, render_seconds, state_.last.difference,
                                  state_.last.standard_error, 1, state_.last.active_share,
                                  state_.last.top_share});
        state_.seconds_per_sample = std::max(0.0, render_seconds - state_.half_seconds) /
                                    static_cast<double>(passes - passes / 2);
    } else {
        // The first of all, or a gap: nothing to compare with before the next power of two.
        state_.memory = {exact_image(film), {}};
        state_.octaves.clear();
        state_.last = OctaveStatistics();
    }
    if (state_.adaptive) {
        state_.plan = next_plan(state_.plan, passes, state_.memory, film.width(),
                                metric_constant(static_cast<double>(state_.plan_ev)), pool);
    }
    state_.half_samples = passes;
    state_.half_seconds = render_seconds;
    derive();
}

// Everything that follows from the state.
void ErrorTracker::derive() {
    estimate_ = ErrorEstimate();
    estimate_.exposure_ev = static_cast<double>(state_.exposure_ev);
    block_errors_.clear();
    if (state_.octaves.empty()) return;
    ErrorEstimate& e = estimate_;
    e.octaves = state_.octaves;
    e.fit = fit_convergence(e.octaves);
    e.valid = e.fit.v > 0;
    e.exponent = e.fit.exponent;
    e.exponent_standard_error = e.fit.exponent_sd;
    e.samples = state_.half_samples;
    e.seconds = state_.half_seconds;
    e.seconds_per_sample = state_.seconds_per_sample;
    e.seconds_exponent = e.exponent * samples_growth(e);
    e.top_share = state_.last.top_share;
    e.tail_index = state_.last.tail_index;
    e.energy_drift = state_.last.energy_drift;
    e.brightness_sd = state_.last.brightness_sd;
    if (!e.valid) {
        e.trust = Trust::amber;
        e.why = "no two samples have differed yet: all is even, or its light was not found";
        return;
    }
    set_interval(e, e.fit.v, e.fit.log_v_sd);
    judge(e, state_.memory.image.size());

    const double share = state_.last.difference > 0 ? e.fit.v / state_.last.difference : 0;
    block_errors_.reserve(state_.last.blocks.size());
    for (const float difference : state_.last.blocks) {
        block_errors_.push_back(
            static_cast<float>(percent(share * static_cast<double>(difference))));
    }
    if (block_errors_.empty()) return;
    std::vector<float> sorted = block_errors_;
    const std::size_t rank = sorted.size() - 1 - sorted.size() / 100;
    std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(rank),
                     sorted.end());
    e.worst_blocks_percent = static_cast<double>(sorted[rank]);
}

ErrorEstimate ErrorTracker::at(uint64_t passes, double render_seconds) const {
    ErrorEstimate e = estimate_;
    if (!e.valid || passes <= e.samples) return e;
    const double n = static_cast<double>(passes);
    const double before = e.relrmse_percent;
    set_interval(e, e.fit.at(passes), e.fit.log_sd(n));
    if (before > 0) e.worst_blocks_percent *= e.relrmse_percent / before;
    // The cost of a sample over the last octave and since.
    const double since_half = n - static_cast<double>(e.samples) / 2;
    const double half_seconds =
        e.seconds - e.seconds_per_sample * static_cast<double>(e.samples) / 2;
    e.seconds_per_sample = std::max(0.0, render_seconds - half_seconds) / since_half;
    e.samples = passes;
    e.seconds = render_seconds;
    e.exponent = e.fit.exponent_at(n);
    e.seconds_exponent = e.exponent * samples_growth(e);
    return e;
}

void ErrorTracker::restore(State state) {
    state_ = std::move(state);
    derive();
}

}  // namespace talbot
