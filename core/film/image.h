// Plain images in float, row 0 on top, and 8-bit ones for files and the screen.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/math/vec.h"

namespace talbot {

// Scene-linear RGB and coverage. rgb is premultiplied by alpha where the background is transparent.
struct ImageRgba {
    uint32_t width = 0;
    uint32_t height = 0;
    std::vector<Rgb> rgb;
    std::vector<float> alpha;  // empty means opaque
};

// One named layer of an EXR file: 1 or 3 channels per pixel, interleaved.
struct ImageLayer {
    std::string name;
    uint32_t channels = 3;
    std::vector<float> values;
};

struct ImageBytes {
    uint32_t width = 0;
    uint32_t height = 0;
    uint32_t channels = 4;  // 3 or 4
    std::vector<uint8_t> bytes;
};

}  // namespace talbot
