// Effects: what a scene can ask of the renderer. An EffectSet says which of them can change a
// pixel; a kernel tier is compiled for an EffectSet; the smallest tier that covers the scene runs.
// The table below is the one list of them all.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace talbot {

enum class Effect : uint8_t {
    base_color_texture,
    metallic_roughness_texture,
    normal_map,
    emissive_texture,
    vertex_color,
    second_uv,
    uv_transform,
    glossy,
    specular,
    alpha_mask,
    alpha_blend,
    single_sided,
    transmission,
    thin_wall,
    volume_absorption,
    scattering_medium,
    unlit,
    diffuse_transmission,
    clearcoat,
    sheen,
    anisotropy,
    iridescence,
    dispersion,
    environment,
    environment_image,
    punctual_lights,
    emissive_meshes,
    many_lights,
    analytic_spheres,
    instancing,
    depth_of_field,
    motion,
    count
};

inline constexpr std::size_t kEffectCount = static_cast<std::size_t>(Effect::count);

struct EffectInfo {
    Effect effect;
    std::string_view name;   // the word of the command line and of files
    std::string_view label;  // the words of the panel
};

inline constexpr std::array<EffectInfo, kEffectCount> kEffects{{
    {Effect::base_color_texture, "base_color_texture", "Base colour textures"},
    {Effect::metallic_roughness_texture, "metallic_roughness_texture",
     "Metallic-roughness textures"},
    {Effect::normal_map, "normal_map", "Normal maps"},
    {Effect::emissive_texture, "emissive_texture", "Emissive textures"},
    {Effect::vertex_color, "vertex_color", "Vertex colours"},
    {Effect::second_uv, "second_uv", "Second UV set"},
    {Effect::uv_transform, "uv_transform", "UV transforms"},
    {Effect::glossy, "glossy", "Glossy reflection"},
    {Effect::specular, "specular", "Specular extension"},
    {Effect::alpha_mask, "alpha_mask", "Alpha mask"},
    {Effect::alpha_blend, "alpha_blend", "Alpha blend"},
    {Effect::single_sided, "single_sided", "Single-sided faces"},
    {Effect::transmission, "transmission", "Transmission"},
    {Effect::thin_wall, "thin_wall", "Thin walls"},
    {Effect::volume_absorption, "volume_absorption", "Volume absorption"},
    {Effect::scattering_medium, "scattering_medium", "Scattering media"},
    {Effect::unlit, "unlit", "Unlit materials"},
    {Effect::diffuse_transmission, "diffuse_transmission", "Diffuse transmission"},
    {Effect::clearcoat, "clearcoat", "Clear coats"},
    {Effect::sheen, "sheen", "Sheen"},
    {Effect::anisotropy, "anisotropy", "Anisotropy"},
    {Effect::iridescence, "iridescence", "Iridescence"},
    {Effect::dispersion, "dispersion", "Dispersion"},
    {Effect::environment, "environment", "Environment light"},
    {Effect::environment_image, "environment_image", "Environment image"},
    {Effect::punctual_lights, "punctual_lights", "Punctual lights"},
    {Effect::emissive_meshes, "emissive_meshes", "Emissive surfaces"},
    {Effect::many_lights, "many_lights", "Many lights"},
    {Effect::analytic_spheres, "analytic_spheres", "Analytic spheres"},
    {Effect::instancing, "instancing", "Instancing"},
    {Effect::depth_of_field, "depth_of_field", "Depth of field"},
    {Effect::motion, "motion", "Motion blur"},
}};

// A set of effects; usable as a template argument.
struct EffectSet {
    uint64_t bits = 0;

    static constexpr uint64_t bit(Effect effect) {
        return uint64_t{1} << static_cast<unsigned>(effect);
    }
    static constexpr EffectSet all() { return EffectSet{(uint64_t{1} << kEffectCount) - 1}; }

    constexpr bool has(Effect effect) const { return (bits & bit(effect)) != 0; }
    constexpr void add(Effect effect) { bits |= bit(effect); }
    constexpr void remove(Effect effect) { bits &= ~bit(effect); }
    constexpr bool covers(EffectSet other) const { return (other.bits & ~bits) == 0; }
    constexpr EffectSet operator|(EffectSet other) const { return EffectSet{bits | other.bits}; }
    constexpr EffectSet operator&(EffectSet other) const { return EffectSet{bits & other.bits}; }
    constexpr bool operator==(const EffectSet&) const = default;
};

constexpr EffectSet operator|(Effect a, Effect b) {
    return EffectSet{EffectSet::bit(a) | EffectSet::bit(b)};
}
constexpr EffectSet operator|(EffectSet a, Effect b) {
    return EffectSet{a.bits | EffectSet::bit(b)};
}

constexpr const EffectInfo& effect_info(Effect effect) {
    return kEffects[static_cast<std::size_t>(effect)];
}
std::optional<Effect> effect_from_name(std::string_view name);

// What a scene asks for, and which part of it asks (empty where the effect is absent).
struct EffectReport {
    EffectSet active;
    std::array<std::string, kEffectCount> witness;

    void note(Effect effect, const std::string& who) {
        if (active.has(effect)) return;
        active.add(effect);
        witness[static_cast<std::size_t>(effect)] = who;
    }
};

class Scene;
struct Camera;
struct Material;

// The effects that can change a pixel of this scene seen by this camera, with their witnesses.
EffectReport analyse_effects(const Scene& scene, const Camera& camera);

// Adds what a folded material asks for; `who` becomes the witness.
void note_material(EffectReport& report, const Material& material, const std::string& who);

// What a material by itself, folded (effects_fold.h), asks of the shading of a surface.
EffectSet material_effects(const Material& material);

}  // namespace talbot
