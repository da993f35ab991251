#include "core/geometry/local_ray.h"

#include <limits>

namespace talbot::local_ray_detail {

namespace {

constexpr uint32_t kLeastNormal = magnitude_bits(std::numeric_limits<float>::min());

// log2 of kMaxDirection and 1 / kMinDirection.
constexpr uint64_t kDirectionRange = (magnitude_bits(kMaxDirection) >> 23) - 127;
static_assert(kMinDirection * kMaxDirection == 1);

}  // namespace

bool rescale(const Ray& ray, LocalRay& local) {
    if (!(ray.t_max > 0) || !is_finite(ray.o) || !is_finite(ray.d)) return false;
    const float largest = max_component(glm::abs(ray.d));
    // Whether denormals count as zero depends on the thread; as directions they always do.
    if (magnitude_bits(largest) < kLeastNormal) return false;
    if (max_component(glm::abs(ray.o)) > kMaxCoordinate) return false;
    const int exponent = std::min(std::ilogb(largest), kMaxScaleExponent);
    const auto scaled = [exponent](float x) { return std::ldexp(x, -exponent); };
    local.sheared = shear(ray.o, Vec3f(scaled(ray.d.x), scaled(ray.d.y), scaled(ray.d.z)));
    local.t_scale = scaled(1);
    local.t_unscale = 1 / local.t_scale;
    return true;
}

bool limit_exponent(uint64_t& exponent) {
    constexpr uint64_t kLeast = kDoubleBias - kMaxScaleExponent;
    constexpr uint64_t kMost = kDoubleBias + kMaxScaleExponent;
    if (exponent < kLeast - kDirectionRange || exponent >= kMost + kDirectionRange) return false;
    exponent = std::clamp(exponent, kLeast, kMost);
    return true;
}

void set_parallel_slabs(const ShearedRay& ray, const Bounds& bounds, SlabRay& slabs) {
    const float largest = std::abs(ray.d[ray.kz]);
    float size = 0;
    for (int i = 0; i < 3; ++i) {
        const float bound = std::max(std::abs(bounds.lower[i]), std::abs(bounds.upper[i]));
        size = std::max(size, std::max(bound, std::abs(ray.o[i])));
    }
    const float reach = 2 * size * std::abs(slabs.reciprocal[ray.kz]) * kParallelReach;
    const float least = kParallelShare * largest;
    for (int i = 0; i < 3; ++i) {
        if (!(std::abs(ray.d[i]) < least)) continue;
        const float r = std::copysign(kParallelReciprocal, ray.d[i]);
        const float c = ray.o[i] * r;
        const float pad = kSlabOriginPad * std::abs(c) + reach;
        slabs.reciprocal[i] = r;
        slabs.near_offset[i] = c + pad;
        slabs.far_reciprocal[i] = r * kSlabFarFactor;
        slabs.far_offset[i] = (c - pad) * kSlabFarFactor;
    }
}

}  // namespace talbot::local_ray_detail
