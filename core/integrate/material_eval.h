// A material's factors at a shading point: glTF factors times textures times vertex colour, and the
// normal map; textures filtered where a footprint is given.
#pragma once

#include <type_traits>

#include "core/integrate/extension_eval.h"
#include "core/integrate/surface_interaction.h"

namespace talbot {

// Base colour and alpha.
template <EffectSet kTier, typename Footprint = Unfiltered>
Vec4f eval_base_color(const Scene& scene, const Material& material, const SurfaceInteraction& si,
                      Footprint footprint = {}) {
    Vec4f color = material.base_color_factor;
    if constexpr (kTier.has(Effect::vertex_color)) color *= si.color;
    if constexpr (kTier.has(Effect::base_color_texture)) {
        if (material.base_color_texture.used()) {
            auto at = texture_point(si, footprint);
            if constexpr (std::is_same_v<Footprint, TextureFootprint>)
                at.by_alpha = material.alpha_mode != AlphaMode::opaque;
            color *=
                eval_slot<kTier>(scene, material.base_color_texture, at, TextureEncoding::srgb);
        }
    }
    return color;
}

// Factors of the extensions' layers, which know no texture where their factor is zero.
template <EffectSet kTier, typename Footprint>
void eval_layers(const Scene& scene, const Material& material, const SurfaceInteraction& si,
                 Footprint footprint, ShadingParams& params) {
    [[maybe_unused]] const auto uv = texture_point(si, footprint);
    if constexpr (kTier.has(Effect::clearcoat)) {
        if (material.clearcoat_factor > 0) {
            const CoatFactors coat = eval_clearcoat<kTier>(scene, material, uv);
            params.clearcoat = coat.factor;
            params.clearcoat_alpha = coat.alpha;
            params.clearcoat_normal = si.front ? si.coat_normal : -si.coat_normal;
        }
    }
    if constexpr (kTier.has(Effect::sheen)) {
        if (material.has_sheen()) {
            const SheenFactors sheen = eval_sheen<kTier>(scene, material, uv);
            params.sheen_color = sheen.color;
            params.sheen_alpha = sheen.alpha;
        }
    }
    if constexpr (kTier.has(Effect::diffuse_transmission)) {
        if (material.diffuse_transmission_factor > 0) [[unlikely]] {
            const ThroughFactors through = eval_diffuse_transmission<kTier>(scene, material, uv);
            params.diffuse_transmission = through.factor;
            params.diffuse_transmission_color = through.color;
        }
    }
    if constexpr (kTier.has(Effect::anisotropy)) {
        if (material.anisotropy_strength > 0) [[unlikely]] {
            const AnisotropyFactors stretch =
                eval_anisotropy<kTier>(scene, material, uv, si.shading.n, si.shading.t, si.tangent);
            params.anisotropy = stretch.strength;
            params.anisotropy_direction = stretch.direction;
        }
    }
    if constexpr (kTier.has(Effect::iridescence)) {
        if (material.iridescence_factor > 0) [[unlikely]] {
            const FilmFactors film = eval_iridescence<kTier>(scene, material, uv);
            params.iridescence = film.factor;
            params.iridescence_ior = material.iridescence_ior;
            params.iridescence_thickness = film.thickness;
        }
    }
}

template <EffectSet kTier, typename Footprint = Unfiltered>
ShadingParams eval_shading_params(const Scene& scene, const Material& material,
                                  const SurfaceInteraction& si, Footprint footprint = {}) {
    ShadingParams params;
    [[maybe_unused]] const auto uv = texture_point(si, footprint);
    params.base_color = Rgb(eval_base_color<kTier>(scene, material, si, footprint));
    params.metallic = material.metallic_factor;
    float roughness = material.roughness_factor;
    if constexpr (kTier.has(Effect::metallic_roughness_texture)) {
        if (material.metallic_roughness_texture.used()) {
            const Vec4f texel = eval_slot<kTier>(scene, material.metallic_roughness_texture, uv,
                                                 TextureEncoding::linear);
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
                eval_slot<kTier>(scene, material.specular_texture, uv, TextureEncoding::linear).w;
        }
        if (material.specular_color_texture.used()) {
            params.specular_color *= Rgb(eval_slot<kTier>(scene, material.specular_color_texture,
                                                          uv, TextureEncoding::srgb));
        }
    }
    if constexpr (kTier.has(Effect::transmission)) {
        params.transmission = material.transmission_factor;
        if (material.transmission_texture.used()) {
            params.transmission *=
                eval_slot<kTier>(scene, material.transmission_texture, uv, TextureEncoding::linear)
                    .x;
        }
    }
    if constexpr (kTier.has(Effect::transmission) || kTier.has(Effect::diffuse_transmission)) {
        params.thin = !(material.thickness_factor > 0);
    }
    eval_layers<kTier>(scene, material, si, footprint, params);
    return params;
}

// Whether a material asks for tangents: for normal maps, or to stretch highlights.
template <EffectSet kTier>
bool needs_tangent(const Material& m) {
    return (kTier.has(Effect::normal_map) && m.normal_texture.used()) ||
           (kTier.has(Effect::clearcoat) && m.clearcoat_normal_texture.used()) ||
           (kTier.has(Effect::anisotropy) && m.anisotropy_strength > 0);
}

// Turns the shading frame by the normal map, and notes the tangent and the clear coat's own normal.
// A flat texel leaves the frame untouched.
template <EffectSet kTier, typename Footprint = Unfiltered>
void apply_normal_map(const Scene& scene, const Material& material, SurfaceInteraction& si,
                      Footprint footprint = {}) {
    if constexpr (kTier.has(Effect::clearcoat)) si.coat_normal = si.shading.n;
    if constexpr (kTier.has(Effect::normal_map) || kTier.has(Effect::clearcoat) ||
                  kTier.has(Effect::anisotropy)) {
        // Unlikely, so that what is in registers is saved for the call there and nowhere else.
        if (needs_tangent<kTier>(material)) [[unlikely]] {
            const MappedNormals mapped =
                map_normals<kTier>(scene, material, si.id, si.barycentric, si.n_geometric,
                                   si.shading.n, texture_point(si, footprint));
            si.tangent = mapped.tangent;
            if constexpr (kTier.has(Effect::clearcoat)) si.coat_normal = mapped.coat;
            if (kTier.has(Effect::normal_map) && mapped.surface != si.shading.n)
                si.shading = Frame::from_normal(mapped.surface);
        }
    }
}

}  // namespace talbot
