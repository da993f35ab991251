// Factors of glTF's material extensions at a shading point: factor times texture, each channel as
// its extension says. Called where the factor is not zero.
#pragma once

#include "core/integrate/surface_interaction.h"

namespace talbot {

template <EffectSet kTier>
Vec4f eval_slot(const Scene& scene, const TextureSlot& slot, const SurfaceInteraction& si,
                TextureEncoding encoding) {
    Vec2f uv = si.uv[kTier.has(Effect::second_uv) ? slot.uv_set : 0];
    if constexpr (kTier.has(Effect::uv_transform)) uv = slot.apply(uv);
    return eval_texture(scene.textures()[slot.texture], uv, encoding);
}

// One channel of a linear texture; 1 where there is none.
template <EffectSet kTier>
float eval_channel(const Scene& scene, const TextureSlot& slot, const SurfaceInteraction& si,
                          int channel) {
    return slot.used() ? eval_slot<kTier>(scene, slot, si, TextureEncoding::linear)[channel] : 1.0f;
}

template <EffectSet kTier>
Rgb eval_color(const Scene& scene, const TextureSlot& slot, const SurfaceInteraction& si) {
    return slot.used() ? Rgb(eval_slot<kTier>(scene, slot, si, TextureEncoding::srgb)) : Rgb(1);
}

// Kept out of line: surfaces that have none of this should not be slowed by it.

// The normal of a normal map; false, and nothing written, where the texel is flat.
template <EffectSet kTier>
[[gnu::noinline]] bool mapped_normal(const Scene& scene, const TextureSlot& slot, float scale,
                          const SurfaceInteraction& si, Vec3f& normal) {
    const Vec4f texel = eval_slot<kTier>(scene, slot, si, TextureEncoding::linear);
    // 8-bit maps store the flat direction as 127 or 128 of 255: both mean zero.
    const auto decode = [](float x) {
        const float s = 2 * x - 1;
        return std::abs(s) <= kNormalMapStep ? 0.0f : s;
    };
    const float x = decode(texel.x) * scale;
    const float y = decode(texel.y) * scale * si.tangent_sign;
    const float z = 2 * texel.z - 1;
    if (x == 0 && y == 0) return false;
    Frame map = si.shading;
    if (si.tangent != Vec3f(0)) {
        map.t = si.tangent;
        map.b = cross(map.n, map.t);
    }
    normal = safe_normalize(map.to_world(Vec3f(x, y, z)), si.shading.n);
    return true;
}

template <EffectSet kTier>
[[gnu::noinline]] void eval_clearcoat(const Scene& scene, const Material& m, const SurfaceInteraction& si,
                           ShadingParams& params) {
    params.clearcoat = m.clearcoat_factor * eval_channel<kTier>(scene, m.clearcoat_texture, si, 0);
    const float roughness =
        m.clearcoat_roughness_factor * eval_channel<kTier>(scene, m.clearcoat_roughness_texture, si, 1);
    params.clearcoat_alpha = roughness * roughness;
    params.clearcoat_normal = si.front ? si.coat_normal : -si.coat_normal;
}

template <EffectSet kTier>
[[gnu::noinline]] void eval_sheen(const Scene& scene, const Material& m, const SurfaceInteraction& si,
                       ShadingParams& params) {
    params.sheen_color = m.sheen_color_factor * eval_color<kTier>(scene, m.sheen_color_texture, si);
    const float roughness =
        m.sheen_roughness_factor * eval_channel<kTier>(scene, m.sheen_roughness_texture, si, 3);
    params.sheen_alpha = roughness * roughness;
}

template <EffectSet kTier>
[[gnu::noinline]] void eval_diffuse_transmission(const Scene& scene, const Material& m,
                                      const SurfaceInteraction& si, ShadingParams& params) {
    params.diffuse_transmission =
        m.diffuse_transmission_factor * eval_channel<kTier>(scene, m.diffuse_transmission_texture, si, 3);
    params.diffuse_transmission_color = m.diffuse_transmission_color_factor *
                                        eval_color<kTier>(scene, m.diffuse_transmission_color_texture, si);
}

// The direction comes from the texture, turned by the rotation, in the plane of the shading normal.
template <EffectSet kTier>
[[gnu::noinline]] void eval_anisotropy(const Scene& scene, const Material& m, const SurfaceInteraction& si,
                            ShadingParams& params) {
    params.anisotropy = m.anisotropy_strength;
    Vec2f direction(1, 0);
    if (m.anisotropy_texture.used()) {
        const Vec4f texel = eval_slot<kTier>(scene, m.anisotropy_texture, si, TextureEncoding::linear);
        direction = Vec2f(2 * texel.x - 1, 2 * texel.y - 1);
        params.anisotropy *= texel.z;
    }
    const float s = std::sin(m.anisotropy_rotation);
    const float c = std::cos(m.anisotropy_rotation);
    const Vec2f turned(c * direction.x - s * direction.y, s * direction.x + c * direction.y);
    const Vec3f tangent = si.tangent != Vec3f(0) ? si.tangent : si.shading.t;
    const Vec3f bitangent = cross(si.shading.n, tangent) * si.tangent_sign;
    params.anisotropy_direction = turned.x * tangent + turned.y * bitangent;
}

template <EffectSet kTier>
[[gnu::noinline]] void eval_iridescence(const Scene& scene, const Material& m, const SurfaceInteraction& si,
                             ShadingParams& params) {
    params.iridescence = m.iridescence_factor * eval_channel<kTier>(scene, m.iridescence_texture, si, 0);
    params.iridescence_ior = m.iridescence_ior;
    const float t = eval_channel<kTier>(scene, m.iridescence_thickness_texture, si, 1);
    params.iridescence_thickness =
        m.iridescence_thickness_minimum +
        t * (m.iridescence_thickness_maximum - m.iridescence_thickness_minimum);
    if (!(params.iridescence_thickness > 0)) params.iridescence = 0;
}

}  // namespace talbot
