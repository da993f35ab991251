// The headless driver: the same session as the viewer's, without a window; writes pictures, films
// and the run record.
#pragma once

#include <chrono>

#include "app/options.h"

namespace talbot {

// Returns the exit code. `process_start` is where --time counts from.
int run_headless(const Options& options, std::chrono::steady_clock::time_point process_start);

}  // namespace talbot
