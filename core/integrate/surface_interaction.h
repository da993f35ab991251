// From a raw hit to a shading point: position with its error bound, normals, texture coordinates,
// and the material's factors there. Compiled per effect tier; what a tier lacks is not fetched.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/geometry/sphere.h"
#include "core/math/frame.h"
#include "core/math/robust.h"
#include "core/scattering/bsdf.h"
#include "core/scene/scene.h"

namespace talbot {

// Rounding of a barycentric interpolation: two products and two sums of products (Pharr, Jakob,
// Humphreys 2023, section 6.8.4).
inline constexpr float kTriangleError = gamma_bound(7);

// Vertex normals further than this from a triangle's own, by cosine, describe no surface near it.
inline constexpr float kMinRoundCosine = 0.7f;

// Along the texture's u, for normal maps and stretched highlights.
struct Tangent {
    Vec3f direction{0};  // unit; zero where unknown
    float sign = 1;
};

struct SurfaceInteraction {
    Vec3f p{0};
    Vec3f p_error{0};            // per axis, >= 0
    Vec3f n_geometric{0, 0, 1};  // unit; on the side that the winding calls front
    Vec3f lift{0};               // from p to the round surface that vertex normals describe, on the
                                 // side that the ray came from; zero where that is the triangle
    Vec3f n_round{0, 0, 1};      // its unit normal on the front side, where lift is not zero
    Frame shading{};             // n on n_geometric's side; any tangent, the same in every tier
    Vec3f coat_normal{0, 0, 1};  // of the clear coat, on n_geometric's side
    Tangent tangent{};           // where the material asks for it, after apply_normal_map()
    Vec2f uv[2]{Vec2f(0), Vec2f(0)};
    Vec4f color{1};  // vertex colour
    PrimitiveId id{};
    Vec2f barycentric{0};  // weights of a triangle's second and third corner
    uint32_t material = 0;
    bool front = true;  // the ray arrived on the front

    bool is_lifted() const { return lift.x != 0 || lift.y != 0 || lift.z != 0; }
    // Where light is gathered, and the surface's normal there, on the front side.
    Vec3f lit_point() const { return p + lift; }
    const Vec3f& n_surface() const { return is_lifted() ? n_round : n_geometric; }

    // A ray that leaves towards d (unit), its origin moved off the surface and barred from hitting
    // it again.
    Ray spawn(const Vec3f& d) const {
        Ray ray;
        set_origin(ray, d);
        ray.d = d;
        return ray;
    }
    // A ray that ends at `target` (already off its own surface).
    Ray spawn_to(const Vec3f& target, PrimitiveId target_id) const {
        Ray ray;
        set_origin(ray, target - lit_point());
        ray.d = target - ray.o;
        ray.t_max = 1;
        ray.skip_to = target_id;
        return ray;
    }

