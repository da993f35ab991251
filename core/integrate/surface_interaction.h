// From a raw hit to a shading point: position with its error bound, normals, texture coordinates,
// and the material's factors there. Compiled per effect tier; what a tier lacks is not fetched.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/math/frame.h"
#include "core/math/robust.h"
#include "core/scattering/bsdf.h"
#include "core/scene/scene.h"

namespace talbot {

// Rounding of a barycentric interpolation: two products and two sums of products (Pharr, Jakob,
// Humphreys 2023, section 6.8.4).
inline constexpr float kTriangleError = gamma_bound(7);

struct SurfaceInteraction {
    Vec3f p{0};
    Vec3f p_error{0};            // per axis, >= 0
    Vec3f n_geometric{0, 0, 1};  // unit; on the side that the winding calls front
    Frame shading{};             // n on n_geometric's side; any tangent, the same in every tier
    Vec3f coat_normal{0, 0, 1};  // of the clear coat, on n_geometric's side
    Vec3f tangent{0};            // unit, along the texture's u, for normal maps; zero where unknown
    Vec2f uv[2]{Vec2f(0), Vec2f(0)};
    Vec4f color{1};  // vertex colour
    float tangent_sign = 1;
    PrimitiveId id{};
    uint32_t material = 0;
    bool front = true;  // the ray arrived on the front

