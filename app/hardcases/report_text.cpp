#include <cmath>

#include "app/hardcases/report.h"
#include "core/base/worker_pool.h"

namespace talbot::hardcases {

std::string_view priority_name(Priority priority) {
    return priority == Priority::p0 ? "P0" : "P1";
}

std::string figure_text(double figure) {
    if (std::isnan(figure)) return "-";
    char text[32];
    // Counts are shown whole.
    const bool whole = std::abs(figure) < 1e6 && figure == std::floor(figure);
    std::snprintf(text, sizeof(text), whole ? "%.0f" : "%.3g", figure);
    return text;
}

std::string margin_text(double margin) {
    if (std::isinf(margin)) return "exact";
    char text[32];
    std::snprintf(text, sizeof(text), margin >= 1000 ? "%.0ex" : "%.3gx", margin);
    return text;
}

RunHeader make_header(Effort effort, const RunSettings& settings) {
    RunHeader header;
    header.machine = this_machine();
    header.effort = effort;
    header.settings = settings;
    WorkerPool pool(1);
    pool.parallel_for(1, [&](uint64_t, unsigned) { header.worker = probe_floats(); });
    return header;
}

void print_header(const RunHeader& header, std::FILE* out) {
    const FloatProbe& f = header.worker;
    const std::string threads =
        header.settings.threads == 0 ? "all" : std::to_string(header.settings.threads);
    std::fprintf(out, "Talbot %s, hard cases, %s effort, seed %llu, threads %s\n", TALBOT_VERSION,
                 header.effort == Effort::quick ? "quick" : "full",
                 static_cast<unsigned long long>(header.settings.seed), threads.c_str());
    std::fprintf(out, "%s, traversal in %s\n", header.machine.cpu.c_str(),
                 header.machine.isa.c_str());
    std::fprintf(out, "%s, %s\n", header.machine.compiler.c_str(), header.machine.flags.c_str());
    std::fprintf(out,
                 "probed on a worker: contraction %s, denormal results %s, denormal operands %s, "
                 "NaN %s, -0 %s\n\n",
                 f.contracts ? "ON" : "off", f.flushes_results ? "flushed" : "KEPT",
                 f.flushes_operands ? "zero" : "KEPT", f.nan_is_unequal ? "kept" : "LOST",
                 f.zero_has_sign ? "kept" : "LOST");
}

void print_columns(std::size_t title_width, std::FILE* out) {
    std::fprintf(out, "%-4s %-2s %-7s %9s %9s %9s %8s %6s  %-*s %s\n", "id", "", "verdict", "naive",
                 "own", "limit", "margin", "s", static_cast<int>(title_width), "title", "metric");
}

void print_row(const CaseRow& row, std::size_t title_width, std::FILE* out) {
    const Measure* m = row.shown();
    const std::string limit =
        m ? (m->gate == Gate::at_least ? ">=" : "") + figure_text(m->limit) : "-";
    std::fprintf(out, "%-4s %-2s %-7s %9s %9s %9s %8s %6.2f  %-*s %s\n", row.hard_case.id.c_str(),
                 std::string(priority_name(row.hard_case.priority)).c_str(),
                 std::string(verdict_name(row.judgement.verdict)).c_str(),
                 m ? figure_text(m->naive).c_str() : "-", m ? figure_text(m->own).c_str() : "-",
                 limit.c_str(), m ? margin_text(margin(*m)).c_str() : "-", row.seconds,
                 static_cast<int>(title_width), row.hard_case.title.c_str(),
                 m ? m->metric.c_str() : "");
    if (!row.judgement.why.empty()) std::fprintf(out, "        %s\n", row.judgement.why.c_str());
}

void print_footer(const CaseReport& report, std::FILE* out) {
    const RunOutcome& outcome = report.outcome;
    const Totals totals = total(outcome.rows);
    if (!report.not_simulated.empty()) std::fprintf(out, "\nnot simulated\n");
    for (const NotSimulated& row : report.not_simulated)
        std::fprintf(out, "%-4s %s: %s\n", row.id.c_str(), row.title.c_str(), row.why.c_str());
    std::fprintf(out, "\n%zu of %zu pass, %zu fail, %zu blind; %.1f s, of processors %.1f s%s\n",
                 totals.passed, outcome.rows.size(), totals.failed, totals.blind, outcome.seconds,
                 outcome.cpu_seconds, outcome.interrupted ? " (interrupted)" : "");
    std::fprintf(out, "not finite samples %llu, counted clamps %llu, worst margin %s\n",
                 static_cast<unsigned long long>(totals.nonfinite),
                 static_cast<unsigned long long>(totals.clamped),
                 totals.worst ? (margin_text(margin(*totals.worst->shown())) + " (" +
                                 totals.worst->hard_case.id + ")")
                                    .c_str()
                              : "-");
}

}  // namespace talbot::hardcases
