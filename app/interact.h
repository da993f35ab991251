// Replays an interaction script through the viewer's own frame loop and panels, offscreen, and
// reports latencies.
#pragma once

#include "app/viewer.h"

namespace talbot {

struct InteractionOptions {
    ViewerOptions viewer;  // the scene must be loaded
    std::filesystem::path script;
    std::filesystem::path report;  // JSON; empty writes to stdout
};

// Fails when the script cannot be read, a step cannot be carried out or an expectation is not met;
// the report is written in the last two cases too.
Status run_interaction(const InteractionOptions& options);

}  // namespace talbot
