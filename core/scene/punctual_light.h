// KHR_lights_punctual in world coordinates.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "core/math/vec.h"

namespace talbot {

// What a file's intensities are. spec: candela and lux, as KHR_lights_punctual has it. radiometric:
// watts, of files whose writer left out the 683 lm/W; they are multiplied by it.
enum class LightUnits : uint8_t { spec, radiometric };
struct LightUnitsInfo {
    LightUnits units;
    std::string_view name;
    float factor;  // from the file's number to candela or lux
};
inline constexpr std::array<LightUnitsInfo, 2> kLightUnits{{
    {LightUnits::spec, "spec", 1},
    {LightUnits::radiometric, "radiometric", 683},
}};

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
    // Radians, of directional lights: above 0 (2^-20) they are discs, which reflections and the
    // camera see.
    float angular_diameter = 0;

    // Whether it sends anything.
    bool shines() const { return intensity > 0 && (color.x > 0 || color.y > 0 || color.z > 0); }
    // What float directions cannot tell from a point is a direction without extent.
    bool is_disc() const {
        constexpr float kLeastDiameter = 0x1p-20f;
        return kind == PunctualKind::directional && angular_diameter >= kLeastDiameter;
    }
    bool operator==(const PunctualLight&) const = default;
};

}  // namespace talbot
