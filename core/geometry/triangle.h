// The scalar ray-triangle test that decides every hit: edge functions in double in the space
// sheared along the ray, exact where rounding could matter, so that a hit is reported exactly when
// the float ray meets the closed float triangle. block_test.h does the same for four triangles at
// once. References: Woop, Benthin, Wald 2013, "Watertight ray/triangle intersection";
// Shewchuk 1997.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include "core/geometry/exact_sign.h"
#include "core/geometry/force_inline.h"
#include "core/math/ray.h"
#include "core/math/robust.h"
#include "core/math/robust_geometry.h"
#include "core/math/vec.h"

namespace talbot {

// The bits of |x|, which order as the magnitudes do, NaN above all.
constexpr uint32_t magnitude_bits(float x) {
    return std::bit_cast<uint32_t>(x) & 0x7FFFFFFFu;
}

// A ray with the constants of the shear that maps its direction to the axis kz, its largest
// component.
struct ShearedRay {
    float o[3];
    float d[3];
    double sx, sy, sz;  // d[kx] / d[kz], d[ky] / d[kz], 1 / d[kz]
    uint32_t kx, ky, kz;
};

TALBOT_FORCE_INLINE void set_shear(ShearedRay& ray, const Vec3f& o, const Vec3f& d) {
    constexpr uint32_t kNext[4] = {1, 2, 0, 1};
    const uint32_t ax = magnitude_bits(d.x);
    const uint32_t ay = magnitude_bits(d.y);
    const uint32_t az = magnitude_bits(d.z);
    const uint32_t k = ay > ax ? 1 : 0;
    ray.kz = az > std::max(ax, ay) ? 2 : k;
    ray.kx = kNext[ray.kz];
    ray.ky = kNext[ray.kz + 1];
    for (int i = 0; i < 3; ++i) {
        ray.o[i] = o[i];
        ray.d[i] = d[i];
    }
    ray.sz = 1 / static_cast<double>(ray.d[ray.kz]);
    ray.sx = ray.d[ray.kx] * ray.sz;
    ray.sy = ray.d[ray.ky] * ray.sz;
}

inline ShearedRay shear(const Vec3f& o, const Vec3f& d) {
    ShearedRay ray;
    set_shear(ray, o, d);
    return ray;
}

// Coordinates as the structure stores them: denormals become zero, so that nothing depends on the
// float mode of a thread.
inline Vec3f stored_vertex(const Vec3f& v) {
    Vec3f w = v;
    for (int i = 0; i < 3; ++i) {
        if (std::abs(w[i]) < 0x1p-126f) w[i] = 0;
    }
    return w;
}

// Whether rays can meet the triangle at all: finite, in range and not exactly degenerate.
inline bool is_hittable(const Vec3f& a, const Vec3f& b, const Vec3f& c) {
    for (const Vec3f* v : {&a, &b, &c}) {
        for (int i = 0; i < 3; ++i) {
            if (!is_finite((*v)[i]) || std::abs((*v)[i]) > kMaxCoordinate) return false;
        }
    }
    return !exactly_collinear(a, b, c);
}

// Largest coordinate difference between two vertices, rounded up.
inline float triangle_extent(const Vec3f& a, const Vec3f& b, const Vec3f& c) {
    const Vec3f span = glm::max(a, glm::max(b, c)) - glm::min(a, glm::min(b, c));
    return max_component(span) * (1 + 4 * kFloatEpsilon);
}

struct TriangleHit {
    float t;
    float u;
    float v;
};

namespace triangle_detail {

// The edge functions with their orientation taken out, so that none is negative; false when they
// differ in sign or all vanish.
bool exact_edges(const ShearedRay& ray, const Vec3f& a, const Vec3f& b, const Vec3f& c, double& u,
                 double& v, double& w);

// Distance to the plane along kz, t times d[kz].
double exact_depth(const ShearedRay& ray, const Vec3f& a, const Vec3f& b, const Vec3f& c);

}  // namespace triangle_detail

// Whether the ray's line meets the closed triangle, and where. corner(k, axis) is a coordinate of
// vertex k, extent is triangle_extent of the three.
template <class Corner>
TALBOT_FORCE_INLINE bool intersect_triangle(const ShearedRay& ray, const Corner& corner,
                                            float extent, TriangleHit& hit) {
    const double ox = ray.o[ray.kx];
    const double oy = ray.o[ray.ky];
    const double oz = ray.o[ray.kz];
    const double az = corner(0, ray.kz) - oz;
    const double bz = corner(1, ray.kz) - oz;
    const double cz = corner(2, ray.kz) - oz;
    const double ax = (corner(0, ray.kx) - ox) - ray.sx * az;
    const double ay = (corner(0, ray.ky) - oy) - ray.sy * az;
    const double bx = (corner(1, ray.kx) - ox) - ray.sx * bz;
    const double by = (corner(1, ray.ky) - oy) - ray.sy * bz;
    const double cx = (corner(2, ray.kx) - ox) - ray.sx * cz;
    const double cy = (corner(2, ray.ky) - oy) - ray.sy * cz;
    double u = cx * by - cy * bx;
    double v = ax * cy - ay * cx;
    double w = bx * ay - by * ax;

    const auto point = [&](uint32_t k) TALBOT_LAMBDA_INLINE {
        return Vec3f(corner(k, 0), corner(k, 1), corner(k, 2));
    };
    const double least = std::min(u, std::min(v, w));
    const double most = std::max(u, std::max(v, w));
    const double e = extent;
    const double error =
        kDoubleEpsilon * kEdgeErrorDepth * e * (std::abs(az) + kEdgeErrorExtent * e);
    double sum = u + v + w;
    if (!(least > error || most < -error) || !(std::abs(sum) >= kWellShaped * error)) {
        if (least < -error && most > error) return false;
        if (!triangle_detail::exact_edges(ray, point(0), point(1), point(2), u, v, w)) return false;
        sum = u + v + w;
    }
    const double inverse = 1 / sum;
    double z = (u * az + v * bz + w * cz) * inverse;
    // An origin all but on the plane: cancellation would leave no digit, not even the sign.
    if (std::abs(z) < kInPlaneShare * (std::abs(az) + e)) {
        z = triangle_detail::exact_depth(ray, point(0), point(1), point(2));
    }
    hit.t = static_cast<float>(z * ray.sz);
    hit.u = static_cast<float>(v * inverse);
    hit.v = static_cast<float>(w * inverse);
    return true;
}

inline bool intersect_triangle(const ShearedRay& ray, const Vec3f& a, const Vec3f& b,
                               const Vec3f& c, float extent, TriangleHit& hit) {
    const float corners[3][3] = {{a.x, a.y, a.z}, {b.x, b.y, b.z}, {c.x, c.y, c.z}};
    return intersect_triangle(
        ray, [&](uint32_t k, uint32_t axis) TALBOT_LAMBDA_INLINE { return corners[k][axis]; },
        extent, hit);
}

}  // namespace talbot
