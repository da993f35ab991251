// What the camera sees at pixel centres, without light: object ids for the selection's outline, and
// single picks.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "core/base/worker_pool.h"
#include "core/integrate/render_scene.h"

namespace talbot {

// One object id per pixel, kNoId where nothing is hit.
std::shared_ptr<const std::vector<uint32_t>> render_object_ids(const RenderScene& scene,
                                                               const CameraRays& camera,
                                                               uint32_t width, uint32_t height,
                                                               WorkerPool& pool);

struct PickedPoint {
    PrimitiveId id{};
    Vec3f p{0};  // re-centred
};
std::optional<PickedPoint> pick_point(const Scene& scene, const CameraRays& camera, float px,
                                      float py);

}  // namespace talbot
