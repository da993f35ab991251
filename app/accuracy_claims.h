// One render of `talbot accuracy certify`: what it says of its error, its future and its end, each
// beside the truth.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "app/accuracy_render.h"

namespace talbot {

struct ClaimPlan {
    uint64_t from = 8;  // milestones, powers of two
    uint64_t to = 256;
    uint64_t stop_to = 256;  // how far this render goes on for the stop rule, a power of two
};

// The claims go to `calibration`; one object for every octave to the array `claims`.
void claim_seed(const AccuracyScene& scene, const RenderSettings& settings, const ClaimPlan& plan,
                const Reference& reference, WorkerPool& pool, Calibration& calibration,
                nlohmann::ordered_json& claims);

}  // namespace talbot
