// How next-event estimation picks its light and its direction into the environment, each kind with
// its words for the command line and the panel. All of them are unbiased.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace talbot {

// tree: by what each light may send to the point. power: in proportion to what it sends in all.
// uniform: all alike, the environment one of them.
enum class LightSelection : uint8_t { tree, power, uniform };
struct LightSelectionInfo {
    LightSelection kind;
    std::string_view name;
    std::string_view label;
};
inline constexpr std::array<LightSelectionInfo, 3> kLightSelections{{
    {LightSelection::tree, "tree", "Tree"},
    {LightSelection::power, "power", "By power"},
    {LightSelection::uniform, "uniform", "Uniform"},
}};

// compensated: in proportion to what lies above the mean, for the rest is found by BSDF sampling
// (Karlik et al. 2019, "MIS compensation"). luminance: in proportion to luminance. none: by BSDF
// sampling alone.
enum class EnvironmentSampling : uint8_t { compensated, luminance, none };
struct EnvironmentSamplingInfo {
    EnvironmentSampling kind;
    std::string_view name;
    std::string_view label;
};
inline constexpr std::array<EnvironmentSamplingInfo, 3> kEnvironmentSamplings{{
    {EnvironmentSampling::compensated, "compensated", "Above the mean"},
    {EnvironmentSampling::luminance, "luminance", "By luminance"},
    {EnvironmentSampling::none, "none", "Not sampled"},
}};

struct LightSampling {
    LightSelection selection = LightSelection::tree;
    EnvironmentSampling environment = EnvironmentSampling::compensated;

    bool operator==(const LightSampling&) const = default;
};

}  // namespace talbot
