// Pixel filters by importance sampling: a sample's offset is drawn from the filter, so each sample
// belongs to one pixel with weight 1 and pixels stay independent.
#pragma once

#include "core/integrate/sampling_kinds.h"
#include "core/math/vec.h"

namespace talbot {

// Offset from the pixel's top left corner, in pixels.
Vec2f sample_pixel_filter(FilterKind kind, const Vec2f& u);

}  // namespace talbot
