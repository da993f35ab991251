// What a run of cases is shown as: a table, JSON and a page.
#pragma once

#include <cstdio>
#include <string>
#include <vector>

#include "app/hardcases/run_cases.h"
#include "app/machine.h"
#include "core/base/float_probe.h"
#include "core/base/result.h"

namespace talbot::hardcases {

struct RunHeader {
    Machine machine;
    FloatProbe worker;  // probed on a worker thread: what kernels calculate with
    Effort effort = Effort::quick;
    RunSettings settings;
};

// Probes a worker thread.
RunHeader make_header(Effort effort, const RunSettings& settings);

struct CaseReport {
    RunHeader header;
    RunOutcome outcome;
    std::vector<NotSimulated> not_simulated;
};

std::string_view priority_name(Priority priority);

// A figure in a few characters; "-" for NaN.
std::string figure_text(double figure);
std::string margin_text(double margin);

// The table, piece by piece as it comes.
void print_header(const RunHeader& header, std::FILE* out);
void print_columns(std::size_t title_width, std::FILE* out);
void print_row(const CaseRow& row, std::size_t title_width, std::FILE* out);
void print_footer(const CaseReport& report, std::FILE* out);

// Schema talbot-hardcases/1, see docs/hardcases.md.
std::string cases_json(const CaseReport& report);

// One file without any reference to another.
Result<std::string> cases_html(const CaseReport& report);

// One self-contained glTF file a picture whose scene a file can say; makes the folder.
Status save_scenes(const std::string& folder, const CaseReport& report);

}  // namespace talbot::hardcases
