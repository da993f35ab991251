// A glTF material as plain data: every factor under its glTF name, with glTF's default. Edited as a
// value by the viewer.
#pragma once

#include <cstdint>
#include <limits>
#include <string>

#include "core/scene/texture.h"

namespace talbot {

enum class AlphaMode : uint8_t { opaque, mask, blend };

// The least isotropic scattering that is told from none.
inline constexpr float kLargestAnisotropy = 1 - 0x1p-16f;

struct Material {
    std::string name;

    // pbrMetallicRoughness
    Vec4f base_color_factor{1, 1, 1, 1};  // linear RGB and alpha
    TextureSlot base_color_texture;       // sRGB, A = alpha
    float metallic_factor = 1;
    float roughness_factor = 1;              // perceptual; GGX alpha = roughness^2
    TextureSlot metallic_roughness_texture;  // G = roughness, B = metallic

    TextureSlot normal_texture;
    float normal_scale = 1;

    Rgb emissive_factor{
        0};  // times emissive_strength: radiance in nits, front side only unless double_sided
    float emissive_strength = 1;   // KHR_materials_emissive_strength
    TextureSlot emissive_texture;  // sRGB

    AlphaMode alpha_mode = AlphaMode::opaque;
    float alpha_cutoff = 0.5f;
    bool double_sided = false;
    bool unlit = false;  // KHR_materials_unlit: emits base colour, neither lights nor is lit

    float ior = 1.5f;  // KHR_materials_ior; 0 means Fresnel 1 everywhere, else >= 1

    float specular_factor = 1;           // KHR_materials_specular
    TextureSlot specular_texture;        // A
    Rgb specular_color_factor{1};        // may exceed 1
    TextureSlot specular_color_texture;  // sRGB

    float transmission_factor = 0;     // KHR_materials_transmission
    TextureSlot transmission_texture;  // R

    float thickness_factor = 0;  // KHR_materials_volume; 0 = thin-walled, > 0 = closed volume
    Rgb attenuation_color{
        1};  // white light's colour after attenuation_distance metres of world length
    float attenuation_distance = std::numeric_limits<float>::infinity();

    Rgb multiscatter_color{
        0};  // KHR_materials_volume_scatter: what a thick body returns; volumes only
    float scatter_anisotropy = 0;  // Henyey-Greenstein's g, in (-1, 1)
    float nested_priority =
        0;  // extras.nestedPriority: where volumes overlap, the highest fills the space

    float dispersion = 0;  // KHR_materials_dispersion: 20 / Abbe number; volumes only

    float diffuse_transmission_factor = 0;     // KHR_materials_diffuse_transmission
    TextureSlot diffuse_transmission_texture;  // A
    Rgb diffuse_transmission_color_factor{1};
    TextureSlot diffuse_transmission_color_texture;  // sRGB

    float clearcoat_factor = 0;     // KHR_materials_clearcoat
    TextureSlot clearcoat_texture;  // R
    float clearcoat_roughness_factor = 0;
    TextureSlot clearcoat_roughness_texture;  // G
    TextureSlot clearcoat_normal_texture;
    float clearcoat_normal_scale = 1;

    Rgb sheen_color_factor{0};        // KHR_materials_sheen
    TextureSlot sheen_color_texture;  // sRGB
    float sheen_roughness_factor = 0;
    TextureSlot sheen_roughness_texture;  // A

    float anisotropy_strength = 0;   // KHR_materials_anisotropy
    float anisotropy_rotation = 0;   // radians, from the tangent towards the bitangent
    TextureSlot anisotropy_texture;  // RG = direction, B = strength

    float iridescence_factor = 0;     // KHR_materials_iridescence
    TextureSlot iridescence_texture;  // R
    float iridescence_ior = 1.3f;
    float iridescence_thickness_minimum = 100;  // nanometres, where the texture is 0
    float iridescence_thickness_maximum = 400;  // where it is 1, or where there is none
    TextureSlot iridescence_thickness_texture;  // G

    bool operator==(const Material&) const = default;

    bool is_emissive() const {
        return emissive_strength > 0 &&
               (emissive_factor.x > 0 || emissive_factor.y > 0 || emissive_factor.z > 0);
    }
    // Whether light can pass its surface into a closed volume.
    bool is_volume() const {
        return (transmission_factor > 0 || diffuse_transmission_factor > 0) && thickness_factor > 0;
    }
    // Whether the volume scatters light inside. Without attenuation there is nothing to scatter.
    bool scatters() const {
        return is_volume() && attenuation_distance < std::numeric_limits<float>::infinity() &&
               (multiscatter_color.x > 0 || multiscatter_color.y > 0 || multiscatter_color.z > 0) &&
               attenuation_color != Rgb(1);
    }
    bool has_sheen() const {
        return sheen_color_factor.x > 0 || sheen_color_factor.y > 0 || sheen_color_factor.z > 0;
    }
};

// Every texture of a material.
inline constexpr TextureSlot Material::*kTextureSlots[] = {
    &Material::base_color_texture,
    &Material::metallic_roughness_texture,
    &Material::normal_texture,
    &Material::emissive_texture,
    &Material::specular_texture,
    &Material::specular_color_texture,
    &Material::transmission_texture,
    &Material::diffuse_transmission_texture,
    &Material::diffuse_transmission_color_texture,
    &Material::clearcoat_texture,
    &Material::clearcoat_roughness_texture,
    &Material::clearcoat_normal_texture,
    &Material::sheen_color_texture,
    &Material::sheen_roughness_texture,
    &Material::anisotropy_texture,
    &Material::iridescence_texture,
    &Material::iridescence_thickness_texture,
};

}  // namespace talbot
