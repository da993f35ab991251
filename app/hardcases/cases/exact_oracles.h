// What the float inputs say, in integers or binary128, and the textbook routines that serve as
// controls.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "app/hardcases/cases/mesh_shapes.h"
#include "app/hardcases/cases/quad_float.h"
#include "core/geometry/accel.h"
#include "core/geometry/local_ray.h"
#include "core/geometry/triangle.h"
#include "core/math/ray.h"

namespace talbot::hardcases::geometry {

__extension__ typedef __int128 Wide;

// Triangles.

template <class T>
struct Triple {
    T x, y, z;
};

template <class T>
Triple<T> minus(const Vec3f& a, const Vec3f& b) {
    return {static_cast<T>(a.x) - static_cast<T>(b.x), static_cast<T>(a.y) - static_cast<T>(b.y),
            static_cast<T>(a.z) - static_cast<T>(b.z)};
}
template <class T>
T dot(const Triple<T>& a, const Triple<T>& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class T>
Triple<T> cross(const Triple<T>& p, const Triple<T>& q) {
    return {p.y * q.z - p.z * q.y, p.z * q.x - p.x * q.z, p.x * q.y - p.y * q.x};
}
template <class T>
T triple_product(const Triple<T>& d, const Triple<T>& p, const Triple<T>& q) {
    return dot(d, cross(p, q));
}

// Whether the line through o along d meets the closed triangle, and where; exact for integer
// coordinates up to 2^20 with T = Wide. Lines in the triangle's plane do not count.
template <class T>
bool exact_triangle(const Ray& ray, const std::array<Vec3f, 3>& tri, T& numerator, T& denominator) {
    const Triple<T> d = minus<T>(ray.d, Vec3f(0));
    const Triple<T> a = minus<T>(tri[0], ray.o);
    const Triple<T> b = minus<T>(tri[1], ray.o);
    const Triple<T> c = minus<T>(tri[2], ray.o);
    const T u = triple_product(d, c, b);
    const T v = triple_product(d, a, c);
    const T w = triple_product(d, b, a);
    if ((u < 0 || v < 0 || w < 0) && (u > 0 || v > 0 || w > 0)) return false;
    denominator = u + v + w;
    if (denominator == 0) return false;
    // t = a . (b x c) / ((u + v + w) of the same orientation).
    numerator = triple_product(a, c, b);
    return true;
}

// Talbot's scalar test of one triangle.
inline bool own_triangle(const Ray& ray, const std::array<Vec3f, 3>& tri, TriangleHit& hit) {
    return is_hittable(tri[0], tri[1], tri[2]) &&
           intersect_triangle(shear(ray.o, ray.d), tri[0], tri[1], tri[2],
                              triangle_extent(tri[0], tri[1], tri[2]), hit);
}

// Boxes.

// Whether [0, inf) along the ray meets the closed box, without rounding that could matter.
inline bool exact_box(const Ray& ray, const Bounds& box) {
    Quad enter = 0;
    Quad leave = 1e30;
    for (int i = 0; i < 3; ++i) {
        const Quad lower = static_cast<Quad>(box.lower[i]) - ray.o[i];
        const Quad upper = static_cast<Quad>(box.upper[i]) - ray.o[i];
        if (ray.d[i] == 0) {
            if (lower > 0 || upper < 0) return false;
            continue;
        }
        const Quad a = lower / ray.d[i];
        const Quad b = upper / ray.d[i];
        enter = std::max(enter, std::min(a, b));
        leave = std::min(leave, std::max(a, b));
    }
    return enter <= leave;
}

// The kernels' box test, one box, with one or two roundings per plane.
inline bool own_box(const Ray& ray, const Bounds& box, bool fused) {
    LocalRay local;
    if (!to_world_kernel(ray, local)) return false;
    const SlabRay slabs = make_slab_ray<false>(local.sheared, box.largest_coordinate());
    const auto plane_t = [&](float p, float r, float c) {
        return fused ? std::fma(p, r, -c) : p * r - c;
    };
    float enter = 0;
    float leave = ray.t_max / local.t_scale * kSlabFarFactor;
    for (int i = 0; i < 3; ++i) {
        const bool negative = std::signbit(local.sheared.d[i]);
        const float near_p = negative ? box.upper[i] : box.lower[i];
        const float far_p = negative ? box.lower[i] : box.upper[i];
        enter = std::max(enter, plane_t(near_p, slabs.reciprocal[i], slabs.near_offset[i]));
        leave = std::min(leave, plane_t(far_p, slabs.far_reciprocal[i], slabs.far_offset[i]));
    }
    return enter <= leave;
}

// Control: planes as they are, no padding, 0 times infinity let through as NaN.
inline bool textbook_box(const Ray& ray, const Bounds& box) {
    float enter = 0;
    float leave = kInfinity;
    for (int i = 0; i < 3; ++i) {
        const float r = 1 / ray.d[i];
        float a = (box.lower[i] - ray.o[i]) * r;
        float b = (box.upper[i] - ray.o[i]) * r;
        if (r < 0) std::swap(a, b);
        enter = a > enter ? a : enter;
        leave = b < leave ? b : leave;
        if (!(enter <= leave) || a != a || b != b) return false;
    }
    return true;
}

inline Bounds random_box(Rng& rng, bool may_be_flat) {
    Bounds box;
    box.lower = rng.in_box(-2, 2);
    box.upper = box.lower + rng.in_box(0, 1);
    if (may_be_flat && rng.below(3) == 0) {
        const int axis = rng.between(0, 2);
        box.upper[axis] = box.lower[axis];
    }
    return box;
}

// Spheres.

// Both crossings, and how far the line stays from the limb (positive inside), in length units.
struct ExactSphere {
    bool hit = false;
    double t[2] = {0, 0};
    double inside = 0;
    double point[3] = {0, 0, 0};  // of the first crossing, from the centre
};

inline ExactSphere exact_sphere(const Ray& ray, const Vec3d& center, double radius) {
    Quad a = 0;
    Quad b = 0;
    Quad f2 = 0;
    Quad f[3];
    for (int i = 0; i < 3; ++i) {
        const Quad d = ray.d[i];
        f[i] = static_cast<Quad>(ray.o[i]) - static_cast<Quad>(center[i]);
        a += d * d;
        b -= f[i] * d;
        f2 += f[i] * f[i];
    }
    const Quad r = radius;
    const Quad distance2 = f2 - b * b / a;
    ExactSphere result;
    result.inside = static_cast<double>(r - square_root(distance2));
    const Quad discriminant = r * r - distance2;
    if (discriminant < 0) return result;
    const Quad root = square_root(discriminant * a);
    result.hit = true;
    const Quad t0 = (b - root) / a;
    result.t[0] = static_cast<double>(t0);
    result.t[1] = static_cast<double>((b + root) / a);
    for (int i = 0; i < 3; ++i) result.point[i] = static_cast<double>(f[i] + t0 * ray.d[i]);
    return result;
}

// Control: the textbook float quadratic.
inline bool naive_sphere(const Ray& ray, const Vec3f& center, float radius, float (&t)[2]) {
    const Vec3f f = ray.o - center;
    const float a = talbot::dot(ray.d, ray.d);
    const float b = 2 * talbot::dot(f, ray.d);
    const float c = talbot::dot(f, f) - radius * radius;
    const float discriminant = b * b - 4 * a * c;
    if (discriminant < 0) return false;
    t[0] = (-b - std::sqrt(discriminant)) / (2 * a);
    t[1] = (-b + std::sqrt(discriminant)) / (2 * a);
    return true;
}

}  // namespace talbot::hardcases::geometry
