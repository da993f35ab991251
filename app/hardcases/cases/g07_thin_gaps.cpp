// G07: offsets must not jump over a surface that is near: nested spheres, parallel sheets, the
// inside of acute wedges.
#include <cmath>
#include <cstdint>

#include "app/hardcases/cases/case_run.h"
#include "app/hardcases/cases/case_scenes.h"
#include "core/integrate/surface_interaction.h"
#include "core/integrate/tiers.h"

namespace talbot::hardcases::g07 {
namespace {

using namespace geometry;

// The first surface seen by `ray` is left towards d; what is met next must be `expected`.
void leave(const Scene& scene, const Ray& ray, PrimitiveId from, const Vec3d& d, uint32_t expected,
           Failures& failures) {
    struct Only {
        PrimitiveId id;
    } context{from};
    const HitFilter only{[](const void* c, const Ray&, const Hit& h) {
                             return h.id == static_cast<const Only*>(c)->id;
                         },
                         &context};
    Hit hit;
    if (!scene.accel().closest(ray, hit, only)) return;
    const SurfaceInteraction si = make_surface_interaction<kMatteTier>(scene, ray, hit);
    const Ray next = si.spawn(Vec3f(d));
    const auto object = [&](const Ray& r) {
        Hit h;
        return scene.accel().closest(r, h) ? scene.object_of(h.id) : kNoId;
    };
    Ray naive;
    naive.o = ray.o + hit.t * ray.d;
    naive.o += 1e-4f * next.d;
    naive.d = next.d;
    failures.see(object(naive) != expected, object(next) != expected,
                 [&] { return hex(next) + " after " + hex(ray); });
}

// A unit sphere in one of radius 1 + gap; rays between them, from either surface.
Failures nested_spheres(double gap, uint64_t seed, uint64_t rays) {
    SceneDesc desc;
    const uint32_t material = add_material(desc, diffuse(Rgb(0.5f)));
    add_sphere(desc, Vec3d(0), 1, material);
    add_sphere(desc, Vec3d(0), 1 + gap, material);
    const auto scene = Scene::build(desc, workers());
    return over_inputs<Failures>(seed, rays, [&](Rng& rng, Failures& failures) {
        const Vec3d n = normalize(Vec3d(rng.direction()));
        const bool outwards = rng.below(2) != 0;
        Ray ray;
        ray.o = Vec3f((outwards ? 2.0 : 1.5) * n);
        ray.d = Vec3f(-n);
        // Steep enough that the next surface is the other one.
        const Vec3d d = normalize((outwards ? n : -n) + 0.5 * Vec3d(rng.direction()));
        leave(*scene, ray, {kSphereInstance, outwards ? 0u : 1u}, d, outwards ? 1 : 0, failures);
    });
}

// Two squares of side 1 at that distance, turned any way.
Failures sheets(double gap, uint64_t seed, uint64_t rays) {
    return over_inputs<Failures>(
        seed, rays / 64,
        [&](Rng& rng, Failures& failures) {
            const Vec3d n = normalize(Vec3d(rng.direction()));
            const Vec3d u = normalize(talbot::cross(n, Vec3d(rng.direction())));
            const Vec3d v = talbot::cross(n, u);
            SceneDesc desc;
            const uint32_t material = add_material(desc, diffuse(Rgb(0.5f)));
            for (const double height : {0.0, gap}) {
                const Vec3d corner = height * n - 0.5 * u - 0.5 * v;
                Mesh mesh;
                for (const Vec3d& p : {corner, corner + u, corner + u + v, corner + v})
                    mesh.positions.push_back(Vec3f(p));
                mesh.indices = {0, 1, 2, 0, 2, 3};
                add_mesh(desc, mesh, material);
            }
            WorkerPool pool(1);
            const auto scene = Scene::build(desc, pool);
            const Vec3d origin = scene->origin();
            for (int i = 0; i < 64; ++i) {
                const bool upwards = rng.below(2) != 0;
                const double side = upwards ? 1 : -1;
                const uint32_t instance = upwards ? 0 : 1;
                const double a = rng.uniform(-0.4f, 0.4f);
                const double b = rng.uniform(-0.4f, 0.4f);
                const Vec3d target = (upwards ? 0.0 : gap) * n + a * u + b * v - origin;
                Ray ray;
                ray.o = Vec3f(target + side * n + 0.2 * Vec3d(rng.direction()));
                ray.d = Vec3f(target - Vec3d(ray.o));
                const Vec3d d = normalize(side * n + 0.5 * Vec3d(rng.direction()));
                const uint32_t triangle = b > a ? 1 : 0;
                leave(*scene, ray, {instance, triangle}, d, 1 - instance, failures);
            }
        },
        4);
}

// A closed prism over a triangle with that angle at one edge: no ray that starts near the edge,
// from where the wedge is kLeastWidth wide, may come out. The same as the least gap: an offset of
// up to 16 eps times the largest coordinate (G06), here 1, is 1e-6.
constexpr double kLeastWidth = 1e-6;

Failures wedge(double angle, uint64_t seed, uint64_t rays) {
    SceneDesc desc;
    const uint32_t material = add_material(desc, diffuse(Rgb(0.5f)));
    Rng shape(seed);
    const Vec3d x = normalize(Vec3d(shape.direction()));
    const Vec3d z = normalize(talbot::cross(x, Vec3d(shape.direction())));
    const Vec3d y = talbot::cross(z, x);
    Mesh mesh;
    for (int end = 0; end < 2; ++end) {
        for (const Vec3d& p : {Vec3d(0), x, std::cos(angle) * x + std::sin(angle) * y})
            mesh.positions.push_back(Vec3f(p + static_cast<double>(end) * z));
    }
    mesh.indices = {0, 1, 2, 3, 5, 4, 0, 3, 4, 0, 4, 1, 0, 2, 5, 0, 5, 3, 1, 4, 5, 1, 5, 2};
    add_mesh(desc, mesh, material);
    const auto scene = Scene::build(desc, workers());
    const Vec3d origin = scene->origin();
    return over_inputs<Failures>(seed, rays, [&](Rng& rng, Failures& failures) {
        // On one of the two faces, at any distance from the edge, seen from inside.
        const double r = std::max(std::pow(10.0, rng.uniform(-4, -0.3f)), kLeastWidth / angle);
        const bool lower = rng.below(2) != 0;
        const double a = lower ? 0 : angle;
        const Vec3d out = std::cos(a) * x + std::sin(a) * y;
        const Vec3d up = (lower ? 1.0 : -1.0) * (std::cos(a) * y - std::sin(a) * x);
        const Vec3d target = r * out + static_cast<double>(rng.uniform(0.1f, 0.9f)) * z - origin;
        Ray ray;
        ray.o = Vec3f(target + 0.3 * r * std::sin(angle) * up);
        ray.d = Vec3f(target - Vec3d(ray.o));
        Hit hit;
        if (!(length(Vec3d(ray.d)) > 0) || !scene->accel().closest(ray, hit)) return;
        const SurfaceInteraction si = make_surface_interaction<kMatteTier>(*scene, ray, hit);
        const Vec3f inside = si.front ? si.n_geometric : -si.n_geometric;
        Vec3f d = rng.direction();
        if (talbot::dot(d, inside) < 0) d = -d;
        const Ray next = si.spawn(d);
        Ray naive;
        naive.o = ray.o + hit.t * ray.d;
        naive.o += 1e-4f * d;
        naive.d = d;
        failures.see(!scene->accel().occluded(naive), !scene->accel().occluded(next),
                     [&] { return hex(next) + " after " + hex(ray); });
    });
}

struct Gaps {
    double naive = INFINITY;  // the smallest gap from which on all are right
    double own = INFINITY;
    std::string where;
};

// From wide to narrow, until something is wrong.
template <class Try>
Gaps smallest(const Try& attempt, Sweep& sweep) {
    Gaps gaps;
    bool naive_right = true;
    bool own_right = true;
    for (int k = 2; k <= 16; ++k) {
        const double gap = std::pow(10.0, -0.5 * k);
        const Failures f = attempt(gap, static_cast<uint64_t>(k));
        const auto n = static_cast<double>(f.inputs);
        sweep.points.push_back(
            {gap, static_cast<double>(f.naive) / n, static_cast<double>(f.own) / n});
        naive_right = naive_right && f.naive == 0;
        if (own_right && f.own > 0) gaps.where = line("gap %g: ", gap) + f.own_where;
        own_right = own_right && f.own == 0;
        if (naive_right) gaps.naive = gap;
        if (own_right) gaps.own = gap;
    }
    return gaps;
}

CaseResult run(Effort effort) {
    CaseResult result;
    const uint64_t rays = inputs(effort, 6000, 200000);
    Sweep spheres{
        "gap between spheres over their radius", "wrong next surface, share", true, 0, {}};
    // The extent of the spheres is their diameter, that of the sheets their side.
    const Gaps s = smallest(
        [&](double gap, uint64_t seed) { return nested_spheres(2 * gap, seed, rays); }, spheres);
    result.measures.push_back({"smallest right gap of nested spheres, of their extent", s.naive,
                               s.own, 1e-6, Gate::at_most, s.where});
    Sweep flat{"gap between sheets over their side", "wrong next surface, share", true, 0, {}};
    const Gaps f =
        smallest([&](double gap, uint64_t seed) { return sheets(gap, seed, rays); }, flat);
    result.measures.push_back({"smallest right gap of parallel sheets, of their extent", f.naive,
                               f.own, 1e-6, Gate::at_most, f.where});
    Failures leaks;
    Sweep angles{"dihedral angle of a wedge, radians", "rays that leave it, share", true, 0, {}};
    uint64_t seed = 100;
    for (const double angle : {1.0, 0.3, 0.1, 0.03, 0.01, 0.003, 0.001}) {
        const Failures w = wedge(angle, ++seed, 4 * rays);
        const auto n = static_cast<double>(w.inputs);
        angles.points.push_back(
            {angle, static_cast<double>(w.naive) / n, static_cast<double>(w.own) / n});
        leaks.merge(w);
    }
    result.measures.push_back(leaks.measure(
        "rays that leave a closed wedge of 1 to 1e-3 rad, from where it is 1e-6 wide"));
    result.sweeps = {spheres, flat, angles};
    return result;
}

const bool kAdded =
    add_case({"G07", Priority::p0, "thin gaps and acute corners", "1e-4 along the ray",
              "offset of a few units in the last place, primitive left out by identity",
              "mitsuba-renderer/mitsuba3#1871, RenderKit/ospray#279", run});

}  // namespace
}  // namespace talbot::hardcases::g07
