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
    // Angle at a, and the arc from a to b.
    const Vec3d toward_b = orthogonal_part(b, a);
    const Vec3d toward_c = orthogonal_part(c, a);
    const double cos_alpha = std::clamp(dot(toward_b, toward_c), -1.0, 1.0);
    const double sin_alpha = std::sqrt(std::max(0.0, 1 - cos_alpha * cos_alpha));
    const double cos_ab = std::clamp(dot(a, b), -1.0, 1.0);
    // The corner c' on arc ac that leaves a sub-triangle of area u.x omega.
    const double area = static_cast<double>(u.x) * omega;
    const double sin_rest = std::sin(area) * cos_alpha - std::cos(area) * sin_alpha;
    const double cos_rest = std::cos(area) * cos_alpha + std::sin(area) * sin_alpha;
    const double k1 = cos_rest - cos_alpha;
    const double k2 = sin_rest + sin_alpha * cos_ab;
    const double numerator = (k2 * cos_rest - k1 * sin_rest) * cos_alpha - k2;
    const double denominator = (k2 * sin_rest + k1 * cos_rest) * sin_alpha;
    const double cos_arc = denominator != 0 ? std::clamp(numerator / denominator, -1.0, 1.0) : 1.0;
    const Vec3d corner = cos_arc * a + std::sqrt(std::max(0.0, 1 - cos_arc * cos_arc)) * toward_c;
    // Along the arc from b to c', uniformly in the cosine.
    const double cos_bc = std::clamp(dot(corner, b), -1.0, 1.0);
    const double z = 1 - static_cast<double>(u.y) * (1 - cos_bc);
    return z * b + std::sqrt(std::max(0.0, 1 - z * z)) * orthogonal_part(corner, b);
}

}  // namespace talbot
