// The compiled kernel tiers, smallest first. Each names the effects that its template is compiled
// with; effects that cost only a few instructions a path are part of every tier and tested at run
// time.
#pragma once

#include <array>
#include <string_view>

#include "core/scene/effects.h"

namespace talbot {

inline constexpr EffectSet kOncePerPathEffects =
    (Effect::single_sided | Effect::environment) | Effect::environment_image |
    Effect::punctual_lights | Effect::emissive_meshes | Effect::many_lights |
    Effect::analytic_spheres | Effect::instancing | Effect::depth_of_field | Effect::motion;

// Diffuse surfaces without textures.
inline constexpr EffectSet kMatteTier = kOncePerPathEffects;
// + GGX reflection, still by factors only.
inline constexpr EffectSet kGlossyTier = kMatteTier | Effect::glossy | Effect::specular;
// + every texture, opaque.
inline constexpr EffectSet kTexturedTier = kGlossyTier | Effect::base_color_texture |
                                           Effect::metallic_roughness_texture | Effect::normal_map |
                                           Effect::emissive_texture | Effect::vertex_color |
                                           Effect::second_uv | Effect::uv_transform;
// + coverage, transmission, volumes and unlit surfaces.
inline constexpr EffectSet kTransmissiveTier =
    kTexturedTier | Effect::alpha_mask | Effect::alpha_blend | Effect::transmission |
    Effect::thin_wall | Effect::volume_absorption | Effect::unlit;
// Everything: + the layers and lobes of the material extensions.
inline constexpr EffectSet kFullTier = EffectSet::all();

struct TierInfo {
    EffectSet effects;
    std::string_view name;
};
inline constexpr std::array<TierInfo, 5> kTiers{{
    {kMatteTier, "matte"},
    {kGlossyTier, "glossy"},
    {kTexturedTier, "textured"},
    {kTransmissiveTier, "transmissive"},
    {kFullTier, "full"},
}};
static_assert(kTiers.back().effects == EffectSet::all(), "the last tier covers every scene");

template <std::size_t n>
constexpr std::size_t first_cover(const std::array<TierInfo, n>& tiers, EffectSet effects) {
    std::size_t tier = 0;
    while (!tiers[tier].effects.covers(effects)) ++tier;
    return tier;
}

// Index of the first tier that covers the effects.
constexpr std::size_t smallest_tier(EffectSet effects) {
    return first_cover(kTiers, effects);
}

// Effects of materials and meshes, which the shading of one surface reads; the others belong to
// rays, to volumes and to the scene.
inline constexpr EffectSet kSurfaceEffects{(kFullTier.bits & ~kOncePerPathEffects.bits) &
                                           ~(Effect::alpha_mask | Effect::alpha_blend |
                                             Effect::volume_absorption | Effect::scattering_medium)
                                                .bits};

// Shading compiled within each kernel for surfaces that ask for less than it has: a surface is
// shaded by the first that covers it. None goes beyond a kernel that comes before.
inline constexpr std::array<TierInfo, 7> kSurfaceTiers{{
    {kGlossyTier & kSurfaceEffects, "glossy"},
    {kTexturedTier & kSurfaceEffects, "textured"},
    {kTransmissiveTier & kSurfaceEffects, "transmissive"},
    {(kTexturedTier & kSurfaceEffects) | Effect::clearcoat, "coated"},
    {(kTexturedTier & kSurfaceEffects) | Effect::sheen, "sheen"},
    {(kTexturedTier & kSurfaceEffects) | Effect::anisotropy | Effect::iridescence, "film"},
    {kFullTier & kSurfaceEffects, "full"},
}};

constexpr std::size_t smallest_surface_tier(EffectSet effects) {
    return first_cover(kSurfaceTiers, effects & kSurfaceEffects);
}

// What shading of a surface tier is compiled with in a kernel.
constexpr EffectSet surface_code(EffectSet kernel, std::size_t surface_tier) {
    return kernel & (kSurfaceTiers[surface_tier].effects | EffectSet{~kSurfaceEffects.bits});
}

}  // namespace talbot
