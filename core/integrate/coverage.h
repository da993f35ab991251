// Coverage during traversal: alpha mask and blend as the chance that a surface is there, and back
// faces of single-sided surfaces, which the camera does not see (all other rays do, so that no
// light leaks through a wall from behind).
#pragma once

#include "core/integrate/material_eval.h"
#include "core/integrate/render_scene.h"
#include "core/math/sample_bits.h"

namespace talbot {

// The context of a HitFilter. Blend decisions hash the primitive with the seed: each surface
// decides by itself, in any order.
struct CoverageContext {
    const RenderScene* scene = nullptr;
    uint32_t seed = 0;
    bool camera_ray = false;
};

template <EffectSet kTier>
bool accept_coverage(const void* context, const Ray& ray, const Hit& hit) {
    const auto& coverage = *static_cast<const CoverageContext*>(context);
    const uint8_t flags = coverage.scene->coverage_flags(hit.id);
    if (flags == 0) return true;
    const Scene& scene = coverage.scene->scene();
    const bool ask_side = kTier.has(Effect::single_sided) && coverage.camera_ray &&
                          (flags & kCoverageSingleSided) != 0;
    TriangleCoverage texels = TriangleCoverage::opaque;
    if constexpr (kTier.has(Effect::alpha_mask) || kTier.has(Effect::alpha_blend)) {
        if ((flags & kCoverageAlpha) != 0) {
            texels = coverage.scene->triangle_coverage(hit.id);
            if (texels == TriangleCoverage::clear) return false;
        }
    }
    if (!ask_side && texels == TriangleCoverage::opaque) return true;
    const SurfaceInteraction si = make_surface_interaction<kTier>(scene, ray, hit);
    if (ask_side && !si.front) return false;
    if constexpr (kTier.has(Effect::alpha_mask) || kTier.has(Effect::alpha_blend)) {
        if (texels == TriangleCoverage::mixed) {
            const Material& material = scene.materials()[si.material];
            const float alpha = eval_base_color<kTier>(scene, material, si).w;
            if (kTier.has(Effect::alpha_mask) && material.alpha_mode == AlphaMode::mask)
                return alpha >= material.alpha_cutoff;
            const uint32_t hash =
                hash_combine(hash_combine(coverage.seed, hit.id.instance), hit.id.primitive);
            return unit_float(hash) < alpha;
        }
    }
    return true;
}

}  // namespace talbot
