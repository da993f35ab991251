#include "core/session/retrace.h"

#include "core/base/worker_pool.h"

namespace talbot {

ReplayedPath Retracer::path(const std::shared_ptr<const Scene>& scene, const Camera& camera,
                            const RenderSettings& settings, uint32_t x, uint32_t y,
                            uint64_t sample) {
    const std::lock_guard lock(mutex_);
    // A path is the same to the bit only in the workers' rounding of denormals.
    enter_worker_float_mode();
    const LightSampling sampling = light_sampling(settings);
    if (!scene_ || scene_->shared_scene() != scene || !(scene_->lights().sampling() == sampling))
        scene_ =
            std::make_shared<const RenderScene>(scene, scene_.get(), EffectSet{}, sampling);
    const CameraRays rays(camera, scene->origin(), settings.width, settings.height,
                          scene->geometry().bounds);
    return replay_path(*scene_, rays, path_settings(settings), x, y, sample);
}

}  // namespace talbot
