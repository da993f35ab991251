// `--pixel X,Y --sample N`: retraces exactly one path on one thread and prints a log of its steps
// on stdout.
#pragma once

#include "app/options.h"

namespace talbot {

int run_replay(const Options& options);

}  // namespace talbot
