// The kinds of sampler, pixel filter and texture filtering, each with its words for the command
// line and the panel.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace talbot {

// In the order of the table below.
enum class SamplerKind : uint8_t { sobol, independent, stratified, halton, zsobol };
struct SamplerInfo {
    SamplerKind kind;
    std::string_view name;
    std::string_view label;
};
inline constexpr std::array<SamplerInfo, 5> kSamplers{{
    {SamplerKind::sobol, "sobol", "Sobol' (Owen-scrambled)"},
    {SamplerKind::independent, "independent", "Independent"},
    {SamplerKind::stratified, "stratified", "Stratified (multi-jittered)"},
    {SamplerKind::halton, "halton", "Halton (Owen-scrambled)"},
    {SamplerKind::zsobol, "zsobol", "Sobol' (blue noise)"},
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

// BIAS: cones blur textures by what a ray's cone covers.
enum class TextureFiltering : uint8_t { none, cones };
struct TextureFilteringInfo {
    TextureFiltering kind;
    std::string_view name;
    std::string_view label;
};
inline constexpr std::array<TextureFilteringInfo, 2> kTextureFilterings{{
    {TextureFiltering::none, "none", "None"},
    {TextureFiltering::cones, "cones", "Ray cones (biased)"},
}};

}  // namespace talbot
