// Rays as traversal wants them: validated, rescaled by a power of two where their direction is out
// of range, moved into the space of an instance, and with the constants of the slab test.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include "core/geometry/bvh.h"
#include "core/geometry/triangle.h"
#include "core/math/ray.h"
#include "core/math/robust.h"
#include "core/math/robust_geometry.h"

namespace talbot {

inline bool comes_before(const PrimitiveId& a, const PrimitiveId& b) {
    return a.instance != b.instance ? a.instance < b.instance : a.primitive < b.primitive;
}

// A ray in the space of one tree. Its own t times t_scale (a power of two) is the world ray's t.
struct LocalRay {
    ShearedRay sheared;
    float t_scale = 1;
    uint32_t instance = kNoId;  // of all triangles of the tree, unless kNoId
};

struct SlabRay;

namespace local_ray_detail {

// The rays that to_world_kernel does not take as they are: direction out of range, or nothing to
// hit at all.
bool rescale(const Ray& ray, LocalRay& local);

// Slabs that the ray runs along, or all but along.
void set_parallel_slabs(const ShearedRay& ray, const Bounds& bounds, SlabRay& slabs);

}  // namespace local_ray_detail

// False when nothing can be hit: not finite, out of range or without direction. Comparisons are
// false for NaN.
TALBOT_FORCE_INLINE bool to_world_kernel(const Ray& ray, LocalRay& local) {
    const float ax = std::abs(ray.d.x);
    const float ay = std::abs(ray.d.y);
    const float az = std::abs(ray.d.z);
    const bool usual =
        (std::abs(ray.o.x) <= kMaxCoordinate) & (std::abs(ray.o.y) <= kMaxCoordinate) &
        (std::abs(ray.o.z) <= kMaxCoordinate) & (ax <= kMaxDirection) & (ay <= kMaxDirection) &
        (az <= kMaxDirection) & (std::max(ax, std::max(ay, az)) >= kMinDirection) & (ray.t_max > 0);
    if (!usual) return local_ray_detail::rescale(ray, local);
    for (int i = 0; i < 3; ++i) {
        local.sheared.o[i] = ray.o[i];
        local.sheared.d[i] = ray.d[i];
    }
    set_shear(local.sheared);
    return true;
}

// x rounded to float even if it is used as a double afterwards. GCC before 13 folds the two
// conversions of a vector into none once it has vectorised straight-line code (it compares the
// precision of vector types, not of their elements).
inline float rounded(double x) {
    float f = static_cast<float>(x);
#if defined(__GNUC__) && !defined(__clang__) && __GNUC__ < 13 && defined(__SSE2__)
    asm("" : "+x"(f));
#endif
    return f;
}
inline Vec3f rounded(const Vec3d& v) {
    return Vec3f(rounded(v.x), rounded(v.y), rounded(v.z));
}

// The ray in the space of an instance: transformed in double and rounded once, its direction
// brought to unit size by a power of two. False when it cannot be represented there.
inline bool to_object_space(const Ray& ray, const SceneObject& object, LocalRay& local) {
    const Vec3d o = object.object_from_world * Vec3d(ray.o) + object.object_from_world_offset;
    const Vec3d d = object.object_from_world * Vec3d(ray.d);
    const double largest = max_component(glm::abs(d));
    if (!is_finite(o) || !is_finite(d) || !(largest > 0)) return false;
    if (max_component(glm::abs(o)) > kMaxCoordinate) return false;
    const int exponent = std::ilogb(largest);
    const double scale = std::ldexp(1.0, -exponent);
    local.sheared = shear(rounded(o), rounded(d * scale));
    local.t_scale = static_cast<float>(scale);
    local.instance = object.id;
    return local.t_scale > 0 && is_finite(local.t_scale) && is_finite(1 / local.t_scale);
}

// Near planes p are met at p near_reciprocal - near_offset, far planes likewise with the far
// constants; see kSlabOriginPad.
struct alignas(16) SlabRay {
    float reciprocal[4];
    float near_offset[4];
    float far_reciprocal[4];
    float far_offset[4];
};

TALBOT_FORCE_INLINE SlabRay make_slab_ray(const ShearedRay& ray, const Bounds& bounds) {
    SlabRay slabs;
    const float smallest = kParallelShare * std::abs(ray.d[ray.kz]);
    bool any_parallel = false;
    for (int i = 0; i < 4; ++i) {
        const float r = 1 / ray.d[i];
        const float c = ray.o[i] * r;
        const float pad = kSlabOriginPad * std::abs(c);
        slabs.reciprocal[i] = r;
        slabs.near_offset[i] = c + pad;
        slabs.far_reciprocal[i] = r * kSlabFarFactor;
        slabs.far_offset[i] = (c - pad) * kSlabFarFactor;
        any_parallel |= std::abs(ray.d[i]) < smallest;
    }
    if (any_parallel) local_ray_detail::set_parallel_slabs(ray, bounds, slabs);
    return slabs;
}

}  // namespace talbot
