#include "core/integrate/object_ids.h"
#include "core/session/session.h"

namespace talbot {

std::optional<Pick> pick(const Scene& scene, const Camera& camera, uint32_t width, uint32_t height,
                         float px, float py) {
    const std::optional<PickedPoint> found = pick_point(
        scene, CameraRays(camera, scene.origin(), width, height, scene.geometry().bounds), px, py);
    if (!found) return std::nullopt;
    return Pick{scene.object_of(found->id), scene.material_of(found->id),
                Vec3d(found->p) + scene.origin()};
}

}  // namespace talbot
