// Rays as traversal wants them: validated, rescaled by a power of two where their direction is out
// of range, moved into the space of an instance, and with the constants of the slab test.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "core/geometry/bvh.h"
#include "core/geometry/float4.h"
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
    float t_unscale = 1;        // 1 / t_scale
    uint32_t instance = kNoId;  // of all triangles of the tree, unless kNoId
};

namespace local_ray_detail {

// The rays that to_world_kernel does not take as they are: direction out of range, or nothing to
// hit at all.
bool rescale(const Ray& ray, LocalRay& local);

// The exponent of a direction (biased, of a double) brought to what kMaxScaleExponent allows; false
// when the scaled direction would then be out of range, or is zero.
bool limit_exponent(uint64_t& exponent);

}  // namespace local_ray_detail

// False when nothing can be hit: not finite, out of range or without direction.
TALBOT_FORCE_INLINE bool to_world_kernel(const Ray& ray, LocalRay& local) {
    const uint32_t origin = std::max(magnitude_bits(ray.o.x),
                                     std::max(magnitude_bits(ray.o.y), magnitude_bits(ray.o.z)));
    const uint32_t direction = std::max(magnitude_bits(ray.d.x),
                                        std::max(magnitude_bits(ray.d.y), magnitude_bits(ray.d.z)));
    constexpr uint32_t kLeast = magnitude_bits(kMinDirection);
    constexpr uint32_t kMost = magnitude_bits(kMaxDirection);
    const bool usual = (origin <= magnitude_bits(kMaxCoordinate)) &
                       (direction - kLeast <= kMost - kLeast) & (ray.t_max > 0);
    if (!usual) return local_ray_detail::rescale(ray, local);
    set_shear(local.sheared, ray.o, ray.d);
    return true;
}

inline constexpr uint64_t kDoubleBias = 1023;

// The ray in the space of an instance: transformed in double and rounded once, its direction
// brought to unit size by a power of two. False when it cannot be represented there.
TALBOT_FORCE_INLINE bool to_object_space(const Ray& ray, const SceneObject& object,
                                         LocalRay& local) {
    const Vec3d o = object.object_from_world * Vec3d(ray.o) + object.object_from_world_offset;
    const Vec3d d = object.object_from_world * Vec3d(ray.d);
    if (!is_finite(o) || !is_finite(d)) return false;
    if (max_component(glm::abs(o)) > kMaxCoordinate) return false;
    // 2^-exponent of the largest component.
    uint64_t exponent = std::bit_cast<uint64_t>(max_component(glm::abs(d))) >> 52;
    constexpr uint64_t kLeast = kDoubleBias - kMaxScaleExponent;
    if (exponent - kLeast > 2 * kMaxScaleExponent && !local_ray_detail::limit_exponent(exponent))
        return false;
    const double scale = std::bit_cast<double>((2 * kDoubleBias - exponent) << 52);
    set_shear(local.sheared, Vec3f(o), Vec3f(d * scale));
    local.t_scale = static_cast<float>(scale);
    local.t_unscale = static_cast<float>(std::bit_cast<double>(exponent << 52));
    local.instance = object.id;
    return true;
}

// A world t as a bound in a tree, never too small: where it is denormal, as with endlessly long
// directions, it has lost some of its bits.
TALBOT_FORCE_INLINE float largest_t_in_tree(float t, const LocalRay& ray) {
    const float lost = std::numeric_limits<float>::min() * std::max(1.0f, ray.t_unscale);
    return t * ray.t_unscale * kSlabFarFactor + lost;
}

// Near planes p are met at p reciprocal - near_offset, far planes likewise with the far constants;
// see kSlabOriginPad. The fourth lanes are unused.
struct SlabRay {
    Float4 reciprocal;
    Float4 near_offset;
    Float4 far_reciprocal;
    Float4 far_offset;
};

// The power of two next above 1 / x for a positive normal x.
TALBOT_FORCE_INLINE float reciprocal_power(float x) {
    constexpr uint32_t kExponent = 0x7f800000u;
    return std::bit_cast<float>((254u << 23) - (std::bit_cast<uint32_t>(x) & kExponent));
}

// For boxes whose coordinates are at most largest_coordinate in size. With kInstances among them:
// a ray is rounded again in object space, which far from its origin shifts it along every axis.
template <bool kInstances>
TALBOT_FORCE_INLINE SlabRay make_slab_ray(const ShearedRay& ray, float largest_coordinate) {
    const Float4 none = {0, 0, 0, 0};
    const Float4 d = {ray.d[0], ray.d[1], ray.d[2], 1};
    const Float4 o = {ray.o[0], ray.o[1], ray.o[2], 0};
    SlabRay slabs;
    slabs.reciprocal = 1 / d;
    Float4 reach = none;
    const float far_origin = std::bit_cast<float>(std::max(
        magnitude_bits(ray.o[0]), std::max(magnitude_bits(ray.o[1]), magnitude_bits(ray.o[2]))));
    const float parallel = kParallelShare * std::abs(ray.d[ray.kz]);
    const uint32_t least = std::min(magnitude_bits(ray.d[0]),
                                    std::min(magnitude_bits(ray.d[1]), magnitude_bits(ray.d[2])));
    if (std::bit_cast<float>(least) < parallel) [[unlikely]] {
        // In registers throughout: rays along axes are common, and cost next to nothing this way.
        const float size = std::max(largest_coordinate, far_origin);
        const float pad = size * (2 * kParallelReach) * reciprocal_power(std::abs(ray.d[ray.kz]));
        const auto is_parallel = abs4(d) < none + parallel;
        slabs.reciprocal =
            is_parallel ? copysign4(none + kParallelReciprocal, d) : slabs.reciprocal;
        reach = is_parallel ? none + pad : none;
    }
    const Float4 c = o * slabs.reciprocal;
    Float4 pad = kSlabOriginPad * abs4(c) + reach;
    if constexpr (kInstances)
        pad += static_cast<float>(kInstanceBoundsPad) * far_origin * abs4(slabs.reciprocal);
    slabs.near_offset = c + pad;
    slabs.far_reciprocal = slabs.reciprocal * kSlabFarFactor;
    slabs.far_offset = (c - pad) * kSlabFarFactor;
    return slabs;
}

}  // namespace talbot
