// The light from infinitely far away: black, a constant, a linear gradient or an equirectangular
// image.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/math/vec.h"

namespace talbot {

// Scene-linear radiance, row 0 on top. Looked up at u = atan2(z, x) / 2 pi + 0.5, v = acos(y) / pi.
struct EnvironmentImage {
    uint32_t width = 0;
    uint32_t height = 0;
    std::vector<Rgb> texels;  // finite and >= 0
    std::string file;
    std::string sha256;            // of the file's bytes, in hex
    uint64_t repaired_texels = 0;  // non-finite or negative ones, set to 0
};

// Radiance from + (to - from) * 0.5 * (dot(direction, axis) + 1); axis is unit.
struct EnvironmentGradient {
    Vec3f axis{0, 1, 0};
    Rgb from{1};
    Rgb to{1};

    bool operator==(const EnvironmentGradient&) const = default;
};

struct Environment {
    Rgb color{0};  // used when there is neither gradient nor image
    std::optional<EnvironmentGradient> gradient;
    std::shared_ptr<const EnvironmentImage> image;  // wins over gradient and color
    float rotation_degrees = 0;                     // counter-clockwise seen from +Y
    float intensity = 1;                            // multiplies all of it

    bool operator==(const Environment&) const = default;
};

}  // namespace talbot
