#include "core/integrate/object_ids.h"

#include "core/integrate/path.h"
#include "core/integrate/tiers.h"

namespace talbot {

std::shared_ptr<const std::vector<uint32_t>> render_object_ids(const RenderScene& scene,
                                                               const CameraRays& camera,
                                                               uint32_t width, uint32_t height,
                                                               WorkerPool& pool) {
    auto ids = std::make_shared<std::vector<uint32_t>>(std::size_t{width} * height, kNoId);
    pool.parallel_for(height, [&](uint64_t row, unsigned) {
        const auto y = static_cast<uint32_t>(row);
        for (uint32_t x = 0; x < width; ++x) {
            const Ray ray =
                camera.ray(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f, Vec2f(0.5f));
            const Sampler sampler(SamplerKind::independent, 0, x, y, 0);
            Hit hit;
            if (intersect<kFullTier>(scene, sampler, 0, ray, hit)) {
                (*ids)[std::size_t{y} * width + x] = scene.scene().object_of(hit.id);
            }
        }
    });
    return ids;
}

std::optional<PickedPoint> pick_point(const Scene& scene, const CameraRays& camera, float px,
                                      float py) {
    const Ray ray = camera.ray(px, py, Vec2f(0.5f));
    Hit hit;
    if (!scene.accel().closest(ray, hit)) return std::nullopt;
    return PickedPoint{hit.id, ray.o + hit.t * ray.d};
}

}  // namespace talbot