  private:
    void set_origin(Ray& ray, const Vec3f& d) const {
        ray.skip_from = id;
        if (!is_lifted() || (dot(d, n_round) > 0) != front) {
            ray.o = offset_ray_origin(p, p_error, n_geometric, d);
            return;
        }
        ray.o = lit_point();
        // Down towards the triangle, which may then be in the way.
        if ((dot(d, n_geometric) > 0) != front) ray.skip_from = PrimitiveId{};
    }
};

constexpr EffectSet kTextureEffects =
    Effect::base_color_texture | Effect::metallic_roughness_texture;
constexpr bool needs_uv(EffectSet tier) {
    return (tier.bits & kTextureEffects.bits) != 0;
}

namespace detail {

// The direction in which the texture's u grows over a triangle, on the plane of the shading normal
// n.
inline Tangent triangle_tangent(const Scene& scene, PrimitiveId id, float b1, float b2,
                                const Vec3f& n) {
    const SceneInstance& instance = scene.geometry().instances[id.instance];
    const Mesh& mesh = scene.geometry().meshes[instance.mesh];
    const uint32_t* index = &mesh.indices[std::size_t{3} * id.primitive];
    Tangent result;
    Vec3f tangent(0);
    if (!mesh.tangents.empty()) {
        const Vec4f t = (1 - b1 - b2) * mesh.tangents[index[0]] + b1 * mesh.tangents[index[1]] +
                        b2 * mesh.tangents[index[2]];
        tangent = Vec3f(t);
        result.sign = (t.w < 0) != instance.mirrored ? -1.0f : 1.0f;
        if (!instance.identity) tangent = instance.linear * tangent;
    } else if (!mesh.uv[0].empty()) {
        // Without tangents: the direction in which u grows.
        Vec3f e1 = mesh.positions[index[1]] - mesh.positions[index[0]];
        Vec3f e2 = mesh.positions[index[2]] - mesh.positions[index[0]];
        if (!instance.identity) {
            e1 = instance.linear * e1;
            e2 = instance.linear * e2;
        }
        const Vec2f d1 = mesh.uv[0][index[1]] - mesh.uv[0][index[0]];
        const Vec2f d2 = mesh.uv[0][index[2]] - mesh.uv[0][index[0]];
        const float determinant = difference_of_products(d1.x, d2.y, d1.y, d2.x);
        tangent = (d2.y * e1 - d1.y * e2) * (determinant < 0 ? -1.0f : 1.0f);
        result.sign = determinant < 0 ? 1.0f : -1.0f;
    }
    tangent -= dot(tangent, n) * n;
    const float square = dot(tangent, tangent);
    if (square > 0 && is_finite(square)) result.direction = tangent / std::sqrt(square);
    return result;
}

// Equal normals describe no round surface.
inline bool is_flat_shaded(const Mesh& mesh, const uint32_t* index) {
    const Vec3f& n0 = mesh.normals[index[0]];
    return n0 == mesh.normals[index[1]] && n0 == mesh.normals[index[2]];
}

// The way from p to the round surface: to the mean of p's projections onto the tangent planes at
// the vertices, where these lie above p as seen from the ray's side (Hanika 2021, "Hacking the
// shadow terminator", Ray Tracing Gems II, chapter 4). In the space of the mesh: e1 and e2 are
// edges, n the triangle's unit normal, side is 1 or -1 with the ray on n's.
inline Vec3f round_lift(const Mesh& mesh, const uint32_t* index, float b1, float b2,
                        const Vec3f& e1, const Vec3f& e2, const Vec3f& n, float side) {
    const Vec3f& n0 = mesh.normals[index[0]];
    const Vec3f& n1 = mesh.normals[index[1]];
    const Vec3f& n2 = mesh.normals[index[2]];
    const float sense = dot(n0, n) < 0 ? -1.0f : 1.0f;
    if (!(sense * dot(n0, n) >= kMinRoundCosine && sense * dot(n1, n) >= kMinRoundCosine &&
          sense * dot(n2, n) >= kMinRoundCosine))
        return Vec3f(0);
    const float up = sense * side;
    const Vec3f from0 = b1 * e1 + b2 * e2;
    const float h0 = std::min(0.0f, up * dot(from0, n0));
    const float h1 = std::min(0.0f, up * dot(from0 - e1, n1));
    const float h2 = std::min(0.0f, up * dot(from0 - e2, n2));
    return -up * ((1 - b1 - b2) * h0 * n0 + b1 * h1 * n1 + b2 * h2 * n2);
}

template <EffectSet kTier>
void fill_triangle_attributes(const Mesh& mesh, const SceneInstance& instance,
                              const uint32_t* index, float b0, float b1, float b2,
                              SurfaceInteraction& si) {
    if constexpr (needs_uv(kTier)) {
        const auto interpolate = [&](const std::vector<Vec2f>& uv) {
            return b0 * uv[index[0]] + b1 * uv[index[1]] + b2 * uv[index[2]];
        };
        if (!mesh.uv[0].empty()) si.uv[0] = interpolate(mesh.uv[0]);
        if (kTier.has(Effect::second_uv) && !mesh.uv[1].empty()) si.uv[1] = interpolate(mesh.uv[1]);
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
}

// Lifts the point where that takes it further than its own error, and where the ray sees the round
// surface from outside.
inline void lift_point(const Mesh& mesh, const SceneInstance& instance, const uint32_t* index,
                       const Hit& hit, const Ray& ray, SurfaceInteraction& si) {
    if (is_flat_shaded(mesh, index)) return;
    const float side = si.front ? 1.0f : -1.0f;
    const Vec3f e1 = mesh.positions[index[1]] - mesh.positions[index[0]];
    const Vec3f e2 = mesh.positions[index[2]] - mesh.positions[index[0]];
    const Vec3f n =
        instance.identity ? si.n_geometric : safe_normalize(stable_cross(e1, e2), Vec3f(0));
    Vec3f lift = round_lift(mesh, index, hit.u, hit.v, e1, e2, n, side);
    if (!instance.identity) lift = instance.linear * lift;
    if (!(side * dot(lift, si.n_geometric) > 2 * dot(glm::abs(si.n_geometric), si.p_error))) return;
    if (!(side * dot(ray.d, si.shading.n) < 0)) return;
    si.lift = lift;
    si.n_round = si.shading.n;
}

template <EffectSet kTier>
void fill_triangle(const Scene& scene, const Ray& ray, const Hit& hit, SurfaceInteraction& si) {
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
    si.barycentric = Vec2f(b1, b2);
    si.p = b0 * p0 + b1 * p1 + b2 * p2;
    si.p_error = kTriangleError * (glm::abs(b0 * p0) + glm::abs(b1 * p1) + glm::abs(b2 * p2));
    Vec3f n = stable_cross(p1 - p0, p2 - p0);
    if (kTier.has(Effect::instancing) && !instance.identity) {
        const Mat3f& linear = instance.linear;
        const Vec3f object_error = si.p_error;
        // Both the point and its error go through the matrix; the product is rounded once, from
        // double.
        si.p = Vec3f(Vec3d(instance.world_from_object * Vec4d(Vec3d(si.p), 1.0)));
        si.p_error = glm::abs(linear[0]) * object_error.x + glm::abs(linear[1]) * object_error.y +
                     glm::abs(linear[2]) * object_error.z + gamma_bound(2) * glm::abs(si.p);
        n = instance.normal_from_object * n;
    }
    si.n_geometric = safe_normalize(n, Vec3f(0, 0, 1));
    si.front = dot(ray.d, si.n_geometric) < 0;
    fill_triangle_attributes<kTier>(mesh, instance, index, b0, b1, b2, si);
    if (!mesh.normals.empty()) lift_point(mesh, instance, index, hit, ray, si);
}

template <EffectSet kTier>
void fill_sphere(const Scene& scene, const Ray& ray, const Hit& hit, SurfaceInteraction& si) {
    const Sphere& sphere = scene.geometry().spheres[hit.id.primitive];
    // The crossing anew, for a float t is too coarse on a small sphere far away; then projected
    // back onto the sphere in double, so that the point's error is that of one rounding to float.
    const Vec3d o(ray.o);
    const Vec3d d(ray.d);
    double t = hit.t;
    double roots[2];
    if (sphere_roots(o, d, sphere.center, sphere.radius, roots[0], roots[1]))
        t = static_cast<float>(roots[0]) == hit.t ? roots[0] : roots[1];
    const Vec3d along = o + t * d - sphere.center;
    const double distance = length(along);
    const Vec3d n = distance > 0 ? along / distance : Vec3d(0, 1, 0);
    si.p = Vec3f(sphere.center + sphere.radius * n);
    si.p_error = gamma_bound(2) * glm::abs(si.p);
    si.n_geometric = Vec3f(n);
    si.front = dot(ray.d, si.n_geometric) < 0;
    si.shading = Frame::from_normal(si.n_geometric);
    if constexpr (needs_uv(kTier)) {
        si.uv[0] = sphere_uv(si.n_geometric);
        si.uv[1] = si.uv[0];
    }
}

inline Tangent sphere_tangent(const Vec3f& n_geometric) {
    const Vec3f around(n_geometric.z, 0, -n_geometric.x);
    const float square = dot(around, around);
    return {square > 0 ? around / std::sqrt(square) : Vec3f(0), 1.0f};
}

}  // namespace detail

// The shading point of a hit.
template <EffectSet kTier>
SurfaceInteraction make_surface_interaction(const Scene& scene, const Ray& ray, const Hit& hit) {
    SurfaceInteraction si;
    si.id = hit.id;
    if (kTier.has(Effect::analytic_spheres) && hit.is_sphere()) {
        si.material = scene.geometry().spheres[hit.id.primitive].material;
        detail::fill_sphere<kTier>(scene, ray, hit, si);
    } else {
        si.material = scene.geometry().instances[hit.id.instance].material;
        detail::fill_triangle<kTier>(scene, ray, hit, si);
    }
    return si;
}

// n: the shading normal of that point, without a normal map.
inline Tangent tangent_at(const Scene& scene, PrimitiveId id, Vec2f barycentric, Vec3f n_geometric,
                          Vec3f n) {
    return id.instance == kSphereInstance
               ? detail::sphere_tangent(n_geometric)
               : detail::triangle_tangent(scene, id, barycentric.x, barycentric.y, n);
}

}  // namespace talbot
