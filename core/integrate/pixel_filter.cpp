#include "core/integrate/pixel_filter.h"

#include <cmath>
#include <numbers>
#include <vector>

#include "core/math/distribution.h"

namespace talbot {
namespace {

constexpr double kBlackmanHarrisWidth = 3.3;  // pixels, whole support
constexpr std::size_t kCells = 1024;

double blackman_harris(double x) {
    // x in [0, 1] over the support (Harris 1978, 4-term minimum).
    const double a = 2 * std::numbers::pi * x;
    return 0.35875 - 0.48829 * std::cos(a) + 0.14128 * std::cos(2 * a) - 0.01168 * std::cos(3 * a);
}

// The filter in cells of even width: in each cell, the tails' too, exactly its share of samples.
DiscreteDistribution make_cells() {
    std::vector<double> weights(kCells);
    for (std::size_t i = 0; i < kCells; ++i)
        weights[i] = blackman_harris((static_cast<double>(i) + 0.5) / kCells);
    return DiscreteDistribution(weights);
}

// Pixels from the centre.
float invert(float u) {
    static const DiscreteDistribution cells = make_cells();
    const DiscreteDistribution::Pick pick = cells.sample(u);
    const float x = (static_cast<float>(pick.index) + pick.u) * (1.0f / kCells) - 0.5f;
    return x * static_cast<float>(kBlackmanHarrisWidth);
}

}  // namespace

Vec2f sample_pixel_filter(FilterKind kind, const Vec2f& u) {
    if (kind == FilterKind::box) return u;
    return Vec2f(0.5f + invert(u.x), 0.5f + invert(u.y));
}

}  // namespace talbot
