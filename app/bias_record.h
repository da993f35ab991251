// The bias ledger of a run: each switch that changes the converged picture, with the floor that it
// puts under the error.
#pragma once

#include <string>
#include <vector>

#include "app/scene_setup.h"
#include "core/accuracy/bias_floor.h"

namespace talbot {

struct BiasEntry {
    std::string name;  // the option with its value
    BiasFloor floor;
};

// The biased switches that are on, each measured on a small image of the same view against the
// default; empty where none is on. Costs some tenths of a second for each.
std::vector<BiasEntry> measure_bias(const SceneSetup& setup, WorkerPool& pool);

}  // namespace talbot
