// Factors of glTF's material extensions at a shading point: factor times texture, each channel as
// its extension says. Called where the factor is not zero.
#pragma once

#include "core/integrate/texture_footprint.h"

namespace talbot {

// Point: UvSets, or a FilteredPoint.
template <EffectSet kTier, typename Point>
Vec4f eval_slot(const Scene& scene, const TextureSlot& slot, Point at, TextureEncoding encoding) {
    Vec2f uv = at.first;
    if constexpr (kTier.has(Effect::second_uv)) {
        if (slot.uv_set != 0) uv = at.second;
    }
    if constexpr (kTier.has(Effect::uv_transform)) uv = slot.apply(uv);
    return lookup(scene, slot, at, uv, encoding);
}

// One channel of a linear texture; 1 where there is none.
template <EffectSet kTier, typename Point>
float eval_channel(const Scene& scene, const TextureSlot& slot, Point uv, int channel) {
    return slot.used() ? eval_slot<kTier>(scene, slot, uv, TextureEncoding::linear)[channel] : 1.0f;
}

template <EffectSet kTier, typename Point>
Rgb eval_color(const Scene& scene, const TextureSlot& slot, Point uv) {
    return slot.used() ? Rgb(eval_slot<kTier>(scene, slot, uv, TextureEncoding::srgb)) : Rgb(1);
}

// What follows is kept out of line and takes and returns values: surfaces that have none of it
// should not be slowed by it.

// The normal of a normal map about n; n itself where the texel is flat.
template <EffectSet kTier, typename Point>
Vec3f mapped_normal(const Scene& scene, const TextureSlot& slot, float scale, Point uv,
                    const Vec3f& n, const Tangent& tangent) {
    const Vec4f texel = eval_slot<kTier>(scene, slot, uv, TextureEncoding::linear);
    // 8-bit maps store the flat direction as 127 or 128 of 255: both mean zero.
    const auto decode = [](float x) {
        const float s = 2 * x - 1;
        return std::abs(s) <= kNormalMapStep ? 0.0f : s;
    };
    const float x = decode(texel.x) * scale;
    const float y = decode(texel.y) * scale * tangent.sign;
    const float z = 2 * texel.z - 1;
    if (x == 0 && y == 0) return n;
    Frame map = Frame::from_normal(n);
    if (tangent.direction != Vec3f(0)) {
        map.t = tangent.direction;
        map.b = cross(map.n, map.t);
    }
    return safe_normalize(map.to_world(Vec3f(x, y, z)), n);
}

// What a material's normal maps make of the normal n of a surface.
struct MappedNormals {
    Vec3f surface{0}, coat{0};
    Tangent tangent;
};
template <EffectSet kTier, typename Point>
[[gnu::noinline]] MappedNormals map_normals(const Scene& scene, const Material& m, PrimitiveId id,
                                            Vec2f barycentric, Vec3f n_geometric, Vec3f n,
                                            Point uv) {
    const Tangent tangent = tangent_at(scene, id, barycentric, n_geometric, n);
    MappedNormals result{n, n, tangent};
    if (kTier.has(Effect::clearcoat) && m.clearcoat_factor > 0 && m.clearcoat_normal_texture.used())
        result.coat = mapped_normal<kTier>(scene, m.clearcoat_normal_texture,
                                           m.clearcoat_normal_scale, uv, n, tangent);
    if (kTier.has(Effect::normal_map) && m.normal_texture.used())
        result.surface =
            mapped_normal<kTier>(scene, m.normal_texture, m.normal_scale, uv, n, tangent);
    return result;
}

struct CoatFactors {
    float factor = 0;
    float alpha = 0;
};
template <EffectSet kTier, typename Point>
[[gnu::noinline]] CoatFactors eval_clearcoat(const Scene& scene, const Material& m, Point uv) {
    const float roughness = m.clearcoat_roughness_factor *
                            eval_channel<kTier>(scene, m.clearcoat_roughness_texture, uv, 1);
    return {m.clearcoat_factor * eval_channel<kTier>(scene, m.clearcoat_texture, uv, 0),
            roughness * roughness};
}

struct SheenFactors {
    Rgb color{0};
    float alpha = 0;
};
template <EffectSet kTier, typename Point>
[[gnu::noinline]] SheenFactors eval_sheen(const Scene& scene, const Material& m, Point uv) {
    const float roughness =
        m.sheen_roughness_factor * eval_channel<kTier>(scene, m.sheen_roughness_texture, uv, 3);
    return {m.sheen_color_factor * eval_color<kTier>(scene, m.sheen_color_texture, uv),
            roughness * roughness};
}

struct ThroughFactors {
    Rgb color{1};
    float factor = 0;
};
template <EffectSet kTier, typename Point>
[[gnu::noinline]] ThroughFactors eval_diffuse_transmission(const Scene& scene, const Material& m,
                                                           Point uv) {
    return {m.diffuse_transmission_color_factor *
                eval_color<kTier>(scene, m.diffuse_transmission_color_texture, uv),
            m.diffuse_transmission_factor *
                eval_channel<kTier>(scene, m.diffuse_transmission_texture, uv, 3)};
}

struct AnisotropyFactors {
    Vec3f direction{0};
    float strength = 0;
};
// The direction comes from the texture, turned by the rotation, in the plane of the shading normal.
template <EffectSet kTier, typename Point>
[[gnu::noinline]] AnisotropyFactors eval_anisotropy(const Scene& scene, const Material& m, Point uv,
                                                    Vec3f n, Vec3f any_tangent, Tangent known) {
    AnisotropyFactors result{Vec3f(0), m.anisotropy_strength};
    Vec2f direction(1, 0);
    if (m.anisotropy_texture.used()) {
        const Vec4f texel =
            eval_slot<kTier>(scene, m.anisotropy_texture, uv, TextureEncoding::linear);
        direction = Vec2f(2 * texel.x - 1, 2 * texel.y - 1);
        result.strength *= texel.z;
    }
    const float s = std::sin(m.anisotropy_rotation);
    const float c = std::cos(m.anisotropy_rotation);
    const Vec2f turned(c * direction.x - s * direction.y, s * direction.x + c * direction.y);
    const Vec3f tangent = known.direction != Vec3f(0) ? known.direction : any_tangent;
    const Vec3f bitangent = cross(n, tangent) * known.sign;
    result.direction = turned.x * tangent + turned.y * bitangent;
    return result;
}

struct FilmFactors {
    float factor = 0;
    float thickness = 0;  // nanometres
};
template <EffectSet kTier, typename Point>
[[gnu::noinline]] FilmFactors eval_iridescence(const Scene& scene, const Material& m, Point uv) {
    FilmFactors result;
    result.factor = m.iridescence_factor * eval_channel<kTier>(scene, m.iridescence_texture, uv, 0);
    const float t = eval_channel<kTier>(scene, m.iridescence_thickness_texture, uv, 1);
    result.thickness = m.iridescence_thickness_minimum +
                       t * (m.iridescence_thickness_maximum - m.iridescence_thickness_minimum);
    if (!(result.thickness > 0)) result.factor = 0;
    return result;
}

}  // namespace talbot
