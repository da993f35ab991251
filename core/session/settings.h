// What a render is made with. RenderSettings restart the image when they change; DisplaySettings (film/tone_map.h) never do.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

#include "core/scene/effects.h"

namespace talbot {

enum class SamplerKind : uint8_t { sobol, independent };
struct SamplerInfo {
    SamplerKind kind;
    std::string_view name;
    std::string_view label;
};
inline constexpr std::array<SamplerInfo, 2> kSamplers{{
    {SamplerKind::sobol, "sobol", "Sobol' (Owen-scrambled)"},
    {SamplerKind::independent, "independent", "Independent"},
}};

enum class FilterKind : uint8_t { box, blackman_harris };
struct FilterInfo {
    FilterKind kind;
    std::string_view name;
    std::string_view label;
};
inline constexpr std::array<FilterInfo, 2> kFilters{{
    {FilterKind::box, "box", "Box (1 px)"},
    {FilterKind::blackman_harris, "blackman-harris", "Blackman-Harris (3.3 px)"},
}};

struct RenderSettings {
    uint32_t width = 960;
    uint32_t height = 540;
    uint32_t max_depth = 64;       // scattering events on a path; BIAS: light beyond it is missing
    SamplerKind sampler = SamplerKind::sobol;
    FilterKind filter = FilterKind::box;
    bool russian_roulette = true;
    bool next_event_estimation = true;
    bool transparent_background = false;
    uint64_t seed = 0;
    uint64_t first_sample = 0;     // sample indices start here
    EffectSet forced_on{};         // added to what the scene asks for: costs time, changes nothing
    uint32_t tile_size = 32;       // pixels; changes no pixel

    bool operator==(const RenderSettings&) const = default;
};

}  // namespace talbot
