// Every tolerance, error bound and guarded operation of the core that is not part of ray-triangle
// traversal lives here.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>

#include "core/math/vec.h"

namespace talbot {

// Unit roundoff of float.
inline constexpr float kFloatEpsilon = 0x1p-24f;

// Bound on the relative error of n rounded float operations: n eps / (1 - n eps) (Higham 2002,
// section 3.1).
constexpr float gamma_bound(int n) {
    const float ne = static_cast<float>(n) * kFloatEpsilon;
    return ne / (1 - ne);
}

// Largest float below 1: what a sample in [0, 1) may reach.
inline constexpr float kOneMinusEpsilon = 0x1.fffffep-1f;

// GGX alpha below which a surface is a perfect mirror or a smooth interface in every routine alike.
inline constexpr float kDeltaAlpha = 1e-3f;

// Reflectance under a thin film is kept below this, so that the series of its reflections
// converges.
inline constexpr float kLargestFilmBase = 0.9999f;

// Least cosine to the normal at which sheen is evaluated: its value has 1 / cosine.
inline constexpr float kMinSheenCosine = 1e-4f;

// |eta - 1| below which an interface is none at all.
inline constexpr float kIndexMatched = 1e-6f;

// Sine of the angle below which a direction counts as parallel to a camera's up vector.
inline constexpr double kParallelSine = 1e-6;

// Survival probability of Russian roulette is never below this.
inline constexpr float kMinSurvival = 0.05f;

// Half a step of an 8-bit normal map: 127 and 128 of 255 both mean zero.
inline constexpr float kNormalMapStep = 1.01f / 255;

// A triangle light is sampled by solid angle when area / distance^2 exceeds this; below, its cosine
// and distance hardly vary.
inline constexpr float kSolidAngleSampling = 0.1f;
// |determinant| of a matrix beside the product of its columns' lengths, below which it is singular
// up to rounding in double.
inline constexpr double kSingularRatio = 1e-14;
// How far apart the layers of a flattened mesh stay, of what they would be were it not flattened:
// so that floats still order them, and nobody sees the gap.
inline constexpr double kFlatLayerShare = 0x1p-12;

// Relative deviation of M^T M from a multiple of the identity that the rounding of a file's floats
// may cause.
inline constexpr double kUniformScaleTolerance = 1e-5;

// Largest world coordinate in metres: the squares of distances fit a float with room to spare.
inline constexpr double kMaxWorldCoordinate = 1e15;

// Finite test on the bits, so that it holds under any compiler flag.
inline bool is_finite(float x) {
    return (std::bit_cast<uint32_t>(x) & 0x7F800000u) != 0x7F800000u;
}
inline bool is_finite(double x) {
    return (std::bit_cast<uint64_t>(x) & 0x7FF0000000000000ull) != 0x7FF0000000000000ull;
}
inline bool is_finite(const Vec2f& v) {
    return is_finite(v.x) && is_finite(v.y);
}
inline bool is_finite(const Vec3f& v) {
    return is_finite(v.x) && is_finite(v.y) && is_finite(v.z);
}
inline bool is_finite(const Vec4f& v) {
    return is_finite(v.x) && is_finite(v.y) && is_finite(v.z) && is_finite(v.w);
}
inline bool is_finite(const Vec3d& v) {
    return is_finite(v.x) && is_finite(v.y) && is_finite(v.z);
}

inline float safe_sqrt(float x) {
    return std::sqrt(x > 0 ? x : 0.0f);
}
inline float clamp01(float x) {
    return x < 0 ? 0.0f : (x > 1 ? 1.0f : x);
}

// a b - c d, rounded once after a double subtraction: both products of floats are exact in double.
inline float difference_of_products(float a, float b, float c, float d) {
    return static_cast<float>(static_cast<double>(a) * b - static_cast<double>(c) * d);
}

// Cross product whose components carry hardly more than the last rounding.
inline Vec3f stable_cross(const Vec3f& a, const Vec3f& b) {
    return Vec3f(difference_of_products(a.y, b.z, a.z, b.y),
                 difference_of_products(a.z, b.x, a.x, b.z),
                 difference_of_products(a.x, b.y, a.y, b.x));
}

// Normalised v, in double inside, so that no representable non-zero length over- or underflows;
// fallback for zero.
inline Vec3f safe_normalize(const Vec3f& v, const Vec3f& fallback) {
    const Vec3d w(v);
    const double square = dot(w, w);
    if (!(square > 0) || !is_finite(square)) return fallback;
    return Vec3f(w / std::sqrt(square));
}

// Weight of strategy a against b by the power heuristic, in ratio form: no overflow for any
// densities, infinity included (Veach 1997, section 9.2.4). Both 0 gives 0, and NaN gives NaN, so
// that a density that is none does not go unseen.
inline float power_heuristic(float pdf_a, float pdf_b) {
    const float sum = pdf_a + pdf_b;
    if (sum != sum) return sum;
    if (!(pdf_a > 0)) return 0;
    if (!(pdf_b > 0)) return 1;
    if (pdf_a >= pdf_b) {
        if (!is_finite(pdf_a)) return is_finite(pdf_b) ? 1.0f : 0.5f;
        const float r = pdf_b / pdf_a;
        return 1 / (1 + r * r);
    }
    if (!is_finite(pdf_b)) return 0;
    const float r = pdf_a / pdf_b;
    const float r2 = r * r;
    return r2 / (1 + r2);
}

// The next float towards +infinity or -infinity; finite x only.
inline float next_float_up(float x) {
    if (x == 0) return std::bit_cast<float>(1u);
    const uint32_t bits = std::bit_cast<uint32_t>(x);
    return std::bit_cast<float>(x > 0 ? bits + 1 : bits - 1);
}
inline float next_float_down(float x) {
    return -next_float_up(-x);
}

// p moved off a surface with unit normal n, to the side that `direction` points to, by a bound on
// p's own error (error >= 0 per axis), rounded away from the surface (Pharr, Jakob, Humphreys 2023,
// section 6.8.6).
inline Vec3f offset_ray_origin(const Vec3f& p, const Vec3f& error, const Vec3f& n,
                               const Vec3f& direction) {
    const float distance = dot(glm::abs(n), error);
    Vec3f offset = distance * n;
    if (dot(direction, n) < 0) offset = -offset;
    Vec3f po = p + offset;
    for (int i = 0; i < 3; ++i) {
        if (offset[i] > 0) po[i] = next_float_up(po[i]);
        if (offset[i] < 0) po[i] = next_float_down(po[i]);
    }
    return po;
}

// Two unit vectors that make a right-handed orthonormal frame with unit n (Duff et al. 2017).
inline void orthonormal_basis(const Vec3f& n, Vec3f& t, Vec3f& b) {
    const float sign = std::copysign(1.0f, n.z);
    const float a = -1 / (sign + n.z);
    const float c = n.x * n.y * a;
    t = Vec3f(1 + sign * n.x * n.x * a, sign * c, -sign * n.x);
    b = Vec3f(c, sign + n.y * n.y * a, -n.y);
}

}  // namespace talbot
