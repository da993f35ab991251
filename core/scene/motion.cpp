#include "core/scene/motion.h"

#include "core/scene/scene.h"

namespace talbot {
std::shared_ptr<const Scene> scene_at(const Scene& moving, double seconds, WorkerPool& pool,
                                      std::shared_ptr<const Scene> previous,
                                      const std::stop_token& stop) {
    const SceneMotion& motion = *moving.motion();
    std::shared_ptr<const Scene> at = motion.moment(seconds, pool, std::move(previous), stop);
    if (!at) return nullptr;
    if (at->materials().size() == motion.materials.size() &&
        moving.materials() != motion.materials) {
        std::vector<Material> materials = at->materials();
        for (std::size_t i = 0; i < materials.size(); ++i) {
            if (!(moving.materials()[i] == motion.materials[i]))
                materials[i] = moving.materials()[i];
        }
        at = at->with_materials(std::move(materials));
    }
    if (at->punctual_lights().size() == motion.lights.size()) {
        for (uint32_t i = 0; i < motion.lights.size(); ++i) {
            const PunctualLight& light = moving.punctual_lights()[i];
            if (!(light == motion.lights[i])) at = at->with_punctual_light(i, light);
        }
    }
    if (!(at->environment() == moving.environment()))
        at = at->with_environment(moving.environment());
    return at;
}

Camera camera_at(const Camera& camera, const SceneMotion& motion, const Scene& at) {
    if (at.cameras().size() != motion.cameras.size()) return camera;
    for (std::size_t i = 0; i < motion.cameras.size(); ++i) {
        // Lens and image size may be the user's.
        if (view_of(camera) != view_of(motion.cameras[i])) continue;
        Camera moved = camera;
        view_of(moved) = view_of(at.cameras()[i]);
        return moved;
    }
    return camera;
}

}  // namespace talbot
