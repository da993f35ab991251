// The two tracers of a comparison behind one interface: Talbot's own in float, and the same sources
// compiled in double over an intersector of its own.
#pragma once

#include <memory>

#include "core/base/worker_pool.h"
#include "core/integrate/render_scene.h"
#include "core/scene/camera.h"
#include "core/scene/scene_desc.h"
#include "oracles/twin/path_steps.h"

namespace twin {

class Tracer {
  public:
    virtual ~Tracer() = default;

    // A pure function of its arguments; any thread.
    virtual Path trace(uint32_t x, uint32_t y, uint64_t sample_index) const = 0;
};

// Both build their scene from the same tables, of which the double one rounds nothing to float.
std::unique_ptr<const Tracer> make_float_tracer(const talbot::SceneDesc& desc,
                                                const talbot::Camera& camera,
                                                const talbot::PathSettings& settings,
                                                uint32_t width, uint32_t height,
                                                talbot::WorkerPool& pool,
                                                const talbot::LightSampling& sampling = {});
std::unique_ptr<const Tracer> make_double_tracer(const talbot::SceneDesc& desc,
                                                 const talbot::Camera& camera,
                                                 const talbot::PathSettings& settings,
                                                 uint32_t width, uint32_t height,
                                                 const talbot::LightSampling& sampling = {});

}  // namespace twin
