// From scene-linear radiance to display: exposure, tone curve, sRGB. The shader
// shaders/display.frag is this file's twin.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

#include "core/film/image.h"
#include "core/math/vec.h"

namespace talbot {

enum class ToneMap : uint8_t { linear, aces, agx, neutral };

struct ToneMapInfo {
    ToneMap tone_map;
    std::string_view name;   // command line
    std::string_view label;  // panel
};
inline constexpr std::array<ToneMapInfo, 4> kToneMaps{{
    {ToneMap::linear, "linear", "Linear"},
    {ToneMap::aces, "aces", "ACES (fitted)"},
    {ToneMap::agx, "agx", "AgX"},
    {ToneMap::neutral, "neutral", "Khronos PBR Neutral"},
}};
std::optional<ToneMap> tone_map_from_name(std::string_view name);

// Which part of the image is looked at.
enum class DisplayChannel : uint8_t { color, red, green, blue, alpha, luminance };

// Changing these never restarts a render.
struct DisplaySettings {
    float exposure_ev = 0;
    ToneMap tone_map = ToneMap::neutral;
    DisplayChannel channel = DisplayChannel::color;
};

// Linear display values in 0..1 of exposed scene-linear rgb; non-finite input gives magenta.
Rgb apply_tone_map(ToneMap tone_map, const Rgb& exposed);

// IEC 61966-2-1 in both directions, for values in 0..1.
float srgb_from_linear(float linear);
float linear_from_srgb(float encoded);

// The whole way to straight-alpha 8-bit sRGB (3 channels when the image is opaque).
ImageBytes develop(const ImageRgba& image, const DisplaySettings& display);

}  // namespace talbot
