// A material's factors at a shading point: glTF factors times textures times vertex colour, and the
// normal map.
#pragma once

#include "core/integrate/surface_interaction.h"

namespace talbot {

inline Vec4f eval_slot(const Scene& scene, const TextureSlot& slot, const SurfaceInteraction& si,
                       TextureEncoding encoding) {
    return eval_texture(scene.textures()[slot.texture], slot.apply(si.uv[slot.uv_set]), encoding);
}

// Base colour and alpha.
template <EffectSet kTier>
Vec4f eval_base_color(const Scene& scene, const Material& material, const SurfaceInteraction& si) {
    Vec4f color = material.base_color_factor;
    if constexpr (kTier.has(Effect::vertex_color)) color *= si.color;
    if constexpr (kTier.has(Effect::base_color_texture)) {
        if (material.base_color_texture.used()) {
            color *= eval_slot(scene, material.base_color_texture, si, TextureEncoding::srgb);
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
                eval_slot(scene, material.metallic_roughness_texture, si, TextureEncoding::linear);
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
                eval_slot(scene, material.specular_texture, si, TextureEncoding::linear).w;
        }
        if (material.specular_color_texture.used()) {
            params.specular_color *=
                Rgb(eval_slot(scene, material.specular_color_texture, si, TextureEncoding::srgb));
        }
    }
    if constexpr (kTier.has(Effect::transmission)) {
        params.transmission = material.transmission_factor;
        if (material.transmission_texture.used()) {
            params.transmission *=
                eval_slot(scene, material.transmission_texture, si, TextureEncoding::linear).x;
        }
        params.thin = !(material.thickness_factor > 0);
    }
    return params;
}

// Turns the shading frame by the normal map. A flat texel leaves it untouched.
template <EffectSet kTier>
void apply_normal_map(const Scene& scene, const Material& material, SurfaceInteraction& si) {
    if constexpr (kTier.has(Effect::normal_map)) {
        if (!material.normal_texture.used()) return;
        const Vec4f texel = eval_slot(scene, material.normal_texture, si, TextureEncoding::linear);
        // 8-bit maps store the flat direction as 127 or 128 of 255: both mean zero.
        const auto decode = [](float x) {
            const float s = 2 * x - 1;
            return std::abs(s) <= kNormalMapStep ? 0.0f : s;
        };
        const float x = decode(texel.x) * material.normal_scale;
        const float y = decode(texel.y) * material.normal_scale * si.tangent_sign;
        const float z = 2 * texel.z - 1;
        if (x == 0 && y == 0) return;
        Frame map = si.shading;
        if (si.tangent != Vec3f(0)) {
            map.t = si.tangent;
            map.b = cross(map.n, map.t);
        }
        si.shading = Frame::from_normal(safe_normalize(map.to_world(Vec3f(x, y, z)), si.shading.n));
    }
}

// Absorption per metre that gives white light the material's attenuation colour after its
// attenuation distance.
inline Rgb absorption(const Material& material) {
    Rgb sigma(0);
    if (!is_finite(material.attenuation_distance) || !(material.attenuation_distance > 0))
        return sigma;
    for (int c = 0; c < 3; ++c) {
        const float color = clamp01(material.attenuation_color[c]);
        sigma[c] = color > 0 ? -std::log(color) / material.attenuation_distance : kInfinity;
    }
    return sigma;
}

// Beer-Lambert transmittance over a distance >= 0; a channel without absorption keeps 1 exactly.
inline Rgb transmittance(const Rgb& sigma, float distance) {
    Rgb t(1);
    for (int c = 0; c < 3; ++c) {
        if (sigma[c] > 0) t[c] = distance > 0 ? std::exp(-sigma[c] * distance) : 1.0f;
    }
    return t;
}

}  // namespace talbot
