// Rays of a path: where it begins, and what they find in the scene.
#pragma once

#include "core/integrate/coverage.h"
#include "core/integrate/pixel_filter.h"
#include "core/integrate/render_scene.h"
#include "core/integrate/sampler.h"
#include "core/integrate/tiers.h"
#include "core/scene/camera.h"

namespace talbot {

// Where a path begins.
struct CameraSample {
    Sampler sampler;
    Ray ray;
};

template <EffectSet kTier>
CameraSample sample_camera(const CameraRays& camera, const PathSettings& settings, uint32_t x,
                           uint32_t y, uint64_t sample_index) {
    const Sampler sampler(settings.sampler, settings.seed, x, y, sample_index);
    const Vec2f offset = sample_pixel_filter(settings.filter, sampler.pair(Purpose::pixel));
    Vec2f lens(0);
    if (kTier.has(Effect::depth_of_field) && camera.has_lens()) lens = sampler.pair(Purpose::lens);
    return {sampler,
            camera.ray(static_cast<float>(x) + offset.x, static_cast<float>(y) + offset.y, lens)};
}

template <EffectSet kTier>
inline constexpr bool kHasAlpha = kTier.has(Effect::alpha_mask) || kTier.has(Effect::alpha_blend);

// Whether the nearest hit is one; else the nearest that is. Out of line, so that hits without a
// question keep their registers.
template <EffectSet kTier>
[[gnu::noinline]] bool ask_coverage(const RenderScene& rs, const Sampler& sampler, uint32_t bounce,
                                    const Ray& ray, Hit& hit) {
    const CoverageContext context{&rs, sampler.coverage_seed(bounce, 0), bounce == 0};
    if (accept_coverage<kTier>(&context, ray, hit)) return true;
    hit = Hit{};
    return rs.scene().accel().closest(ray, hit, HitFilter{&accept_coverage<kTier>, &context});
}

// Closest hit as this kind of ray sees the scene. Most hits need no question: the filter is asked
// of the nearest one, and traversal runs again with it only where that one is no hit. `entry` may
// be null.
template <EffectSet kTier>
bool intersect(const RenderScene& rs, const Sampler& sampler, uint32_t bounce, const Ray& ray,
               Hit& hit, const BeamEntry* entry = nullptr) {
    constexpr uint8_t kAlpha = kHasAlpha<kTier> ? kCoverageAlpha : 0;
    constexpr uint8_t kSide = kTier.has(Effect::single_sided) ? kCoverageSingleSided : 0;
    const Accel& accel = rs.scene().accel();
    if (!(entry ? accel.closest(ray, hit, *entry) : accel.closest(ray, hit))) return false;
    if constexpr ((kAlpha | kSide) != 0) {
        if (kAlpha != 0 || bounce == 0) {
            const uint8_t relevant = rs.any_coverage() & (bounce == 0 ? kAlpha | kSide : kAlpha);
            if (relevant != 0 && (rs.coverage_flags(hit.id) & relevant) != 0)
                return ask_coverage<kTier>(rs, sampler, bounce, ray, hit);
        }
    }
    return true;
}

template <EffectSet kTier>
bool is_occluded(const RenderScene& rs, const Sampler& sampler, uint32_t bounce, const Ray& ray) {
    if (!kHasAlpha<kTier> || (rs.any_coverage() & kCoverageAlpha) == 0)
        return rs.scene().accel().occluded(ray);
    const CoverageContext context{&rs, sampler.coverage_seed(bounce, 1), false};
    return rs.scene().accel().occluded(ray, HitFilter{&accept_coverage<kTier>, &context});
}

}  // namespace talbot
