#include "app/accuracy_report.h"

#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

namespace talbot {
namespace {

using nlohmann::ordered_json;

// JSON has no infinity; null stands for it.
ordered_json json_number(double x) {
    return std::isfinite(x) ? ordered_json(x) : ordered_json();
}

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

}  // namespace

const SweepResult* advised(const SweepOutcome& outcome) {
    return !outcome.results.empty() && outcome.results.front().to_target.valid
               ? &outcome.results.front()
               : nullptr;
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
        advisor["verified"] = {{"met", v.met},
                               {"seconds", v.seconds},
                               {"samples", v.error.samples},
                               {"relrmse_percent", json_number(v.error.relrmse_percent)},
                               {"lo95", json_number(v.error.lo95)},
                               {"hi95", json_number(v.error.hi95)},
                               {"trust", trust_name(v.error.trust)}};
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
