// The bias ledger of a render: each switch that changes the converged picture, the floor that it
// puts under the error, and the time after which it costs more than it saves.
#pragma once

#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "core/accuracy/bias_floor.h"
#include "core/accuracy/convergence_fit.h"
#include "core/base/worker_pool.h"
#include "core/scene/scene.h"
#include "core/session/settings.h"

namespace talbot {

// A biased switch that is on, and the settings without it.
struct BiasedSwitch {
    std::string name;  // the option with its value
    RenderSettings unbiased;
};
std::vector<BiasedSwitch> biased_switches(const RenderSettings& settings);

struct BiasEntry {
    std::string name;
    BiasFloor floor;
    // Seconds of rendering after which the picture without the switch is the better one, on this
    // machine with the pool's threads; 0 where the switch never pays; empty where no bias was seen.
    std::optional<double> loss_after_seconds;
};

// Of two configurations whose error falls by these laws, a floor under the first: seconds after
// which the second is the better one, 0 where it always is. Costs are seconds a sample.
double loss_after(const ConvergenceFit& biased, double biased_cost, double floor_percent,
                  const ConvergenceFit& unbiased, double unbiased_cost);

// The switches that are on, each measured on a small image of the same view; empty where none is
// on, or when stopped. Costs some tenths of a second for each.
std::vector<BiasEntry> measure_bias(const std::shared_ptr<const Scene>& scene, const Camera& camera,
                                    const RenderSettings& settings, double exposure_ev,
                                    WorkerPool& pool, const std::stop_token& stop = {});

}  // namespace talbot
