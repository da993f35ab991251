// A path that somebody watches: one sample in the tier that covers everything, with a call at every
// ray and vertex. The radiance is that of the render's own kernel to the bit.
#pragma once

#include "core/integrate/path.h"

namespace talbot {

class PathObserver {
  public:
    static constexpr bool kActive = true;
    static constexpr bool kTampers = false;
    virtual ~PathObserver() = default;

    // Before anything of this ray's end is added to the path.
    virtual void ray(uint32_t bounce, const Ray& ray, bool found, const Hit& hit,
                     const PathState& path) = 0;

    // After what the ray's end itself sends was added: emission of a surface or the environment.
    virtual void seen(uint32_t /*bounce*/, const PathState& /*path*/) {}

    // Where the path turned inside a medium, on its way to what `ray` announced.
    virtual void in_medium(uint32_t /*bounce*/, const Vec3f& /*p*/, const PathState& /*path*/) {}

    // After emission and light sampling at the hit, before the path goes on; not called where the
    // path ends at the depth limit or on an unlit surface.
    virtual void vertex(uint32_t bounce, const SurfaceInteraction& si, const Material& material,
                        const ShadingParams& params, const std::optional<BsdfSample>& scattered,
                        const PathState& path) = 0;
};

PathSample observe_path(const RenderScene& scene, const CameraRays& camera,
                        const PathSettings& settings, uint32_t x, uint32_t y, uint64_t sample_index,
                        PathObserver& observer);

}  // namespace talbot
