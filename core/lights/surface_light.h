// Sampling of single lights from a point: each sample_ stands beside its pdf_, both per solid angle
// at the point.
#pragma once

#include <optional>

#include "core/lights/light_table.h"

namespace talbot {

Light make_triangle_light(const Scene& scene, PrimitiveId id);
// A triangle and the next one of its mesh as one light, where they are the halves of a
// parallelogram; else empty.
std::optional<Light> make_quad_light(const Scene& scene, PrimitiveId first);
Light make_sphere_light(const Scene& scene, uint32_t sphere);

// By solid angle where the triangle looks large (Arvo 1995), else by area. Empty from behind, from
// within its plane and for degenerate triangles.
std::optional<LightSample> sample_triangle_light(const Scene& scene, const Light& light,
                                                 const Vec3f& p, const Vec2f& u);
// The same over both halves of a quad.
std::optional<LightSample> sample_quad_light(const Scene& scene, const Light& light, const Vec3f& p,
                                             const Vec2f& u);
// Of triangles and quads.
float pdf_flat_light(const Light& light, const Vec3f& p, const Vec3f& hit_point);

// Uniform over the cone that the sphere fills; from inside, nothing is sampled (the back of a
// sphere does not emit unless it is double-sided, and then BSDF sampling finds it).
std::optional<LightSample> sample_sphere_light(const Scene& scene, const Light& light,
                                               const Vec3f& p, const Vec2f& u);
float pdf_sphere_light(const Light& light, const Vec3f& p);

// Delta lights; range windowed as KHR_lights_punctual recommends.
std::optional<LightSample> sample_punctual_light(const PunctualLight& source, const Light& light,
                                                 const Vec3f& p);

}  // namespace talbot
