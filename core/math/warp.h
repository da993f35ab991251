// Maps from the unit square to directions, discs and triangles, each next to its density. u in [0,
// 1)^2, both ends safe. An unsuffixed pdf is per solid angle; pdf_*_area is per area. Directions
// are unit length within 4 roundings.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

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

// Two floats, exchanged if asked, without a branch: the condition is as random as the sample.
inline void swap_if(bool swapped, float& a, float& b) {
    const uint32_t bits_a = std::bit_cast<uint32_t>(a);
    const uint32_t bits_b = std::bit_cast<uint32_t>(b);
    const uint32_t change = (bits_a ^ bits_b) & (0u - static_cast<uint32_t>(swapped));
    a = std::bit_cast<float>(bits_a ^ change);
    b = std::bit_cast<float>(bits_b ^ change);
}

inline float negate_if(uint32_t bit, float x) {
    return std::bit_cast<float>(std::bit_cast<uint32_t>(x) ^ (bit << 31));
}

// Sine and cosine of 2 pi u, u in [0, 1].
inline void sin_cos_turn(float u, float& sine, float& cosine) {
    const int quadrant = static_cast<int>(u * 4 + 0.5f);
    const auto q = static_cast<uint32_t>(quadrant);
    small_sin_cos((u - 0.25f * static_cast<float>(quadrant)) * (2 * kPi), sine, cosine);
    swap_if((q & 1u) != 0, sine, cosine);
    sine = negate_if((q >> 1) & 1u, sine);
    cosine = negate_if(((q + 1) >> 1) & 1u, cosine);
}

// A point of the unit disc with its 1 - r^2, which loses no digits near the rim.
struct DiskPoint {
    Vec2f p{0};
    float one_minus_r2 = 1;
};

// Uniform on the unit disc: squares go to rings (Shirley and Chiu 1997).
inline DiskPoint sample_concentric_disk_point(const Vec2f& u) {
    float r = 2 * u.x - 1;
    float across = 2 * u.y - 1;
    const bool along_y = !(std::abs(r) > std::abs(across));
    swap_if(along_y, r, across);
    float s = 0;
    float c = 0;
    small_sin_cos((kPi / 4) * (across / (r == 0 ? 1.0f : r)), s, c);
    swap_if(along_y, c, s);
    const float abs_r = std::abs(r);
    return {Vec2f(r * c, r * s), (1 - abs_r) * (1 + abs_r)};
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
