// What a ray's cone covers of a surface's textures, and lookups with and without it. A shading
// point is looked up as what it is given as: by UvSets alone, or filtered, by a FilteredPoint.
#pragma once

#include <cmath>

#include "core/integrate/render_scene.h"
#include "core/integrate/surface_interaction.h"
#include "core/integrate/tiers.h"
#include "core/math/ray_cone.h"
#include "core/scene/texture_pyramid.h"

namespace talbot {

// Both sets of texture coordinates, by value: a shading point that no reference leads to can stay
// in registers.
struct UvSets {
    Vec2f first{0}, second{0};
};
inline UvSets uv_sets(const SurfaceInteraction& si) {
    return {si.uv[0], si.uv[1]};
}

struct Unfiltered {};

// By UV set, the logarithm of the side of a square of the area that is covered.
struct TextureFootprint {
    const TexturePyramids* pyramids = nullptr;  // null: unfiltered
    float log2_side[2]{-kInfinity, -kInfinity};
};

struct FilteredPoint : UvSets {
    TextureFootprint footprint;
    bool by_alpha = false;  // colours are weighted by alpha
};

inline UvSets texture_point(const SurfaceInteraction& si, Unfiltered) {
    return uv_sets(si);
}
inline FilteredPoint texture_point(const SurfaceInteraction& si,
                                   const TextureFootprint& footprint) {
    return {{si.uv[0], si.uv[1]}, footprint};
}

namespace detail {

inline float log2_area(float texture_area, float covered_area) {
    return 0.5f * std::log2(texture_area * covered_area);
}

}  // namespace detail

// The footprint of a cone, advanced to the hit, on the surface: the area across the ray, seen
// aslant, times the area of texture that there is for an area of surface.
inline TextureFootprint texture_footprint(const Scene& scene, const TexturePyramids* pyramids,
                                          const SurfaceInteraction& si, const Vec3f& d,
                                          const RayCone& cone) {
    TextureFootprint footprint{pyramids};
    if (!pyramids) return footprint;
    const float covered = cone.width * cone.width / std::abs(dot(d, si.n_geometric));
    if (si.id.instance == kSphereInstance) {
        // u goes once round a circle of latitude, v half round one of longitude.
        const auto radius = static_cast<float>(scene.geometry().spheres[si.id.primitive].radius);
        const float sine = std::hypot(si.n_geometric.x, si.n_geometric.z);
        const float density = 0.5f * kInvPi * kInvPi / (radius * radius * sine);
        footprint.log2_side[0] = footprint.log2_side[1] = detail::log2_area(density, covered);
        return footprint;
    }
    const SceneInstance& instance = scene.geometry().instances[si.id.instance];
    const Mesh& mesh = scene.geometry().meshes[instance.mesh];
    const uint32_t* index = &mesh.indices[std::size_t{3} * si.id.primitive];
    Vec3f e1 = mesh.positions[index[1]] - mesh.positions[index[0]];
    Vec3f e2 = mesh.positions[index[2]] - mesh.positions[index[0]];
    if (!instance.identity) {
        e1 = instance.linear * e1;
        e2 = instance.linear * e2;
    }
    const float area = length(cross(e1, e2));
    for (int set = 0; set < 2; ++set) {
        const std::vector<Vec2f>& uv = mesh.uv[set];
        if (uv.empty()) continue;
        const Vec2f d1 = uv[index[1]] - uv[index[0]];
        const Vec2f d2 = uv[index[2]] - uv[index[0]];
        footprint.log2_side[set] =
            detail::log2_area(std::abs(d1.x * d2.y - d1.y * d2.x) / area, covered);
    }
    return footprint;
}

// What a material is read with at a hit: in kernels with ray cones, their footprint there.
template <EffectSet kTier>
auto footprint_at(const RenderScene& rs, const SurfaceInteraction& si, const Vec3f& d,
                  const RayCone& cone) {
    if constexpr (has_cones(kTier) && needs_uv(kTier)) {
        return texture_footprint(rs.scene(), rs.pyramids(), si, d, cone);
    } else {
        return Unfiltered{};
    }
}

// The level at which a texture is looked up: half the logarithm of the number of its texels that
// are covered.
inline float texture_level(const FilteredPoint& at, const TextureSlot& slot,
                           const TexturePyramid& pyramid) {
    float level = at.footprint.log2_side[slot.uv_set != 0 ? 1 : 0] + pyramid.log2_side;
    if (slot.has_transform) {
        const Vec3f& u = slot.transform_u;
        const Vec3f& v = slot.transform_v;
        level += 0.5f * std::log2(std::abs(u.x * v.y - u.y * v.x));
    }
    return level;
}

inline Vec4f lookup(const Scene& scene, const TextureSlot& slot, const UvSets&, const Vec2f& uv,
                    TextureEncoding encoding) {
    return eval_texture(scene.textures()[slot.texture], uv, encoding);
}

inline Vec4f lookup(const Scene& scene, const TextureSlot& slot, const FilteredPoint& at,
                    const Vec2f& uv, TextureEncoding encoding) {
    const Texture& texture = scene.textures()[slot.texture];
    const TexturePyramids* pyramids = at.footprint.pyramids;
    const TexelMean mean = encoding == TextureEncoding::linear ? TexelMean::linear
                           : at.by_alpha                       ? TexelMean::srgb_by_alpha
                                                               : TexelMean::srgb;
    const TexturePyramid* pyramid = pyramids ? pyramids->find(slot.texture, mean) : nullptr;
    if (!pyramid) return eval_texture(texture, uv, encoding);
    return eval_pyramid(texture, *pyramid, uv, texture_level(at, slot, *pyramid), encoding);
}

}  // namespace talbot
