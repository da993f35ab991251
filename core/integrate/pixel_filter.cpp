#include "core/integrate/pixel_filter.h"

#include <array>
#include <cmath>
#include <numbers>

namespace talbot {
namespace {

constexpr double kBlackmanHarrisWidth = 3.3;  // pixels, whole support
constexpr std::size_t kTableSize = 4096;

double blackman_harris(double x) {
    // x in [0, 1] over the support (Harris 1978, 4-term minimum).
    const double a = 2 * std::numbers::pi * x;
    return 0.35875 - 0.48829 * std::cos(a) + 0.14128 * std::cos(2 * a) - 0.01168 * std::cos(3 * a);
}

// Inverse of the filter's cumulative distribution at even steps, in pixels from the centre.
std::array<float, kTableSize + 1> make_inverse() {
    constexpr int kSteps = 1 << 16;
    std::array<double, kSteps + 1> cumulative{};
    for (std::size_t i = 0; i < kSteps; ++i) {
        cumulative[i + 1] =
            cumulative[i] + blackman_harris((static_cast<double>(i) + 0.5) / kSteps);
    }
    std::array<float, kTableSize + 1> inverse{};
    std::size_t step = 0;
    for (std::size_t i = 0; i <= kTableSize; ++i) {
        const double target = cumulative[kSteps] * static_cast<double>(i) / kTableSize;
        while (step + 1 < kSteps && cumulative[step + 1] < target) ++step;
        const double span = cumulative[step + 1] - cumulative[step];
        const double x =
            (static_cast<double>(step) + (span > 0 ? (target - cumulative[step]) / span : 0)) /
            kSteps;
        inverse[i] = static_cast<float>((x - 0.5) * kBlackmanHarrisWidth);
    }
    return inverse;
}

float invert(float u) {
    static const std::array<float, kTableSize + 1> table = make_inverse();
    const float s = u * kTableSize;
    const auto i = static_cast<std::size_t>(s);
    const float f = s - static_cast<float>(i);
    return table[i] * (1 - f) + table[i + 1] * f;
}

}  // namespace

Vec2f sample_pixel_filter(FilterKind kind, const Vec2f& u) {
    if (kind == FilterKind::box) return u;
    return Vec2f(0.5f + invert(u.x), 0.5f + invert(u.y));
}

}  // namespace talbot
