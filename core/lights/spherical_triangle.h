// Triangles and parallelograms seen from a point: solid angle and uniform sampling of it (Arvo
// 1995, with the corner of Peters 2021, "BRDF importance sampling for polygonal lights"). Computed
// in double from edge vectors, so that small and distant ones keep their digits.
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
Vec3d sample_solid_angle(const TriangleView& view, double omega, const Vec2d& u);

// A parallelogram: a corner relative to the point that sees it, and the edges there.
struct ParallelogramView {
    Vec3d a{0}, e1{0}, e2{0};
};

double solid_angle(const ParallelogramView& view);

// Uniform over the solid angle of both halves, swept in one go: small steps of u are small steps of
// the direction.
struct ParallelogramSample {
    Vec3d direction{0};
    double omega = 0;     // of the whole; where it is 0 there is no direction
    bool second = false;  // in the half across from a
};
ParallelogramSample sample_solid_angle(const ParallelogramView& view, const Vec2f& u);

}  // namespace talbot
