// Triangles seen as spherical triangles from a point: solid angle and uniform sampling of it (Arvo
// 1995, with the corner of Peters 2021, "BRDF importance sampling for polygonal lights"). Computed
// in double from edge vectors, so that small and distant triangles keep their digits.
#pragma once

#include "core/math/vec.h"

namespace talbot {

// A triangle's corners relative to the point that sees it.
struct TriangleView {
    Vec3d a{0}, b{0}, c{0};
};

// Whether a side spans more than a right angle: such triangles are cut into sectors before they are
// sampled, by another map than Arvo's.
bool is_wide(const TriangleView& view);

// Steradians, in [0, 2 pi]; 0 when the point lies in the triangle's plane (Van Oosterom and
// Strackee 1983).
double solid_angle(const TriangleView& view);

// A unit direction distributed uniformly over the triangle's solid angle, for u in [0, 1)^2.
Vec3d sample_solid_angle(const TriangleView& view, double omega, const Vec2f& u);

}  // namespace talbot
