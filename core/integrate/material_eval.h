// A material's factors at a shading point: glTF factors times textures times vertex colour, and the
// normal map.
#pragma once

#include "core/integrate/extension_eval.h"
#include "core/integrate/surface_interaction.h"

namespace talbot {

// Base colour and alpha.
template <EffectSet kTier>
Vec4f eval_base_color(const Scene& scene, const Material& material, const SurfaceInteraction& si) {
    Vec4f color = material.base_color_factor;
    if constexpr (kTier.has(Effect::vertex_color)) color *= si.color;
    if constexpr (kTier.has(Effect::base_color_texture)) {
        if (material.base_color_texture.used()) {
            color *= eval_slot<kTier>(scene, material.base_color_texture, si, TextureEncoding::srgb);
        }
    }
    return color;
}

template <EffectSet kTier>
ShadingParams eval_shading_params(const Scene& scene, const Material& material,
                                  const SurfaceInteraction& si) {
    ShadingParams params;
    params.base_color = Rgb(eval_base_color<kTier>(scene, material, si));
    params.metallic = material.metallic_factor;
    float roughness = material.roughness_factor;
    if constexpr (kTier.has(Effect::metallic_roughness_texture)) {
        if (material.metallic_roughness_texture.used()) {
            const Vec4f texel =
                eval_slot<kTier>(scene, material.metallic_roughness_texture, si, TextureEncoding::linear);
            roughness *= texel.y;
            params.metallic *= texel.z;
        }
    }
    params.alpha = roughness * roughness;
    params.specular = material.specular_factor;
    params.ior = material.ior;
    if constexpr (kTier.has(Effect::specular)) {
        params.specular_color = material.specular_color_factor;
        if (material.specular_texture.used()) {
            params.specular *=
                eval_slot<kTier>(scene, material.specular_texture, si, TextureEncoding::linear).w;
        }
        if (material.specular_color_texture.used()) {
            params.specular_color *=
                Rgb(eval_slot<kTier>(scene, material.specular_color_texture, si, TextureEncoding::srgb));
        }
    }
    if constexpr (kTier.has(Effect::transmission)) {
        params.transmission = material.transmission_factor;
        if (material.transmission_texture.used()) {
            params.transmission *=
                eval_slot<kTier>(scene, material.transmission_texture, si, TextureEncoding::linear).x;
        }
    }
    if constexpr (kTier.has(Effect::transmission) || kTier.has(Effect::diffuse_transmission)) {
        params.thin = !(material.thickness_factor > 0);
    }
    if constexpr (kTier.has(Effect::clearcoat)) {
        if (material.clearcoat_factor > 0) eval_clearcoat<kTier>(scene, material, si, params);
    }
    if constexpr (kTier.has(Effect::sheen)) {
        if (material.has_sheen()) eval_sheen<kTier>(scene, material, si, params);
    }
    if constexpr (kTier.has(Effect::diffuse_transmission)) {
        if (material.diffuse_transmission_factor > 0)
            eval_diffuse_transmission<kTier>(scene, material, si, params);
    }
    if constexpr (kTier.has(Effect::anisotropy)) {
        if (material.anisotropy_strength > 0) eval_anisotropy<kTier>(scene, material, si, params);
    }
    if constexpr (kTier.has(Effect::iridescence)) {
        if (material.iridescence_factor > 0) eval_iridescence<kTier>(scene, material, si, params);
    }
    return params;
}

// Turns the shading frame by the normal map, and before that notes the clear coat's own normal. A
// flat texel leaves the frame untouched.
template <EffectSet kTier>
void apply_normal_map(const Scene& scene, const Material& material, SurfaceInteraction& si) {
    if constexpr (kTier.has(Effect::clearcoat)) {
        si.coat_normal = si.shading.n;
        if (material.clearcoat_factor > 0 && material.clearcoat_normal_texture.used()) {
            mapped_normal<kTier>(scene, material.clearcoat_normal_texture, material.clearcoat_normal_scale,
                          si, si.coat_normal);
        }
    }
    if constexpr (kTier.has(Effect::normal_map)) {
        if (!material.normal_texture.used()) return;
        Vec3f n(0);
        if (mapped_normal<kTier>(scene, material.normal_texture, material.normal_scale, si, n))
            si.shading = Frame::from_normal(n);
    }
}

}  // namespace talbot
