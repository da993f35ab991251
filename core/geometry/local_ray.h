// Rays as traversal wants them: validated, rescaled by a power of two where their direction is out
// of range, moved into the space of an instance, and with the constants of the slab test.
#pragma once

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

// False when nothing can be hit: not finite, out of range or without direction.
inline bool to_world_kernel(const Ray& ray, LocalRay& local) {
    if (!(ray.t_max > 0) || !is_finite(ray.o) || !is_finite(ray.d)) return false;
    const float largest = max_component(glm::abs(ray.d));
    if (!(largest > 0) || max_component(glm::abs(ray.o)) > kMaxCoordinate) return false;
    if (largest >= kMinDirection && largest <= kMaxDirection) {
        local.sheared = shear(ray.o, ray.d);
        return true;
    }
    const int exponent = std::ilogb(largest);
    local.sheared =
        shear(ray.o, Vec3f(std::ldexp(ray.d.x, -exponent), std::ldexp(ray.d.y, -exponent),
                           std::ldexp(ray.d.z, -exponent)));
    local.t_scale = std::ldexp(1.0f, -exponent);
    return is_finite(local.t_scale) && is_finite(1 / local.t_scale);
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

// Plane p is met at p r - c; see kSlabOriginPad. Near planes use near_offset, far planes
// far_offset.
struct SlabRay {
    Vec3f reciprocal;
    Vec3f near_offset;
    Vec3f far_offset;
    uint32_t is_negative[3];
};

inline SlabRay make_slab_ray(const LocalRay& ray, const Bounds& bounds) {
    const Vec3f& o = ray.sheared.o;
    const Vec3f& d = ray.sheared.d;
    const float largest = std::abs(d[ray.sheared.kz]);
    SlabRay slabs;
    for (int i = 0; i < 3; ++i) {
        slabs.is_negative[i] = std::signbit(d[i]) ? 1 : 0;
        const bool parallel = std::abs(d[i]) < kParallelShare * largest;
        const float r = parallel ? std::copysign(kParallelReciprocal, d[i]) : 1 / d[i];
        const float c = o[i] * r;
        float pad = kSlabOriginPad * std::abs(c);
        if (parallel) {
            const float size =
                max_component(glm::max(glm::abs(bounds.lower), glm::abs(bounds.upper)));
            pad += (size + max_component(glm::abs(o))) / largest * kParallelReach;
        }
        slabs.reciprocal[i] = r;
        slabs.near_offset[i] = c + pad;
        slabs.far_offset[i] = c - pad;
    }
    return slabs;
}

}  // namespace talbot
