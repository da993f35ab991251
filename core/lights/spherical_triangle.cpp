#include "core/lights/spherical_triangle.h"

#include <algorithm>
#include <cmath>

namespace talbot {
namespace {

Vec3d unit(const Vec3d& v) {
    const double l = length(v);
    return l > 0 ? v / l : Vec3d(0);
}

// The part of v that is orthogonal to unit n, normalised.
Vec3d orthogonal_part(const Vec3d& v, const Vec3d& n) {
    return unit(v - dot(v, n) * n);
}

}  // namespace

double solid_angle(const TriangleView& view) {
    const double la = length(view.a);
    const double lb = length(view.b);
    const double lc = length(view.c);
    const double triple = std::abs(dot(view.a, cross(view.b - view.a, view.c - view.a)));
    const double denominator = la * lb * lc + dot(view.a, view.b) * lc + dot(view.a, view.c) * lb +
                               dot(view.b, view.c) * la;
    return 2 * std::atan2(triple, denominator);
}

Vec3d sample_solid_angle(const TriangleView& view, double omega, const Vec2f& u) {
    const Vec3d a = unit(view.a);
    const Vec3d b = unit(view.b);
    const Vec3d c = unit(view.c);
    // The corner c' on arc ac that leaves a sub-triangle of area u.x omega: a mirrored at a vector
    // in the plane of both, whose parts follow from the half-angle formula of the area.
    const double half = 0.5 * static_cast<double>(u.x) * omega;
    const double volume = std::abs(dot(view.a, cross(view.b - view.a, view.c - view.a))) /
                          (length(view.a) * length(view.b) * length(view.c));
    const double along_a = volume * std::cos(half) - (dot(a, c) + dot(b, c)) * std::sin(half);
    const double along_c = (1 + dot(a, b)) * std::sin(half);
    const Vec3d axis = along_a * a + along_c * c;
    const double square = dot(axis, axis);
    const Vec3d corner = square > 0 ? 2 * dot(a, axis) / square * axis - a : a;
    // Along the arc from b to c', uniformly in the cosine, counted from 1.
    const Vec3d chord = corner - b;
    const double t = static_cast<double>(u.y) * 0.5 * dot(chord, chord);
    return (1 - t) * b + std::sqrt(std::max(0.0, t * (2 - t))) * orthogonal_part(corner, b);
}

}  // namespace talbot
