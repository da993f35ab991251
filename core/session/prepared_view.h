// What the kernels are given for a scene, a camera and settings: effects that are forced off taken
// away, the rest folded, and the smallest kernel tier that covers it.
#pragma once

#include <memory>

#include "core/integrate/render_scene.h"
#include "core/session/settings.h"

namespace talbot {

struct PreparedView {
    std::shared_ptr<const Scene> given;        // as it came, with every effect
    std::shared_ptr<const Scene> reduced;      // without the effects that are forced off
    std::shared_ptr<const RenderScene> scene;  // of `reduced`
    EffectSet forced_on, forced_off;
    LightSampling sampling;
    TextureFiltering texture_filter = TextureFiltering::none;
    std::shared_ptr<const TexturePyramids> pyramids;  // of `reduced`; null where not filtered
    Camera camera;                                    // as rendered
    EffectReport effects;                             // of the scene and camera as they came
    std::size_t tier = 0;
};

// Reuses what `previous`, which may be null, shares with the new view.
PreparedView prepare_view(std::shared_ptr<const Scene> scene, const Camera& camera,
                          const RenderSettings& settings, WorkerPool& pool,
                          const PreparedView* previous = nullptr);

}  // namespace talbot
