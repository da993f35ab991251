// The scalar ray-triangle test that decides every hit: edge functions in double in the space
// sheared along the ray, exact where rounding could matter, so that a hit is reported exactly when
// the float ray meets the closed float triangle. SIMD code only sorts out triangles that are
// certainly missed. References: Woop, Benthin, Wald 2013, "Watertight ray/triangle intersection";
// Shewchuk 1997.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "core/geometry/exact_sign.h"
#include "core/math/ray.h"
#include "core/math/robust.h"
#include "core/math/robust_geometry.h"
#include "core/math/vec.h"

namespace talbot {

// A ray with the constants of the shear that maps its direction to the axis kz, its largest
// component.
struct ShearedRay {
    Vec3f o{0};
    Vec3f d{0};
    int kx = 0, ky = 1, kz = 2;
    double sx = 0, sy = 0, sz = 0;  // d[kx] / d[kz], d[ky] / d[kz], 1 / d[kz]
};

inline ShearedRay shear(const Vec3f& o, const Vec3f& d) {
    ShearedRay ray;
    ray.o = o;
    ray.d = d;
    const Vec3f a = glm::abs(d);
    ray.kz = a.x > a.y ? (a.x > a.z ? 0 : 2) : (a.y > a.z ? 1 : 2);
    ray.kx = ray.kz == 2 ? 0 : ray.kz + 1;
    ray.ky = ray.kx == 2 ? 0 : ray.kx + 1;
    ray.sz = 1 / static_cast<double>(d[ray.kz]);
    ray.sx = d[ray.kx] * ray.sz;
    ray.sy = d[ray.ky] * ray.sz;
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

// Non-negative with the sign of the orientation taken out, or not a hit at all.
inline bool exact_edges(const ShearedRay& ray, const Vec3f& a, const Vec3f& b, const Vec3f& c,
                        double& u, double& v, double& w) {
    u = exact_triple_product(ray.d, ray.o, c, b);
    v = exact_triple_product(ray.d, ray.o, a, c);
    w = exact_triple_product(ray.d, ray.o, b, a);
    const double least = std::min(u, std::min(v, w));
    const double most = std::max(u, std::max(v, w));
    if (least < 0 && most > 0) return false;
    u = std::abs(u);
    v = std::abs(v);
    w = std::abs(w);
    return least < 0 || most > 0;
}

// Distance to the plane along kz, t times d[kz].
inline double exact_depth(const ShearedRay& ray, const Vec3f& a, const Vec3f& b, const Vec3f& c) {
    const double area = exact_triple_product(ray.d, ray.o, c, b) +
                        exact_triple_product(ray.d, ray.o, a, c) +
                        exact_triple_product(ray.d, ray.o, b, a);
    return exact_volume(ray.o, a, c, b) / area * ray.d[ray.kz];
}

}  // namespace triangle_detail

// Whether the ray's line meets the closed triangle abc, and where. extent is triangle_extent(a, b,
// c).
inline bool intersect_triangle(const ShearedRay& ray, const Vec3f& a, const Vec3f& b,
                               const Vec3f& c, float extent, TriangleHit& hit) {
    const double ox = ray.o[ray.kx];
    const double oy = ray.o[ray.ky];
    const double oz = ray.o[ray.kz];
    const double az = a[ray.kz] - oz;
    const double bz = b[ray.kz] - oz;
    const double cz = c[ray.kz] - oz;
    const double ax = (a[ray.kx] - ox) - ray.sx * az;
    const double ay = (a[ray.ky] - oy) - ray.sy * az;
    const double bx = (b[ray.kx] - ox) - ray.sx * bz;
    const double by = (b[ray.ky] - oy) - ray.sy * bz;
    const double cx = (c[ray.kx] - ox) - ray.sx * cz;
    const double cy = (c[ray.ky] - oy) - ray.sy * cz;
    double u = cx * by - cy * bx;
    double v = ax * cy - ay * cx;
    double w = bx * ay - by * ax;

    const double least = std::min(u, std::min(v, w));
    const double most = std::max(u, std::max(v, w));
    const double e = extent;
    const double error =
        kDoubleEpsilon * kEdgeErrorDepth * e * (std::abs(az) + kEdgeErrorExtent * e);
    if (least < -error && most > error) return false;
    double sum = u + v + w;
    if ((least <= error && most >= -error) || std::abs(sum) < kWellShaped * error) {
        if (!triangle_detail::exact_edges(ray, a, b, c, u, v, w)) return false;
        sum = u + v + w;
    }
    const double inverse = 1 / sum;
    double z = (u * az + v * bz + w * cz) * inverse;
    // An origin all but on the plane: cancellation would leave no digit, not even the sign.
    if (std::abs(z) < kInPlaneShare * (std::abs(az) + e)) {
        z = triangle_detail::exact_depth(ray, a, b, c);
    }
    hit.t = static_cast<float>(z * ray.sz);
    hit.u = static_cast<float>(v * inverse);
    hit.v = static_cast<float>(w * inverse);
    return true;
}

}  // namespace talbot
