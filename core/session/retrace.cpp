#include "core/session/retrace.h"

#include "core/base/worker_pool.h"

namespace talbot {

ReplayedPath Retracer::path(const std::shared_ptr<const Scene>& scene, const Camera& camera,
                            const RenderSettings& settings, uint32_t x, uint32_t y,
                            uint64_t sample) {
    const std::lock_guard lock(mutex_);
    // A path is the same to the bit only in the workers' rounding of denormals.
    enter_worker_float_mode();
    WorkerPool pool(1);
    view_ = ViewMoments(prepare_view(scene, camera, settings, pool, &view_.view()));
    const PreparedView& at = *view_.at(sample, settings, pool);
    const CameraRays rays(at.camera, at.given->origin(), settings.width, settings.height,
                          at.given->geometry().bounds);
    return replay_path(*at.scene, rays, path_settings(settings), x, y, sample);
}

}  // namespace talbot
