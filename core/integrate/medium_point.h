// Where light scatters inside a body, so that the body's boundary still lies ahead.
#pragma once

#include "core/integrate/surface_interaction.h"
#include "core/math/robust_geometry.h"

namespace talbot {

namespace detail {

// p, or the point of the surface that rays spawn from towards where `ray` came from, where p lies
// beyond that.
[[gnu::noinline]] inline Vec3f before_surface(const Scene& scene, const Ray& ray, const Hit& hit,
                                              const Vec3f& p) {
    constexpr EffectSet kPlace = Effect::instancing | Effect::analytic_spheres;
    const auto si = make_surface_interaction<kPlace>(scene, ray, hit);
    const Vec3f back = si.front ? si.n_geometric : -si.n_geometric;
    const Vec3f last = offset_ray_origin(si.p, si.p_error, si.n_geometric, back);
    return dot(p - last, back) < 0 ? last : p;
}

}  // namespace detail

// The point at t on a ray, which meets `hit` further on, if it is `found`. Rounding may put o + t d
// beyond that surface, where a path would have left the body without crossing its boundary.
inline Vec3f point_in_medium(const Scene& scene, const Ray& ray, float t, bool found,
                             const Hit& hit) {
    const Vec3f p = ray.o + t * ray.d;
    const float reach = max_component(glm::abs(ray.o)) + max_component(glm::abs(p));
    if (!found || hit.t - t > kNearSurface * reach) return p;
    return detail::before_surface(scene, ray, hit, p);
}

}  // namespace talbot