    // A ray that leaves towards d (unit), its origin moved off the surface and barred from hitting
    // it again.
    Ray spawn(const Vec3f& d) const {
        Ray ray;
        ray.o = offset_ray_origin(p, p_error, n_geometric, d);
        ray.d = d;
        ray.skip_from = id;
        return ray;
    }
    // A ray that ends at `target` (already off its own surface).
    Ray spawn_to(const Vec3f& target, PrimitiveId target_id) const {
        Ray ray;
        ray.o = offset_ray_origin(p, p_error, n_geometric, target - p);
        ray.d = target - ray.o;
        ray.t_max = 1;
        ray.skip_from = id;
        ray.skip_to = target_id;
        return ray;
    }
};

constexpr EffectSet kTextureEffects =
    Effect::base_color_texture | Effect::metallic_roughness_texture;
constexpr bool needs_uv(EffectSet tier) {
    return (tier.bits & kTextureEffects.bits) != 0;
}

// Normal maps and anisotropy read tangents.
template <EffectSet kTier>
inline constexpr bool kUsesTangents =
    kTier.has(Effect::normal_map) || kTier.has(Effect::clearcoat) || kTier.has(Effect::anisotropy);
inline bool needs_tangent(const Material& m) {
    return m.normal_texture.used() || m.clearcoat_normal_texture.used() ||
           m.anisotropy_strength > 0;
}

namespace detail {

// The direction in which the texture's u grows over a triangle, on the plane of the shading normal.
[[gnu::noinline]] inline void fill_tangent(const Mesh& mesh, const SceneInstance& instance, const uint32_t* index,
                         float b0, float b1, float b2, const Vec3f& e1, const Vec3f& e2,
                         const Vec3f& n, SurfaceInteraction& si) {
    Vec3f tangent(0);
    if (!mesh.tangents.empty()) {
        const Vec4f t = b0 * mesh.tangents[index[0]] + b1 * mesh.tangents[index[1]] +
                        b2 * mesh.tangents[index[2]];
        tangent = Vec3f(t);
        si.tangent_sign = (t.w < 0) != instance.mirrored ? -1.0f : 1.0f;
        if (!instance.identity) tangent = instance.linear * tangent;
    } else if (!mesh.uv[0].empty()) {
        // Without tangents: the direction in which u grows.
        const Vec2f d1 = mesh.uv[0][index[1]] - mesh.uv[0][index[0]];
        const Vec2f d2 = mesh.uv[0][index[2]] - mesh.uv[0][index[0]];
        const float determinant = difference_of_products(d1.x, d2.y, d1.y, d2.x);
        tangent = (d2.y * e1 - d1.y * e2) * (determinant < 0 ? -1.0f : 1.0f);
        si.tangent_sign = determinant < 0 ? 1.0f : -1.0f;
    }
    tangent -= dot(tangent, n) * n;
    const float square = dot(tangent, tangent);
    if (square > 0 && is_finite(square)) si.tangent = tangent / std::sqrt(square);
}

template <EffectSet kTier>
void fill_triangle_attributes(const Mesh& mesh, const SceneInstance& instance,
                              const uint32_t* index, float b0, float b1, float b2, const Vec3f& e1,
                              const Vec3f& e2, [[maybe_unused]] bool with_tangent,
                              SurfaceInteraction& si) {
    if constexpr (needs_uv(kTier)) {
        for (std::size_t set = 0; set < (kTier.has(Effect::second_uv) ? 2 : 1); ++set) {
            if (mesh.uv[set].empty()) continue;
            const std::vector<Vec2f>& uv = mesh.uv[set];
            si.uv[set] = b0 * uv[index[0]] + b1 * uv[index[1]] + b2 * uv[index[2]];
        }
    }
    if constexpr (kTier.has(Effect::vertex_color)) {
        if (!mesh.colors.empty()) {
            si.color = b0 * mesh.colors[index[0]] + b1 * mesh.colors[index[1]] +
                       b2 * mesh.colors[index[2]];
        }
    }
    Vec3f n = si.n_geometric;
    if (!mesh.normals.empty()) {
        n = b0 * mesh.normals[index[0]] + b1 * mesh.normals[index[1]] + b2 * mesh.normals[index[2]];
        if (kTier.has(Effect::instancing) && !instance.identity)
            n = instance.normal_from_object * n;
        n = safe_normalize(n, si.n_geometric);
        if (dot(n, si.n_geometric) < 0) n = -n;
    }
    si.shading = Frame::from_normal(n);
    if constexpr (kUsesTangents<kTier>) {
        if (with_tangent) fill_tangent(mesh, instance, index, b0, b1, b2, e1, e2, n, si);
    }
}

template <EffectSet kTier>
void fill_triangle(const Scene& scene, const Hit& hit, bool with_tangent, SurfaceInteraction& si) {
    const SceneGeometry& geometry = scene.geometry();
    const SceneInstance& instance = geometry.instances[hit.id.instance];
    const Mesh& mesh = geometry.meshes[instance.mesh];
    const uint32_t* index = &mesh.indices[std::size_t{3} * hit.id.primitive];
    const Vec3f& p0 = mesh.positions[index[0]];
    const Vec3f& p1 = mesh.positions[index[1]];
    const Vec3f& p2 = mesh.positions[index[2]];
    const float b1 = hit.u;
    const float b2 = hit.v;
    const float b0 = 1 - b1 - b2;
    Vec3f e1 = p1 - p0;
    Vec3f e2 = p2 - p0;
    si.p = b0 * p0 + b1 * p1 + b2 * p2;
    si.p_error = kTriangleError * (glm::abs(b0 * p0) + glm::abs(b1 * p1) + glm::abs(b2 * p2));
    Vec3f n = stable_cross(e1, e2);
    if (kTier.has(Effect::instancing) && !instance.identity) {
        const Mat3f& linear = instance.linear;
        const Vec3f object_error = si.p_error;
        // Both the point and its error go through the matrix; the product is rounded once, from
        // double.
        si.p = Vec3f(Vec3d(instance.world_from_object * Vec4d(Vec3d(si.p), 1.0)));
        si.p_error = glm::abs(linear[0]) * object_error.x + glm::abs(linear[1]) * object_error.y +
                     glm::abs(linear[2]) * object_error.z + gamma_bound(2) * glm::abs(si.p);
        n = instance.normal_from_object * n;
        e1 = linear * e1;
        e2 = linear * e2;
    }
    si.n_geometric = safe_normalize(n, Vec3f(0, 0, 1));
    fill_triangle_attributes<kTier>(mesh, instance, index, b0, b1, b2, e1, e2, with_tangent,
                                    si);
}

template <EffectSet kTier>
void fill_sphere(const Scene& scene, const Ray& ray, const Hit& hit, SurfaceInteraction& si) {
    const Sphere& sphere = scene.geometry().spheres[hit.id.primitive];
    // Projected back onto the sphere in double, so the point's error is that of one rounding to
    // float.
    const Vec3d along = Vec3d(ray.o) + static_cast<double>(hit.t) * Vec3d(ray.d) - sphere.center;
    const double distance = length(along);
    const Vec3d n = distance > 0 ? along / distance : Vec3d(0, 1, 0);
    si.p = Vec3f(sphere.center + sphere.radius * n);
    si.p_error = gamma_bound(2) * glm::abs(si.p);
    si.n_geometric = Vec3f(n);
    si.shading = Frame::from_normal(si.n_geometric);
    if constexpr (needs_uv(kTier)) {
        si.uv[0] = sphere_uv(si.n_geometric);
        si.uv[1] = si.uv[0];
        const Vec3f around(si.n_geometric.z, 0, -si.n_geometric.x);
        const float square = dot(around, around);
        if (square > 0) {
            si.tangent = around / std::sqrt(square);
        }
        si.tangent_sign = 1;
    }
}

}  // namespace detail

// The shading point of a hit; without the tangent where only coverage is asked.
template <EffectSet kTier>
SurfaceInteraction make_surface_interaction(const Scene& scene, const Ray& ray, const Hit& hit,
                                            bool for_coverage = false) {
    SurfaceInteraction si;
    si.id = hit.id;
    if (kTier.has(Effect::analytic_spheres) && hit.is_sphere()) {
        si.material = scene.geometry().spheres[hit.id.primitive].material;
        detail::fill_sphere<kTier>(scene, ray, hit, si);
    } else {
        si.material = scene.geometry().instances[hit.id.instance].material;
        bool with_tangent = false;
        if constexpr (kUsesTangents<kTier>)
            with_tangent = !for_coverage && needs_tangent(scene.materials()[si.material]);
        detail::fill_triangle<kTier>(scene, hit, with_tangent, si);
    }
    si.front = dot(ray.d, si.n_geometric) < 0;
    return si;
}

}  // namespace talbot
