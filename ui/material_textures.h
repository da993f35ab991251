// The textures of a material, under their glTF names.
#pragma once

#include "core/scene/material.h"

namespace talbot {

struct MaterialTexture {
    const char* name;
    TextureSlot Material::*slot;
};

inline constexpr MaterialTexture kMaterialTextures[] = {
    {"baseColorTexture", &Material::base_color_texture},
    {"metallicRoughnessTexture", &Material::metallic_roughness_texture},
    {"normalTexture", &Material::normal_texture},
    {"emissiveTexture", &Material::emissive_texture},
    {"specularTexture", &Material::specular_texture},
    {"specularColorTexture", &Material::specular_color_texture},
    {"transmissionTexture", &Material::transmission_texture},
    {"diffuseTransmissionTexture", &Material::diffuse_transmission_texture},
    {"diffuseTransmissionColorTexture", &Material::diffuse_transmission_color_texture},
    {"clearcoatTexture", &Material::clearcoat_texture},
    {"clearcoatRoughnessTexture", &Material::clearcoat_roughness_texture},
    {"clearcoatNormalTexture", &Material::clearcoat_normal_texture},
    {"sheenColorTexture", &Material::sheen_color_texture},
    {"sheenRoughnessTexture", &Material::sheen_roughness_texture},
    {"anisotropyTexture", &Material::anisotropy_texture},
    {"iridescenceTexture", &Material::iridescence_texture},
    {"iridescenceThicknessTexture", &Material::iridescence_thickness_texture},
};

}  // namespace talbot
