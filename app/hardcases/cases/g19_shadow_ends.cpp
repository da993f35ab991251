// G19: shadow rays to lamps at 1e-3 to 1e9 m, with an occluder close before or behind the lamp.
#include <cmath>
#include <cstdint>

#include "app/hardcases/cases/case_run.h"
#include "app/hardcases/cases/case_scenes.h"
#include "core/integrate/surface_interaction.h"
#include "core/integrate/tiers.h"
#include "core/lights/light_table.h"

namespace talbot::hardcases::g19 {
namespace {

using namespace geometry;

Mesh square(const Vec3d& middle, const Vec3d& u, const Vec3d& v, double half) {
    Mesh mesh;
    for (const Vec3d& p : {-u - v, u - v, u + v, v - u})
        mesh.positions.push_back(Vec3f(middle + half * p));
    mesh.indices = {0, 1, 2, 0, 2, 3};
    return mesh;
}

// Lamp: a square or a sphere at `distance`; the occluder a wide square, gap of it away.
void see_lamp(double distance, Rng& rng, Failures& failures) {
    const Vec3d w = normalize(Vec3d(rng.direction()));  // from the lamp to the receiver
    const Vec3d u = normalize(talbot::cross(w, Vec3d(rng.direction())));
    const Vec3d v = talbot::cross(w, u);
    const double gap = distance * std::pow(10.0, rng.uniform(-5.3f, -1));
    const bool before = rng.below(2) != 0;
    const bool sphere = rng.below(2) != 0;
    const double size = 0.2 * distance;
    const Vec3d lamp = -distance * w;
    SceneDesc desc;
    const uint32_t grey = add_material(desc, diffuse(Rgb(0.5f)));
    const uint32_t bright = add_material(desc, emitter(Rgb(1)));
    const double reach = sphere ? size : 0;
    add_mesh(desc, square(Vec3d(0), u, v, 0.3 * distance), grey);
    add_mesh(desc, square(lamp + (before ? reach + gap : -reach - gap) * w, u, v, 3 * distance),
             grey);
    if (sphere) {
        add_sphere(desc, lamp, size, bright);
    } else {
        add_mesh(desc, square(lamp, u, v, size), bright);
    }
    WorkerPool pool(1);
    const auto scene = Scene::build(desc, pool);
    const LightTable lights(*scene);
    for (int i = 0; i < 32; ++i) {
        const Vec3d target = 0.28 * distance *
                                 (static_cast<double>(rng.uniform(-1, 1)) * u +
                                  static_cast<double>(rng.uniform(-1, 1)) * v) -
                             scene->origin();
        Ray ray;
        ray.o = Vec3f(target - 0.3 * distance * (w + 0.3 * Vec3d(rng.direction())));
        ray.d = Vec3f(target - Vec3d(ray.o));
        Hit hit;
        if (!scene->accel().closest(ray, hit) || hit.id.instance != 0) continue;
        const auto si = make_surface_interaction<kMatteTier>(*scene, ray, hit);
        const Vec3f n =
            talbot::dot(Vec3d(si.n_geometric), -w) > 0 ? si.n_geometric : -si.n_geometric;
        const Vec2f numbers(rng.uniform(), rng.uniform());
        const auto light = lights.sample(*scene, si.p, n, rng.uniform(), numbers);
        if (!light) continue;
        const Ray shadow = si.spawn_to(light->target, light->id);
        Ray naive;
        naive.o = ray.o + hit.t * ray.d;
        naive.d = light->target - naive.o;
        naive.t_max = 1 - 2e-4f;
        naive.o += 1e-4f * naive.d;
        failures.see(scene->accel().occluded(naive) != before,
                     scene->accel().occluded(shadow) != before, [&] {
                         return hex(shadow) + line(" distance %g gap %g %s %s", distance, gap,
                                                   before ? "before" : "behind",
                                                   sphere ? "a sphere" : "a square");
                     });
    }
}

CaseResult run(Effort effort) {
    CaseResult result;
    Failures all;
    Sweep sweep{"distance of the lamp, m", "wrong shadow rays, share", true, 0, {}};
    for (int k = -3; k <= 9; ++k) {
        const Failures f = over_inputs<Failures>(
            static_cast<uint64_t>(k + 10), inputs(effort, 60, 4000),
            [&](Rng& rng, Failures& failures) {
                see_lamp(std::pow(10.0, k) * static_cast<double>(rng.uniform(1, 10)) / 3, rng,
                         failures);
            },
            4);
        const auto n = static_cast<double>(f.inputs);
        sweep.points.push_back(
            {std::pow(10.0, k), static_cast<double>(f.naive) / n, static_cast<double>(f.own) / n});
        all.merge(f);
    }
    result.measures.push_back(
        all.measure("wrong shadow rays, occluder 5e-6 to 0.1 of the distance "
                    "before or behind the lamp"));
    result.sweeps = {sweep};
    return result;
}

const bool kAdded = add_case({"G19", Priority::p1, "long rays and shadow ends",
                              "segment shortened by 1e-4 at both ends",
                              "the ray ends on an offset point of the lamp's lit side, the lamp's "
                              "primitive is left out by identity",
                              "mitsuba-renderer/mitsuba3#61, mitsuba-renderer/mitsuba3#62, "
                              "ArtOfIllusion/ArtOfIllusion#193",
                              run});

}  // namespace
}  // namespace talbot::hardcases::g19
