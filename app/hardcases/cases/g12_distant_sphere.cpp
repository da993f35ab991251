// G12: spheres of 1 mm to 1 km seen from a hundred to ten million radii.
#include <cmath>
#include <cstdint>

#include "app/hardcases/cases/case_run.h"
#include "app/hardcases/cases/case_scenes.h"
#include "app/hardcases/cases/exact_oracles.h"
#include "core/geometry/sphere.h"
#include "core/integrate/surface_interaction.h"
#include "core/integrate/tiers.h"

namespace talbot::hardcases::g12 {
namespace {

using namespace geometry;

struct Distant {
    Failures hits;
    Largest t_error;  // in ulp of t
    Largest point;    // from the true point, in radii
    void merge(const Distant& later) {
        hits.merge(later.hits);
        t_error.merge(later.t_error);
        point.merge(later.point);
    }
};

double ulp_of(double t) {
    const float f = static_cast<float>(t);
    return static_cast<double>(std::nextafter(f, kInfinity)) - f;
}

void see_sphere(float ratio, Rng& rng, Distant& score) {
    SceneDesc desc;
    const float radius = std::pow(10.0f, rng.uniform(-3, 3));
    add_sphere(desc, Vec3d(rng.in_box(-1, 1) * radius), radius,
               add_material(desc, diffuse(Rgb(0.5f))));
    // A twin of no size on the same side as the viewer keeps the centre off the scene's origin.
    add_sphere(desc, Vec3d(0), 1e-3 * radius, 1);
    WorkerPool pool(1);
    const auto scene = Scene::build(desc, pool);
    const Vec3d center = scene->geometry().spheres[0].center;
    const float distance = radius * ratio;
    for (int i = 0; i < 16; ++i) {
        Ray ray;
        const Vec3f out = rng.direction();
        ray.o = Vec3f(center) + distance * out;
        // Uniform in the disc and a little beyond.
        const Vec3f side = normalize(talbot::cross(out, rng.direction()));
        const float r = 1.2f * radius * std::sqrt(rng.uniform());
        ray.d = Vec3f(center) + r * side - ray.o;
        const ExactSphere expected = exact_sphere(ray, center, radius);
        double t[2] = {0, 0};
        const bool found = sphere_roots(Vec3d(ray.o), Vec3d(ray.d), center, radius, t[0], t[1]);
        float naive[2] = {0, 0};
        const bool naive_found = naive_sphere(ray, Vec3f(center), radius, naive);
        const auto where = [&] {
            return hex(ray) + line(" radius %a centre %a %a %a", static_cast<double>(radius),
                                   center.x, center.y, center.z);
        };
        if (std::abs(expected.inside) > 4 * 0x1p-24 * distance)
            score.hits.see(naive_found != expected.hit, found != expected.hit, where);
        if (!expected.hit) continue;
        for (int k = 0; k < 2; ++k) {
            const double unit = ulp_of(expected.t[k]);
            score.t_error.see(naive_found ? std::abs(naive[k] - expected.t[k]) / unit : 0,
                              found ? std::abs(static_cast<float>(t[k]) - expected.t[k]) / unit : 0,
                              where);
        }
        Hit hit;
        if (!scene->accel().closest(ray, hit) || hit.id.primitive != 0) continue;
        // The direction from the centre stands for the point; within a millionth of a radius of the
        // limb it is not determined by the float ray.
        if (expected.inside < 1e-6 * radius) continue;
        const SurfaceInteraction si = make_surface_interaction<kMatteTier>(*scene, ray, hit);
        const Vec3d point(expected.point[0], expected.point[1], expected.point[2]);
        const Vec3f naive_p = ray.o + hit.t * ray.d;
        score.point.see(length(Vec3d(naive_p) - center - point) / radius,
                        length(Vec3d(si.p) - center - point) / radius, where);
    }
}

// Rays that start on the surface or inside, some of them at the very centre.
Failures from_within(uint64_t rays) {
    return over_inputs<Failures>(5, rays, [](Rng& rng, Failures& failures) {
        const double radius = std::pow(10.0, rng.uniform(-3, 3));
        const Vec3d center(rng.in_box(-1, 1));
        const Vec3d n = normalize(Vec3d(rng.direction()));
        const bool on = rng.below(2) != 0;
        Ray ray;
        const double inside = rng.below(64) == 0 ? 0.0 : static_cast<double>(rng.uniform());
        ray.o = Vec3f(center + (on ? 1.0 : inside) * radius * n);
        const Vec3d normal = Vec3d(ray.o) - center;
        ray.d = rng.direction();
        const ExactSphere expected = exact_sphere(ray, center, radius);
        float t[2] = {0, 0};
        float naive[2] = {0, 0};
        const bool inwards = talbot::dot(normal, Vec3d(ray.d)) < 0;
        const int count = sphere_hits(ray, on, false, center, radius, t);
        const bool naive_found =
            naive_sphere(ray, Vec3f(center), static_cast<float>(radius), naive);
        int naive_count = 0;
        for (const float x : naive) naive_count += naive_found && x > 0;
        int own_count = 0;
        for (int k = 0; k < count; ++k) own_count += t[k] > 0;
        // A ray on the surface meets the far side or nothing, one inside leaves once.
        int right = 1;
        if (on) right = inwards && expected.hit && expected.t[1] > 0 ? 1 : 0;
        if (!on && !(length(normal) < radius * (1 - 1e-5))) return;
        if (on && std::abs(talbot::dot(normalize(normal), Vec3d(ray.d))) < 1e-4) return;
        const bool wrong_t = own_count == 1 && right == 1 &&
                             std::abs(t[count - 1] - expected.t[1]) > 2 * ulp_of(expected.t[1]);
        failures.see(naive_count != right, own_count != right || wrong_t, [&] { return hex(ray); });
    });
}

CaseResult run(Effort effort) {
    CaseResult result;
    Distant all;
    Sweep misses{"distance over radius", "wrong hit or miss, share", true, 0, {}};
    Sweep points{"distance over radius", "error of the hit point, in radii", true, 1e-5, {}};
    for (int k = 4; k <= 14; ++k) {
        const float ratio = std::pow(10.0f, 0.5f * static_cast<float>(k));
        const Distant d = over_inputs<Distant>(
            static_cast<uint64_t>(k), inputs(effort, 400, 5000),
            [&](Rng& rng, Distant& score) { see_sphere(ratio, rng, score); }, 16);
        const auto n = static_cast<double>(d.hits.inputs);
        if (d.hits.inputs > 0)
            misses.points.push_back({ratio, static_cast<double>(d.hits.naive) / n,
                                     static_cast<double>(d.hits.own) / n});
        points.points.push_back({ratio, d.point.naive, d.point.own});
        all.merge(d);
    }
    result.measures.push_back(
        all.hits.measure("wrong hit or miss, further than 4 eps distance from the limb"));
    result.measures.push_back(all.t_error.measure("error of t in ulp", 2));
    result.measures.push_back(all.point.measure("error of the hit point, in radii", 1e-5));
    result.measures.push_back(from_within(inputs(effort, 1e5, 1.5e6))
                                  .measure("wrong crossings of rays from the surface or inside"));
    result.sweeps = {misses, points};
    return result;
}

const bool kAdded = add_case(
    {"G12", Priority::p0, "tiny or distant spheres", "b^2 - 4ac in float; o + t d",
     "closest approach first, in double (Haines, Guenther, Akenine-Moeller 2019); the crossing is "
     "found anew where the point is made",
     "mitsuba-renderer/mitsuba3#512, TzuChieh/Photon-v2#7, RenderKit/embree#230, NVIDIA/VisRTX#334",
     run});

}  // namespace
}  // namespace talbot::hardcases::g12
