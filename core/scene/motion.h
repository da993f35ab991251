// Motion blur: a scene that moves while the shutter is open, as one still scene for each moment.
#pragma once

#include <functional>
#include <memory>
#include <stop_token>
#include <string>
#include <vector>

#include "core/base/worker_pool.h"
#include "core/scene/camera.h"
#include "core/scene/material.h"
#include "core/scene/punctual_light.h"

namespace talbot {

class Scene;

struct SceneMotion {
    // The scene at so many seconds of its animations, in tables of the same order; `previous`, of
    // another moment, may lend what both share. Null when stopped, or where there is no such
    // moment. For any thread.
    using Moment = std::function<std::shared_ptr<const Scene>(double seconds, WorkerPool& pool,
                                                              std::shared_ptr<const Scene> previous,
                                                              const std::stop_token& stop)>;

    double open = 0;      // seconds into the animations
    double shutter = 0;   // seconds that it stays open, above 0
    std::string witness;  // what moves meanwhile
    Moment moment;
    // As the file has them when the shutter opens: what differs from these was edited.
    std::vector<Material> materials;
    std::vector<PunctualLight> lights;
    std::vector<Camera> cameras;
};

// A moving scene at a moment, with the edits made to it; null as Moment gives it.
std::shared_ptr<const Scene> scene_at(const Scene& moving, double seconds, WorkerPool& pool,
                                      std::shared_ptr<const Scene> previous,
                                      const std::stop_token& stop);

// Where a camera is at that moment: one of the file's moves with the file, any other stands still.
Camera camera_at(const Camera& camera, const SceneMotion& motion, const Scene& at);

}  // namespace talbot
