// The bias ledger of a run, measured from its set-up.
#pragma once

#include <string>
#include <vector>

#include "app/scene_setup.h"
#include "core/session/bias_ledger.h"

namespace talbot {

// Of the switches that are on; empty where none is.
std::vector<BiasEntry> measure_bias(const SceneSetup& setup, double exposure_ev, WorkerPool& pool);

// One sentence on a significant floor: "puts a floor of 3.1 % under the error; a loss after 12 s".
std::string bias_sentence(const BiasFloor& floor, std::optional<double> loss_after_seconds);

}  // namespace talbot
