#include "core/scene/texel_runs.h"

#include <algorithm>
#include <cmath>

namespace talbot {
namespace {

// Coordinates beyond this lose more than a texel to rounding.
constexpr float kFarCoordinate = 1024;

}  // namespace

TexelRuns texels_between(float lower, float upper, uint32_t size, TextureWrap wrap) {
    const TexelRuns whole{{0, 0}, {size - 1, 0}, 1};
    if (!(lower > -kFarCoordinate && upper < kFarCoordinate)) return whole;
    const bool inside = lower >= 0 && upper <= 1;
    if (wrap == TextureWrap::mirrored_repeat && !inside) return whole;
    // Linear filtering reads one texel on either side; one more covers the rounding of coordinates.
    const double n = size;
    auto first = static_cast<int64_t>(std::floor(double{lower} * n - 0.5)) - 1;
    auto last = static_cast<int64_t>(std::floor(double{upper} * n - 0.5)) + 2;
    const auto end = static_cast<int64_t>(size) - 1;
    if (wrap != TextureWrap::repeat) {
        first = std::clamp<int64_t>(first, 0, end);
        last = std::clamp<int64_t>(last, 0, end);
        return {{static_cast<uint32_t>(first), 0}, {static_cast<uint32_t>(last), 0}, 1};
    }
    if (last - first >= end) return whole;
    const int64_t shift = static_cast<int64_t>(std::floor(static_cast<double>(first) / n)) * size;
    first -= shift;
    last -= shift;
    if (last <= end)
        return {{static_cast<uint32_t>(first), 0}, {static_cast<uint32_t>(last), 0}, 1};
    return {{static_cast<uint32_t>(first), 0},
            {static_cast<uint32_t>(end), static_cast<uint32_t>(last - end - 1)},
            2};
}

}  // namespace talbot
