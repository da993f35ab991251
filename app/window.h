// The command line's way to the viewer: a window, or an interaction script replayed offscreen.
#pragma once

#include "app/options.h"

namespace talbot {

// Each returns the exit code.
int run_window(const Options& options);
int run_script(const Options& options);

}  // namespace talbot
