// What `talbot accuracy` writes: JSON (schema talbot-accuracy/1, docs/accuracy.md), CSV, a plot as
// PNG and a report in one HTML file that needs no network.
#pragma once

#include <string>

#include "app/accuracy_sweep.h"
#include "core/film/tone_map.h"
#include "core/session/error_shares.h"

namespace talbot {

struct AccuracyReport {
    std::string scene_file;
    std::string scene_sha256;
    double budget_seconds = 0;
    unsigned threads = 0;
    DisplaySettings display;
    SweepOutcome outcome;
    Verification verification;
    ErrorShares shares;          // of the base; not valid unless asked for
    std::string advice;          // one sentence
    std::string advice_command;  // to copy; empty where there is nothing to advise
};

// The cheapest configuration that meets the target; the base where none is cheaper beyond doubt,
// and by a quarter where it is biased. Null where none is known to meet it.
const SweepResult* advised(const SweepOutcome& outcome);

std::string report_json(const AccuracyReport& report);
std::string report_csv(const AccuracyReport& report);
Result<std::string> report_html(const AccuracyReport& report);

// Error against seconds on logarithmic axes, a band for each configuration's interval.
ImageBytes report_plot(const AccuracyReport& report);

// Colour of the i-th curve in plot and report, 0xRRGGBB.
uint32_t curve_color(std::size_t i);

}  // namespace talbot
