// One sample with the decisions that its path took. Compiled twice: as it stands, and rewritten in
// double.
#pragma once

#include "core/integrate/path_observer.h"
#include "oracles/twin/path_steps.h"

namespace talbot {

twin::Path record_path(const RenderScene& scene, const CameraRays& camera,
                       const PathSettings& settings, uint32_t x, uint32_t y, uint64_t sample_index);

}  // namespace talbot
