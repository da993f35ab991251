#include "app/accuracy_report.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "app/json_figures.h"

namespace talbot {
namespace {

using nlohmann::ordered_json;

ordered_json point_json(const CurvePoint& p) {
    return {{"samples", p.samples},
            {"seconds", p.seconds},
            {"cpu_seconds", p.cpu_seconds},
            {"rays", p.rays},
            {"relrmse_percent", json_number(p.relrmse_percent)},
            {"lo95", json_number(p.lo95)},
            {"hi95", json_number(p.hi95)},
            {"exponent", p.exponent},
            {"trust", trust_name(p.trust)}};
}

ordered_json result_json(const SweepResult& r, std::size_t rank) {
    ordered_json j{{"rank", rank},
                   {"configuration", r.config.label()},
                   {"key", r.config.key},
                   {"value", r.config.value},
                   {"flags", r.config.flags},
                   {"pareto", r.pareto}};
    const TimeToTarget& t = r.to_target;
    j["to_target"] = t.valid ? ordered_json{{"seconds", t.seconds},
                                            {"lo95", t.lo95},
                                            {"hi95", t.hi95},
                                            {"measured", t.measured}}
                             : ordered_json{{"seconds", nullptr}, {"why", t.why}};
    if (r.config.may_be_biased) {
        const BiasFloor& f = r.floor;
        j["bias"] = {{"switch", r.config.label()},
                     {"floor_percent", f.relrmse_percent},
                     {"lo95", f.lo95},
                     {"hi95", f.hi95},
                     {"significant", f.significant},
                     {"z", json_number(f.z)},
                     {"block_p_value", f.block_p_value},
                     {"brightness_percent", f.brightness_percent},
                     {"loss_after_seconds",
                      r.loss_after_seconds ? json_number(*r.loss_after_seconds) : ordered_json()}};
    } else {
        j["bias"] = nullptr;
    }
    j["trust"] = trust_name(r.last.trust);
    j["why"] = r.last.why;
    j["curve"] = ordered_json::array();
    for (const CurvePoint& p : r.curve) j["curve"].push_back(point_json(p));
    return j;
}

ordered_json shares_json(const ErrorShares& shares) {
    if (!shares.valid) return nullptr;
    const auto rows = [](const std::vector<ErrorShare>& list) {
        ordered_json json = ordered_json::array();
        for (const ErrorShare& s : list) {
            json.push_back({{"name", s.name},
                            {"label", s.label},
                            {"error_share", s.error},
                            {"error_share_sd", s.error_sd},
                            {"light_share", s.light},
                            {"help", s.help},
                            {"help_factor", s.help_factor}});
        }
        return json;
    };
    return {{"kinds", rows(shares.kinds)},
            {"lights", rows(shares.lights)},
            {"help", shares.help},
            {"help_factor", shares.help_factor},
            {"size", {shares.width, shares.height}},
            {"samples", shares.samples},
            {"renders", shares.renders}};
}

// Standard deviation of the logarithm of the seconds to the target.
double log_sd(const TimeToTarget& t) {
    constexpr double kNormal95 = 1.96;
    return t.lo95 > 0 ? std::log(t.hi95 / t.lo95) / (2 * kNormal95) : HUGE_VAL;
}

// Whether it is worth leaving the base for: beyond what chance explains, by more than a trifle, and
// a bias has to pay for itself.
bool is_clearly_cheaper(const SweepResult& r, const SweepResult& base) {
    constexpr double kNormal90 = 1.645, kLeastGain = 1.05, kLeastGainOfBias = 1.25;
    if (r.last.trust == Trust::red) return false;
    if (!base.to_target.valid) return true;
    const double gain = base.to_target.seconds / r.to_target.seconds;
    const double doubt = kNormal90 * std::hypot(log_sd(r.to_target), log_sd(base.to_target));
    return gain > (r.config.may_be_biased ? kLeastGainOfBias : kLeastGain) &&
           std::log(gain) > doubt;
}

}  // namespace

const SweepResult* advised(const SweepOutcome& outcome) {
    const std::vector<SweepResult>& results = outcome.results;
    const auto base = std::find_if(results.begin(), results.end(),
                                   [](const SweepResult& r) { return r.config.key == "base"; });
    for (const SweepResult& r : results) {
        if (!r.to_target.valid) break;
        if (base == results.end() || &r == &*base || is_clearly_cheaper(r, *base)) return &r;
    }
    return nullptr;
}

std::string report_json(const AccuracyReport& report) {
    ordered_json j{{"schema", "talbot-accuracy/1"},
                   {"version", TALBOT_VERSION},
                   {"scene", {{"file", report.scene_file}, {"sha256", report.scene_sha256}}},
                   {"target_percent", report.outcome.target_percent},
                   {"budget_seconds", report.budget_seconds},
                   {"threads", report.threads}};
    if (!report.outcome.results.empty()) {
        const SweepResult& first = report.outcome.results.front();
        j["size"] = {first.width, first.height};
    }
    j["results"] = ordered_json::array();
    for (std::size_t i = 0; i < report.outcome.results.size(); ++i)
        j["results"].push_back(result_json(report.outcome.results[i], i + 1));
    j["why"] = shares_json(report.shares);
    ordered_json advisor{{"text", report.advice}, {"command", report.advice_command}};
    if (report.verification.done) {
        const Verification& v = report.verification;
        advisor["verified"] = {
            {"met", v.met}, {"seconds", v.seconds}, {"samples", v.error.samples}};
        advisor["verified"].update(error_json(v.error));
    } else {
        advisor["verified"] = nullptr;
    }
    j["advisor"] = std::move(advisor);
    return j.dump(2, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

std::string report_csv(const AccuracyReport& report) {
    std::string text =
        "configuration,samples,seconds,cpu_seconds,rays,relrmse_percent,lo95,hi95,exponent,trust,"
        "floor_percent\n";
    for (const SweepResult& r : report.outcome.results) {
        for (const CurvePoint& p : r.curve) {
            char line[320];
            std::snprintf(line, sizeof(line), ",%llu,%.6g,%.6g,%llu,%.6g,%.6g,%.6g,%.4g,",
                          static_cast<unsigned long long>(p.samples), p.seconds, p.cpu_seconds,
                          static_cast<unsigned long long>(p.rays), p.relrmse_percent, p.lo95,
                          p.hi95, p.exponent);
            text += r.config.label() + line + std::string(trust_name(p.trust));
            std::snprintf(line, sizeof(line), ",%.6g\n", r.floor.relrmse_percent);
            text += line;
        }
    }
    return text;
}

}  // namespace talbot
