#include <cmath>
#include <nlohmann/json.hpp>

#include "app/hardcases/report.h"

namespace talbot::hardcases {
namespace {

using nlohmann::ordered_json;

// JSON has no infinity: it is said as text, NaN as null.
ordered_json number(double x) {
    if (std::isnan(x)) return nullptr;
    if (std::isinf(x)) return x > 0 ? "infinity" : "-infinity";
    return x;
}

ordered_json measure_json(const Measure& m) {
    return {{"metric", m.metric},
            {"naive", number(m.naive)},
            {"own", number(m.own)},
            {"limit", number(m.limit)},
            {"gate", m.gate == Gate::at_most ? "at_most" : "at_least"},
            {"margin", number(margin(m))},
            {"pass", meets(m, m.own)},
            {"control_fails", control_fails(m)},
            {"where", m.where}};
}

ordered_json sweep_json(const Sweep& sweep) {
    ordered_json points = ordered_json::array();
    for (const SweepPoint& p : sweep.points)
        points.push_back({number(p.parameter), number(p.naive), number(p.own)});
    return {{"parameter", sweep.parameter},
            {"metric", sweep.metric},
            {"limit", number(sweep.limit)},
            {"points", std::move(points)}};
}

ordered_json row_json(const CaseRow& row) {
    ordered_json measures = ordered_json::array();
    ordered_json sweeps = ordered_json::array();
    for (const Measure& m : row.result.measures) measures.push_back(measure_json(m));
    for (const Sweep& s : row.result.sweeps) sweeps.push_back(sweep_json(s));
    return {{"id", row.hard_case.id},
            {"priority", priority_name(row.hard_case.priority)},
            {"title", row.hard_case.title},
            {"control", row.hard_case.control},
            {"remedy", row.hard_case.remedy},
            {"peers", row.hard_case.peers},
            {"verdict", verdict_name(row.judgement.verdict)},
            {"why", row.judgement.why},
            {"seconds", row.seconds},
            {"cpu_seconds", row.cpu_seconds},
            {"nonfinite", row.result.nonfinite},
            {"clamped", row.result.clamped},
            {"shown", row.judgement.worst},
            {"measures", std::move(measures)},
            {"sweeps", std::move(sweeps)}};
}

ordered_json probe_json(const FloatProbe& f) {
    return {{"contracts", f.contracts},
            {"flushes_results", f.flushes_results},
            {"flushes_operands", f.flushes_operands},
            {"nan_is_unequal", f.nan_is_unequal},
            {"zero_has_sign", f.zero_has_sign}};
}

}  // namespace

std::string cases_json(const CaseReport& report) {
    const RunHeader& header = report.header;
    const Totals totals = total(report.outcome.rows);
    ordered_json j;
    j["schema"] = "talbot-hardcases/1";
    j["version"] = TALBOT_VERSION;
    j["effort"] = header.effort == Effort::quick ? "quick" : "full";
    j["seed"] = header.settings.seed;
    j["threads"] = header.settings.threads;
    j["machine"] = {{"cpu", header.machine.cpu},
                    {"isa", header.machine.isa},
                    {"compiler", header.machine.compiler},
                    {"flags", header.machine.flags},
                    {"worker", probe_json(header.worker)}};
    j["cases"] = ordered_json::array();
    for (const CaseRow& row : report.outcome.rows) j["cases"].push_back(row_json(row));
    j["not_simulated"] = ordered_json::array();
    for (const NotSimulated& row : report.not_simulated)
        j["not_simulated"].push_back({{"id", row.id}, {"title", row.title}, {"why", row.why}});
    j["passed"] = totals.passed;
    j["failed"] = totals.failed;
    j["blind"] = totals.blind;
    j["nonfinite"] = totals.nonfinite;
    j["clamped"] = totals.clamped;
    j["worst_margin"] = nullptr;
    if (totals.worst) {
        j["worst_margin"] = {{"id", totals.worst->hard_case.id},
                             {"margin", margin(*totals.worst->shown())}};
    }
    j["seconds"] = report.outcome.seconds;
    j["cpu_seconds"] = report.outcome.cpu_seconds;
    j["interrupted"] = report.outcome.interrupted;
    j["kept"] = totals.kept && !report.outcome.interrupted;
    return j.dump(1, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace talbot::hardcases
