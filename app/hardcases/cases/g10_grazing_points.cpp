// G10: hit points of grazing rays must lie on the surface, and on the right triangle.
#include <cmath>
#include <cstdint>

#include "app/hardcases/cases/case_run.h"
#include "app/hardcases/cases/case_scenes.h"
#include "app/hardcases/cases/exact_oracles.h"
#include "core/integrate/surface_interaction.h"
#include "core/integrate/tiers.h"

namespace talbot::hardcases::g10 {
namespace {

using namespace geometry;

// Distance of a float point from the triangle's plane, exact in its inputs.
double plane_distance(const Vec3f& p, const std::array<Vec3f, 3>& tri) {
    const Triple<Quad> n = cross(minus<Quad>(tri[1], tri[0]), minus<Quad>(tri[2], tri[0]));
    return static_cast<double>(dot(n, minus<Quad>(p, tri[0])) / square_root(dot(n, n)));
}

// One triangle at 0 to 1e4 from the origin, rays at `angle` to its plane; distances of their hits
// in units of eps sum |b_i v_i|.
void see_plane(double angle, Rng& rng, Largest& error) {
    const Vec3f at =
        rng.below(2) != 0 ? Vec3f(0) : rng.direction() * std::pow(10.0f, rng.uniform(0, 4));
    SceneDesc desc;
    Mesh mesh;
    for (int k = 0; k < 3; ++k) mesh.positions.push_back(at + rng.in_box(-1, 1));
    mesh.indices = {0, 1, 2};
    add_mesh(desc, mesh, add_material(desc, diffuse(Rgb(0.5f))));
    // A second object that holds the scene's origin, so that coordinates stay large.
    add_sphere(desc, Vec3d(0), 1e-3, 1);
    add_sphere(desc, Vec3d(0), 1e-3, 1);
    WorkerPool pool(1);
    const auto scene = Scene::build(desc, pool);
    const Mesh& stored = scene->geometry().meshes[scene->geometry().instances[0].mesh];
    const std::array<Vec3f, 3> tri = {stored.positions[0], stored.positions[1],
                                      stored.positions[2]};
    const Vec3d cross_product =
        talbot::cross(Vec3d(tri[1]) - Vec3d(tri[0]), Vec3d(tri[2]) - Vec3d(tri[0]));
    if (!(length(cross_product) > 1e-2)) return;
    const Vec3d n = normalize(cross_product);
    for (int i = 0; i < 32; ++i) {
        double b0 = rng.uniform();
        double b1 = rng.uniform();
        if (b0 + b1 > 1) {
            b0 = 1 - b0;
            b1 = 1 - b1;
        }
        const Vec3d target =
            b0 * Vec3d(tri[0]) + b1 * Vec3d(tri[1]) + (1 - b0 - b1) * Vec3d(tri[2]);
        const Vec3d along = normalize(talbot::cross(n, Vec3d(rng.direction())));
        Ray ray;
        ray.o = Vec3f(target - static_cast<double>(rng.uniform(1, 100)) *
                                   (std::cos(angle) * along - std::sin(angle) * n));
        ray.d = Vec3f(std::cos(angle) * along - std::sin(angle) * n);
        Hit hit;
        if (!scene->accel().closest(ray, hit) || hit.is_sphere()) continue;
        const SurfaceInteraction si = make_surface_interaction<kMatteTier>(*scene, ray, hit);
        const double b[3] = {1 - double{hit.u} - double{hit.v}, hit.u, hit.v};
        Vec3d size(0);
        for (size_t k = 0; k < 3; ++k) size += glm::abs(b[k] * Vec3d(tri[k]));
        const double unit = 0x1p-24 * talbot::dot(glm::abs(n), size);
        const Vec3f naive = ray.o + hit.t * ray.d;
        error.see(std::abs(plane_distance(naive, tri)) / unit,
                  std::abs(plane_distance(si.p, tri)) / unit,
                  [&] { return hex(ray) + " triangle " + hex(tri); });
    }
}

// Rays past the limb of a sphere: distance of the point from the surface, in eps (|c| + r).
void see_limb(double angle, Rng& rng, Largest& error) {
    SceneDesc desc;
    const double radius = std::pow(10.0, rng.uniform(-2, 2));
    add_sphere(desc, Vec3d(rng.in_box(-10, 10)), radius, add_material(desc, diffuse(Rgb(0.5f))));
    add_sphere(desc, Vec3d(0), 1e-6, 1);
    add_sphere(desc, Vec3d(0), 1e-6, 1);
    WorkerPool pool(1);
    const auto scene = Scene::build(desc, pool);
    const Sphere& sphere = scene->geometry().spheres[0];
    for (int i = 0; i < 32; ++i) {
        const Vec3d n = normalize(Vec3d(rng.direction()));
        const Vec3d along = normalize(talbot::cross(n, Vec3d(rng.direction())));
        Ray ray;
        const Vec3d d = std::cos(angle) * along - std::sin(angle) * n;
        ray.o = Vec3f(sphere.center + radius * n -
                      static_cast<double>(rng.uniform(1, 100)) * radius * d);
        ray.d = Vec3f(d);
        Hit hit;
        if (!scene->accel().closest(ray, hit) || hit.id.primitive != 0) continue;
        const SurfaceInteraction si = make_surface_interaction<kMatteTier>(*scene, ray, hit);
        const double unit = 0x1p-24 * (length(sphere.center) + radius);
        const auto off = [&](const Vec3f& p) {
            return std::abs(length(Vec3d(p) - sphere.center) - radius) / unit;
        };
        error.see(off(ray.o + hit.t * ray.d), off(si.p), [&] { return hex(ray); });
    }
}

// The triangle that a grazing ray meets on a bumpy mesh: the nearest in binary128, ties aside.
Failures right_triangle(uint64_t rays) {
    const MeshData mesh = displaced_sphere(5, 0.1f);
    const SceneData scene = scene_of(mesh);
    const auto accel = build_here(scene);
    return over_inputs<Failures>(7, rays, [&](Rng& rng, Failures& failures) {
        const auto tri = mesh.triangle(rng.below(static_cast<uint32_t>(mesh.triangles())));
        const float a = rng.uniform();
        const float b = rng.uniform() * (1 - a);
        const Vec3f target = tri[0] + a * (tri[1] - tri[0]) + b * (tri[2] - tri[0]);
        const Vec3f n = normalize(talbot::cross(tri[1] - tri[0], tri[2] - tri[0]));
        const Vec3f along = normalize(talbot::cross(n, rng.direction()));
        Ray ray;
        ray.o = target - 3.0f * along + 3 * std::pow(10.0f, rng.uniform(-7, -1)) * n;
        ray.d = target - ray.o;
        Quad best = 1e30;
        Quad second = 1e30;
        uint32_t nearest = kNoId;
        float naive_best = kInfinity;
        uint32_t naive_nearest = kNoId;
        for (uint32_t i = 0; i < mesh.triangles(); ++i) {
            const auto t3 = mesh.triangle(i);
            Quad numerator = 0;
            Quad denominator = 0;
            if (exact_triangle<Quad>(ray, t3, numerator, denominator)) {
                const Quad t = numerator / denominator;
                if (t > 0 && t < best) {
                    second = best;
                    best = t;
                    nearest = i;
                } else if (t > 0 && t < second) {
                    second = t;
                }
            }
            if (moeller_trumbore(ray, t3)) {
                const Vec3f e1 = t3[1] - t3[0];
                const Vec3f e2 = t3[2] - t3[0];
                const float t = talbot::dot(e2, talbot::cross(ray.o - t3[0], e1)) /
                                talbot::dot(e1, talbot::cross(ray.d, e2));
                if (t < naive_best) {
                    naive_best = t;
                    naive_nearest = i;
                }
            }
        }
        // Equal after rounding to float is a tie.
        if (nearest != kNoId && static_cast<float>(best) == static_cast<float>(second)) return;
        Hit hit;
        const bool found = accel->closest(ray, hit);
        failures.see(naive_nearest != nearest, (found ? hit.id.primitive : kNoId) != nearest,
                     [&] { return hex(ray); });
    });
}

CaseResult run(Effort effort) {
    CaseResult result;
    Largest planes;
    Largest limbs;
    Sweep sweep{
        "angle to the plane, radians", "distance from it in eps sum |b_i v_i|", true, 8, {}};
    for (int k = 1; k <= 7; ++k) {
        const double angle = std::pow(10.0, -k);
        const auto seed = static_cast<uint64_t>(k);
        const uint64_t count = inputs(effort, 48, 600);
        const Largest plane = over_inputs<Largest>(
            seed, count, [&](Rng& rng, Largest& e) { see_plane(angle, rng, e); }, 16);
        sweep.points.push_back({angle, plane.naive, plane.own});
        planes.merge(plane);
        limbs.merge(over_inputs<Largest>(
            10 + seed, count, [&](Rng& rng, Largest& e) { see_limb(angle, rng, e); }, 16));
    }
    result.measures.push_back(
        planes.measure("distance of hit points from the plane, in eps sum |b_i v_i|", 8));
    result.measures.push_back(
        limbs.measure("distance of hit points from a sphere, in eps (|c| + r)", 8));
    result.measures.push_back(right_triangle(inputs(effort, 2500, 30000))
                                  .measure("grazing rays that meet a wrong triangle"));
    result.sweeps = {sweep};
    return result;
}

const bool kAdded = add_case({"G10", Priority::p1, "hit points of grazing rays", "o + t d in float",
                              "points from barycentric weights, spheres by radial projection",
                              "RenderKit/embree#387, RenderKit/embree#381", run});

}  // namespace
}  // namespace talbot::hardcases::g10
