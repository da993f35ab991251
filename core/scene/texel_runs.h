// Which texels lookups between two texture coordinates can read.
#pragma once

#include <cstdint>

#include "core/scene/texture.h"

namespace talbot {

// Texels first to last, in up to two runs where the coordinate wraps.
struct TexelRuns {
    uint32_t first[2] = {0, 0};
    uint32_t last[2] = {0, 0};
    int count = 0;
};

// Along one axis of a texture with `size` texels, one texel to spare on either side; everything
// where the coordinates are too large to tell.
TexelRuns texels_between(float lower, float upper, uint32_t size, TextureWrap wrap);

}  // namespace talbot
