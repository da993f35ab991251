// What is known of the pixel under the pointer.
#pragma once

#include <optional>

#include "core/session/snapshot.h"

namespace talbot {

struct PixelReading {
    uint32_t x = 0;  // of the full image
    uint32_t y = 0;
    Rgb mean{0};                          // scene-linear
    std::optional<Rgb> standard_error;    // of the mean, by the error of its 8x8 pixels
    std::optional<double> error_percent;  // the same, relative
    std::optional<Rgb> value;             // of the variable that is asked for
};

// u and v in 0..1 across the image; empty without an image there.
std::optional<PixelReading> read_pixel(const Snapshot& snapshot, double u, double v);

}  // namespace talbot
