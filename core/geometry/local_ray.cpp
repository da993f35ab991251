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

}  // namespace talbot::local_ray_detail
