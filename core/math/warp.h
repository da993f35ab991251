// Maps from the unit square to directions, discs and triangles, each next to its density. u in [0,
// 1)^2, both ends safe. An unsuffixed pdf is per solid angle; pdf_*_area is per area. Directions
// are unit length within 4 roundings.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/math/robust.h"
#include "core/math/vec.h"

namespace talbot {

// Sine and cosine of x in [-pi/4, pi/4] by their Taylor series: absolute error below 1e-7, the same
// bits everywhere.
inline void small_sin_cos(float x, float& sine, float& cosine) {
    const float x2 = x * x;
    sine =
        x + x * x2 * (-1.0f / 6 + x2 * (1.0f / 120 + x2 * (-1.0f / 5040 + x2 * (1.0f / 362880))));
    cosine = 1 + x2 * (-0.5f + x2 * (1.0f / 24 + x2 * (-1.0f / 720 + x2 * (1.0f / 40320))));
}

// Sine and cosine of 2 pi u, u in [0, 1].
inline void sin_cos_turn(float u, float& sine, float& cosine) {
    const int quadrant = static_cast<int>(u * 4 + 0.5f);
    float s = 0;
    float c = 0;
    small_sin_cos((u - 0.25f * static_cast<float>(quadrant)) * (2 * kPi), s, c);
    const bool swapped = (quadrant & 1) != 0;
    const float s1 = swapped ? c : s;
    const float c1 = swapped ? s : c;
    sine = (quadrant & 2) != 0 ? -s1 : s1;
    cosine = ((quadrant + 1) & 2) != 0 ? -c1 : c1;
}

// A point of the unit disc with its 1 - r^2, which loses no digits near the rim.
struct DiskPoint {
    Vec2f p{0};
    float one_minus_r2 = 1;
};

// Uniform on the unit disc: squares go to rings (Shirley and Chiu 1997).
inline DiskPoint sample_concentric_disk_point(const Vec2f& u) {
    const float a = 2 * u.x - 1;
    const float b = 2 * u.y - 1;
    const bool along_x = std::abs(a) > std::abs(b);
    const float r = along_x ? a : b;
    if (r == 0) return {};
    float s = 0;
    float c = 0;
    small_sin_cos((kPi / 4) * ((along_x ? b : a) / r), s, c);
    const float abs_r = std::abs(r);
    return {along_x ? Vec2f(r * c, r * s) : Vec2f(r * s, r * c), (1 - abs_r) * (1 + abs_r)};
}

inline Vec2f sample_concentric_disk(const Vec2f& u) {
    return sample_concentric_disk_point(u).p;
}
inline float pdf_concentric_disk_area() {
    return kInvPi;
}

// Least squared cosine of a cosine-weighted sample: moves its length by less than a rounding.
inline constexpr float kMinCosineSquare = 0x1p-26f;

// Cosine-weighted about +z. z is never zero, so that value / pdf is always defined.
inline Vec3f sample_cosine_hemisphere(const Vec2f& u) {
    const DiskPoint d = sample_concentric_disk_point(u);
    return Vec3f(d.p.x, d.p.y, std::sqrt(std::max(d.one_minus_r2, kMinCosineSquare)));
}
inline float pdf_cosine_hemisphere(float cos_theta) {
    return cos_theta > 0 ? cos_theta * kInvPi : 0.0f;
}

// Uniform about +z.
inline Vec3f sample_uniform_hemisphere(const Vec2f& u) {
    const float z = 1 - u.x;
    const float r = std::sqrt(u.x * (2 - u.x));
    float s = 0;
    float c = 0;
    sin_cos_turn(u.y, s, c);
    return Vec3f(r * c, r * s, z);
}
inline float pdf_uniform_hemisphere() {
    return 0.5f * kInvPi;
}

// Uniform over all directions.
inline Vec3f sample_uniform_sphere(const Vec2f& u) {
    const float z = 1 - 2 * u.x;
    const float r = 2 * std::sqrt(u.x * (1 - u.x));
    float s = 0;
    float c = 0;
    sin_cos_turn(u.y, s, c);
    return Vec3f(r * c, r * s, z);
}
inline float pdf_uniform_sphere() {
    return 0.25f * kInvPi;
}

// Uniform in the cone of directions about +z with the given 1 - cos of its half-angle, in (0, 2].
inline Vec3f sample_uniform_cone(const Vec2f& u, float one_minus_cos_max) {
    const float t = u.x * one_minus_cos_max;
    const float r = std::sqrt(t * (2 - t));
    float s = 0;
    float c = 0;
    sin_cos_turn(u.y, s, c);
    return Vec3f(r * c, r * s, 1 - t);
}
inline float pdf_uniform_cone(float one_minus_cos_max) {
    return 0.5f * kInvPi / one_minus_cos_max;
}

// Barycentric weights (of the three vertices, sum 1) of a uniform point in a triangle, without a
// fold or a root (Heitz 2019, "A low-distortion map between triangle and square").
inline Vec3f sample_uniform_triangle(const Vec2f& u) {
    float b0 = 0;
    float b1 = 0;
    if (u.x < u.y) {
        b0 = 0.5f * u.x;
        b1 = u.y - b0;
    } else {
        b1 = 0.5f * u.y;
        b0 = u.x - b1;
    }
    return Vec3f(b0, b1, 1 - b0 - b1);
}
inline float pdf_uniform_triangle_area(float area) {
    return 1 / area;
}

}  // namespace talbot
