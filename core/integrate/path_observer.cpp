#include "core/integrate/path_observer.h"

#include "core/integrate/tiers.h"

namespace talbot {

PathSample observe_path(const RenderScene& scene, const CameraRays& camera,
                        const PathSettings& settings, uint32_t x, uint32_t y, uint64_t sample_index,
                        PathObserver& observer) {
    return trace_path<kFilteredTier>(scene, camera, settings, x, y, sample_index, observer);
}

}  // namespace talbot
