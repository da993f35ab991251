#include "app/accuracy_sweep.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <functional>

#include "app/exit_code.h"
#include "core/base/log.h"
#include "core/scene/effects_off.h"
#include "core/session/bias_ledger.h"
#include "core/session/effect_ledger.h"

namespace talbot {
namespace {

constexpr uint64_t kMostSamples = uint64_t{1} << 30;

// Names with commas as words of --effects that force off.
std::string negated(const std::string& names) {
    std::string text = names.empty() ? "" : ",-";
    for (const char c : names) text += c == ',' ? std::string(",-") : std::string(1, c);
    return text;
}

// Sets an enumeration by its word in a table; empty where it is known.
template <typename Table, typename Member, typename Enum>
std::string word_of(const Table& table, Member member, const std::string& word, const char* what,
                    Enum& setting) {
    for (const auto& row : table) {
        if (row.name != word) continue;
        setting = row.*member;
        return "";
    }
    return "'" + word + "' is not " + what;
}

// Sets one key of the settings; empty where key and value are known.
std::string apply(const std::string& key, const std::string& value, SweepConfig& config) {
    RenderSettings& s = config.settings;
    const auto on_off = [&](bool& setting, const std::string& flag_off) -> std::string {
        if (value != "on" && value != "off") return "'" + value + "' is not on or off";
        setting = value == "on";
        if (!setting) config.flags = flag_off;
        return "";
    };
    const auto whole = [&](uint32_t& setting, uint32_t least) -> std::string {
        uint32_t number = 0;
        const char* end = value.data() + value.size();
        const auto [stop, code] = std::from_chars(value.data(), end, number);
        if (code != std::errc{} || stop != end || number < least || number > 65535)
            return "'" + value + "' is not a whole number from " + std::to_string(least) +
                   " to 65535";
        setting = number;
        config.flags = "--" + key + " " + value;
        return "";
    };
    if (key == "max-depth") {
        const uint32_t before = s.max_depth;
        const std::string problem = whole(s.max_depth, 0);
        config.may_be_biased = s.max_depth != before;
        return problem;
    }
    if (key == "tile-size") return whole(s.tile_size, 1);
    if (key == "roulette") return on_off(s.russian_roulette, "--no-roulette");
    if (key == "nee") return on_off(s.next_event_estimation, "--no-nee");
    if (key == "adaptive") {
        if (value != "on" && value != "off") return "'" + value + "' is not on or off";
        s.adaptive = value == "on";
        if (s.adaptive) config.flags = "--adaptive";
        return "";
    }
    config.flags = "--" + key + " " + value;
    if (constexpr std::string_view kPrefix = "effect."; key.starts_with(kPrefix)) {
        const std::optional<Effect> effect = effect_from_name(key.substr(kPrefix.size()));
        if (!effect) return "'" + key.substr(kPrefix.size()) + "' is not an effect";
        const EffectState states[] = {EffectState::automatic, EffectState::on, EffectState::off};
        const auto* state = std::find_if(std::begin(states), std::end(states), [&](EffectState e) {
            return effect_state_name(e) == value;
        });
        if (state == std::end(states)) return "'" + value + "' is not on, off or auto";
        set_effect_state(s, *effect, *state);
        config.may_be_biased = *state == EffectState::off;
        const std::string off = effect_names(s.forced_off), on = effect_names(s.forced_on);
        config.flags = "--effects auto" + (on.empty() ? "" : "," + on) + negated(off);
        return "";
    }
    if (key == "sampler")
        return word_of(kSamplers, &SamplerInfo::kind, value, "a sampler", s.sampler);
    if (key == "lights")
        return word_of(kLightSelections, &LightSelectionInfo::kind, value, "a selection of lights",
                       s.lights);
    if (key == "environment-sampling")
        return word_of(kEnvironmentSamplings, &EnvironmentSamplingInfo::kind, value,
                       "a sampling of environments", s.environment_sampling);
    if (key == "filter") {
        const FilterKind before = s.filter;
        std::string problem = word_of(kFilters, &FilterInfo::kind, value, "a filter", s.filter);
        if (problem.empty()) config.may_be_biased = s.filter != before;
        return problem;
    }
    if (key == "texture-filter") {
        const TextureFiltering before = s.texture_filter;
        std::string problem = word_of(kTextureFilterings, &TextureFilteringInfo::kind, value,
                                      "a texture filter", s.texture_filter);
        if (problem.empty()) config.may_be_biased = s.texture_filter != before;
        return problem;
    }
    if (key == "effects") {
        if (parse_effect_list(value, s.forced_on, s.forced_off))
            return "'" + value + "' is not auto, all, an effect or -effect";
        config.may_be_biased = s.forced_off != EffectSet{};
        return "";
    }
    return "the key '" + key +
           "' is not known; use max-depth, sampler, filter, texture-filter, lights, "
           "environment-sampling, roulette, nee, adaptive, effects, effect.NAME or tile-size";
}

std::vector<std::string> default_sweeps(const RenderSettings& base) {
    std::vector<std::string> sweeps;
    std::string depths;
    for (const uint32_t depth : {2u, 4u, 8u, 16u}) {
        if (depth < base.max_depth)
            depths += (depths.empty() ? "max-depth=" : ",") + std::to_string(depth);
    }
    if (!depths.empty()) sweeps.push_back(depths);
    sweeps.push_back(base.sampler == SamplerKind::sobol ? "sampler=independent" : "sampler=sobol");
    sweeps.push_back(base.russian_roulette ? "roulette=off" : "roulette=on");
    sweeps.push_back(base.next_event_estimation ? "nee=off" : "nee=on");
    sweeps.push_back("effects=all");
    return sweeps;
}

// A configuration while it is rendered.
struct Contender {
    SweepResult result;
    MeasuredRender render;
    Film half;
};

CurvePoint curve_point(const MeasuredRender& render) {
    const ErrorEstimate& e = render.tracker().estimate();
    CurvePoint p;
    p.seconds = render.seconds();
    p.cpu_seconds = render.cpu_seconds();
    p.samples = render.samples();
    p.rays = render.rays();
    p.relrmse_percent = e.relrmse_percent;
    p.lo95 = e.lo95;
    p.hi95 = e.hi95;
    p.exponent = e.exponent;
    p.trust = e.trust;
    return p;
}

TimeToTarget time_to_target(const SweepResult& r, double target) {
    TimeToTarget t;
    if (r.floor.relrmse_percent >= target) {
        t.why = "its bias alone is larger than the target";
        return t;
    }
    if (r.curve.empty()) {
        t.why =
            r.last.why.empty() ? "it got no doubling of its samples within the budget" : r.last.why;
        return t;
    }
    // Measured: between the octaves around the target, straight on log-log axes.
    for (std::size_t i = 0; i < r.curve.size(); ++i) {
        const CurvePoint& p = r.curve[i];
        if (p.relrmse_percent > target) continue;
        t.valid = t.measured = true;
        t.seconds = p.seconds;
        if (i > 0 && r.curve[i - 1].relrmse_percent > target) {
            const CurvePoint& a = r.curve[i - 1];
            const double share = std::log(a.relrmse_percent / target) /
                                 std::log(a.relrmse_percent / p.relrmse_percent);
            t.seconds = a.seconds * std::pow(p.seconds / a.seconds, share);
        }
        const double slope = 2 / std::max(1.0, p.exponent);
        t.lo95 = t.seconds * std::pow(p.lo95 / p.relrmse_percent, slope);
        t.hi95 = t.seconds * std::pow(p.hi95 / p.relrmse_percent, slope);
        return t;
    }
    const double own =
        std::sqrt(target * target - r.floor.relrmse_percent * r.floor.relrmse_percent);
    const ErrorEstimate::Prediction p = r.last.seconds_to(own);
    if (!p.valid) {
        t.why = "its error cannot be predicted: " + r.last.why;
        return t;
    }
    t.valid = true;
    t.seconds = r.last.seconds + p.seconds;
    t.lo95 = r.last.seconds + p.lo95;
    t.hi95 = r.last.seconds + p.hi95;
    return t;
}

// The best point of each configuration against all points of the others.
void mark_pareto(std::vector<SweepResult>& results) {
    for (SweepResult& r : results) {
        r.pareto = std::any_of(r.curve.begin(), r.curve.end(), [&](const CurvePoint& p) {
            return std::none_of(results.begin(), results.end(), [&](const SweepResult& other) {
                return std::any_of(
                    other.curve.begin(), other.curve.end(), [&](const CurvePoint& q) {
                        return q.seconds <= p.seconds && q.relrmse_percent <= p.relrmse_percent &&
                               (q.seconds < p.seconds || q.relrmse_percent < p.relrmse_percent);
                    });
            });
        });
    }
}

// Two significant digits, upwards.
double rounded_up(double value) {
    const double unit = std::pow(10, std::floor(std::log10(value)) - 1);
    return std::ceil(value / unit) * unit;
}

}  // namespace

Result<std::vector<SweepConfig>> sweep_configs(const RenderSettings& base,
                                               const std::vector<std::string>& sweeps) {
    std::vector<SweepConfig> configs(1);
    configs[0].key = "base";
    configs[0].settings = base;
    for (const std::string& sweep : sweeps.empty() ? default_sweeps(base) : sweeps) {
        const std::size_t equals = sweep.find('=');
        if (equals == std::string::npos || equals == 0 || equals + 1 == sweep.size())
            return usage_error("--sweep", "'" + sweep + "' is not KEY=value,value");
        const std::string key = sweep.substr(0, equals);
        std::size_t start = equals + 1;
        while (start <= sweep.size()) {
            const std::size_t comma = std::min(sweep.find(',', start), sweep.size());
            SweepConfig config;
            config.key = key;
            config.value = sweep.substr(start, comma - start);
            config.settings = base;
            if (const std::string problem = apply(key, config.value, config); !problem.empty())
                return usage_error("--sweep", sweep + ": " + problem);
            start = comma + 1;
            if (!(config.settings == base) || sweeps.empty()) configs.push_back(std::move(config));
        }
    }
    constexpr std::size_t kMost = 64;
    if (configs.size() > kMost)
        return usage_error("--sweep", "at most 64 configurations in one run");
    return configs;
}

SweepOutcome run_sweep(const AccuracyScene& scene, const SweepPlan& plan, WorkerPool& pool) {
    std::vector<Contender> all;
    for (const SweepConfig& config : plan.configs) {
        Contender c{{}, MeasuredRender(scene, config.settings, pool), {}};
        c.result.config = config;
        c.result.width = config.settings.width;
        c.result.height = config.settings.height;
        all.push_back(std::move(c));
    }
    // In lock step, one octave after the other, so that a busy machine is unfair to all alike.
    const double share = plan.budget_seconds / static_cast<double>(all.size());
    for (uint64_t n = 1; n <= kMostSamples; n *= 2) {
        bool any = false;
        for (Contender& c : all) {
            // The next octave costs what all before it did.
            if (n > 2 && 2 * c.render.seconds() > share) continue;
            any = true;
            c.half = c.render.film();
            c.render.render_until(n);
            if (n == 1) {
                c.result.first_image = c.render.film().image(false);
                continue;
            }
            const Contender& base = all.front();
            if (c.result.config.may_be_biased && base.render.samples() == n)
                c.result.floor =
                    measure_floor(c.half, c.render.film(), base.half, base.render.film(),
                                  static_cast<double>(scene.exposure_ev));
            // Where no two samples differ nothing is known.
            if (c.render.tracker().estimate().valid)
                c.result.curve.push_back(curve_point(c.render));
        }
        if (!any) break;
    }
    SweepOutcome outcome;
    for (Contender& c : all) {
        c.result.last = c.render.tracker().estimate();
        c.result.image = c.render.film().image(false);
        c.result.block_errors = c.render.tracker().block_errors();
        // What the last octave knows of the floor holds for all of the curve.
        const BiasFloor& floor = c.result.floor;
        for (CurvePoint& p : c.result.curve) {
            p.relrmse_percent = std::hypot(p.relrmse_percent, floor.relrmse_percent);
            p.lo95 = std::hypot(p.lo95, floor.lo95);
            p.hi95 = std::hypot(p.hi95, floor.hi95);
        }
        outcome.results.push_back(std::move(c.result));
    }
    const SweepResult& base = outcome.results.front();
    outcome.target_percent = plan.target_percent > 0 ? plan.target_percent
                             : base.last.valid
                                 ? rounded_up(std::max(base.last.relrmse_percent, 0.01))
                                 : 1;
    const auto cost = [](const SweepResult& r) {
        return r.last.samples == 0 ? 0 : r.last.seconds / static_cast<double>(r.last.samples);
    };
    for (SweepResult& r : outcome.results) {
        if (!r.floor.significant || !r.last.valid || !base.last.valid) continue;
        r.loss_after_seconds =
            loss_after(r.last.fit, cost(r), r.floor.relrmse_percent, base.last.fit, cost(base));
    }
    for (SweepResult& r : outcome.results) r.to_target = time_to_target(r, outcome.target_percent);
    mark_pareto(outcome.results);
    std::stable_sort(outcome.results.begin(), outcome.results.end(),
                     [](const SweepResult& a, const SweepResult& b) {
                         if (a.to_target.valid != b.to_target.valid) return a.to_target.valid;
                         return a.to_target.valid && a.to_target.seconds < b.to_target.seconds;
                     });
    return outcome;
}

Verification verify(const AccuracyScene& scene, const SweepResult& choice, double target_percent,
                    double budget_seconds, WorkerPool& pool) {
    Verification v;
    RenderSettings settings = choice.config.settings;
    ++settings.seed;
    const double floor = choice.floor.relrmse_percent;
    const double own = std::sqrt(std::max(0.0, target_percent * target_percent - floor * floor));
    MeasuredRender render(scene, settings, pool);
    for (uint64_t n = 2; n <= kMostSamples; n *= 2) {
        if (n > 2 && 2 * render.seconds() > budget_seconds) break;
        render.render_until(n);
        v.error = render.tracker().estimate();
        v.done = true;
        v.seconds = render.seconds();
        if (v.error.meets(own)) {
            v.met = true;
            break;
        }
    }
    return v;
}

}  // namespace talbot
