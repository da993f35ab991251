// KHR_lights_punctual in world coordinates.
#pragma once

#include <string>

#include "core/math/vec.h"

namespace talbot {

enum class PunctualKind : uint8_t { point, spot, directional };

struct PunctualLight {
    std::string name;
    PunctualKind kind = PunctualKind::point;
    Rgb color{1};
    float intensity = 1;         // candela (point, spot) or lux (directional)
    Vec3d position{0};           // not for directional
    Vec3f direction{0, 0, -1};   // unit; the way the light travels (spot axis, sun rays)
    float range = kInfinity;     // metres, > 0; nothing arrives beyond it
    float inner_cone_angle = 0;  // radians, 0 <= inner < outer <= pi/2
    float outer_cone_angle = 0.78539816f;

    // Whether it sends anything.
    bool shines() const {
        return intensity > 0 && (color.x > 0 || color.y > 0 || color.z > 0);
    }
    bool operator==(const PunctualLight&) const = default;
};

}  // namespace talbot
