// G11: a ground that is a sphere of 1e3 to 1e7 m, seen from a millimetre to three metres above it.
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstdint>
#include <numbers>
#include <vector>

#include "app/hardcases/cases/case_run.h"
#include "app/hardcases/cases/case_scenes.h"
#include "app/hardcases/cases/exact_oracles.h"
#include "app/hardcases/cases/spawned_rays.h"
#include "core/geometry/sphere.h"

namespace talbot::hardcases::g11 {
namespace {

using namespace geometry;

Ray ray_at_ground(Rng& rng) {
    Ray ray;
    ray.o = Vec3f(rng.uniform(-1, 1), std::pow(10.0f, rng.uniform(-3, 0.5f)), rng.uniform(-1, 1));
    const float phi = rng.uniform(0, 2 * kPi);
    const float angle = rng.uniform(1, 90) * kPi / 180;
    ray.d =
        Vec3f(std::cos(angle) * std::cos(phi), -std::sin(angle), std::cos(angle) * std::sin(phi));
    return ray;
}

// Error of t in units of eps max(t, height); infinite where hit or miss is wrong. The limit of 8 is
// the catalogue's: t is rounded to float once (1), the rest leaves room for a point, which adds two
// products and two sums to it.
Largest t_error(double radius, uint64_t seed, uint64_t rays) {
    return over_inputs<Largest>(seed, rays, [&](Rng& rng, Largest& error) {
        const Vec3d center(0, -radius, 0);
        const Ray ray = ray_at_ground(rng);
        const ExactSphere expected = exact_sphere(ray, center, radius);
        const double unit = 0x1p-24 * std::max<double>(expected.t[0], ray.o.y);
        double t0 = 0;
        double t1 = 0;
        const bool found = sphere_roots(Vec3d(ray.o), Vec3d(ray.d), center, radius, t0, t1);
        float naive[2] = {0, 0};
        const bool naive_found =
            naive_sphere(ray, Vec3f(center), static_cast<float>(radius), naive);
        const auto wrong = [&](bool hit, float t) {
            if (hit != expected.hit) return static_cast<double>(INFINITY);
            return hit ? std::abs(t - expected.t[0]) / unit : 0.0;
        };
        error.see(wrong(naive_found, naive[0]), wrong(found, static_cast<float>(t0)),
                  [&] { return line("radius %a ", radius) + hex(ray); });
    });
}

std::shared_ptr<const Scene> ground(double radius) {
    SceneDesc desc;
    add_sphere(desc, Vec3d(0, -radius, 0), radius, add_material(desc, diffuse(Rgb(0.5f))));
    // Small things hold the scene's origin near the viewer.
    add_sphere(desc, Vec3d(0), 1e-4, 1);
    add_sphere(desc, Vec3d(0), 1e-4, 1);
    return Scene::build(desc, workers());
}

// The mean over lines of sight that walk away over the ground all round the viewer: rings add up in
// it, noise does not.
class RadialProfile {
  public:
    static constexpr size_t kSize = 256;

    void add_line(const std::vector<double>& values) {
        for (size_t i = 0; i < kSize; ++i) sum_[i] += values[i];
    }
    // Largest amplitude of its spectrum over the median; 1 where the profile is flat.
    double peak_over_median() const {
        std::vector<double> amplitudes;
        for (size_t k = 1; k < kSize / 2; ++k) {
            std::complex<double> bin = 0;
            for (size_t i = 0; i < kSize; ++i) {
                const double turn = static_cast<double>(k * i % kSize) / kSize;
                bin += sum_[i] * std::polar(1.0, -2 * std::numbers::pi * turn);
            }
            amplitudes.push_back(std::abs(bin));
        }
        std::sort(amplitudes.begin(), amplitudes.end());
        const double median = amplitudes[amplitudes.size() / 2];
        if (amplitudes.back() == 0) return 1;
        return amplitudes.back() / median;
    }

  private:
    std::array<double, kSize> sum_{};
};

// Light of a sun on the ground along lines that start at the viewer's feet: what is seen of it
// (1 or 0) times its cosine, as it differs from the exact sphere's by more than 8 eps.
void rings(double radius, uint64_t lines, double& naive_ratio, double& own_ratio) {
    const auto scene = ground(radius);
    const Vec3f sun = normalize(Vec3f(0.6f, 0.35f, 0.2f));
    RadialProfile naive;
    RadialProfile own;
    for (uint64_t k = 0; k < lines; ++k) {
        const double phi =
            2 * std::numbers::pi * (static_cast<double>(k) + 0.5) / static_cast<double>(lines);
        std::vector<double> naive_line(RadialProfile::kSize);
        std::vector<double> own_line(RadialProfile::kSize);
        for (size_t i = 0; i < RadialProfile::kSize; ++i) {
            Ray ray;
            ray.o = Vec3f(0.3f, 1.7f, 0.2f);
            const double away = 0.5 + 0.1 * static_cast<double>(i);
            ray.d = normalize(Vec3f(Vec3d(away * std::cos(phi), -1.7, away * std::sin(phi))));
            const ExactSphere exact =
                exact_sphere(ray, scene->geometry().spheres[0].center, radius);
            const Vec3d n = Vec3d(exact.point[0], exact.point[1], exact.point[2]) / radius;
            const double expected = talbot::dot(n, Vec3d(sun));
            Hit hit;
            if (scene->accel().closest(ray, hit)) {
                const auto si = make_surface_interaction<kMatteTier>(*scene, ray, hit);
                const double seen = scene->accel().occluded(si.spawn(sun)) ? 0 : 1;
                own_line[i] = seen * double{talbot::dot(si.n_geometric, sun)} - expected;
            }
            // Control: float quadratic, normal from the float centre, 1e-4 against self-hits.
            float t[2] = {0, 0};
            const Vec3f center(scene->geometry().spheres[0].center);
            const auto r = static_cast<float>(radius);
            if (naive_sphere(ray, center, r, t)) {
                Ray shadow;
                const Vec3f p = ray.o + t[0] * ray.d;
                shadow.o = p + 1e-4f * sun;
                shadow.d = sun;
                float s[2] = {0, 0};
                const bool hidden = naive_sphere(shadow, center, r, s) && (s[0] > 0 || s[1] > 0);
                naive_line[i] =
                    (hidden ? 0 : double{talbot::dot((p - center) / r, sun)}) - expected;
            }
        }
        // Rounding alone: a float normal (sqrt(3) eps), its product with the sun (3 eps) and the
        // normalising of both (3 eps) stay below 8 eps, which counts as nothing.
        constexpr double kStep = 0x10p-24;
        for (auto* values : {&naive_line, &own_line}) {
            for (double& v : *values) v = kStep * std::round(v / kStep);
        }
        naive.add_line(naive_line);
        own.add_line(own_line);
    }
    naive_ratio = std::max(naive_ratio, naive.peak_over_median());
    own_ratio = std::max(own_ratio, own.peak_over_median());
}

CaseResult run(Effort effort) {
    CaseResult result;
    Largest error;
    Sweep sweep{"radius of the ground, m", "error of t in eps max(t, height)", true, 8, {}};
    SpawnScore spawned;
    double naive_rings = 0;
    double own_rings = 0;
    for (int k = 6; k <= 14; ++k) {
        const double radius = std::pow(10.0, 0.5 * k);
        const auto seed = static_cast<uint64_t>(k);
        const Largest e = t_error(radius, seed, inputs(effort, 8000, 1.5e5));
        sweep.points.push_back({radius, e.naive, e.own});
        error.merge(e);
        const auto scene = ground(radius);
        spawned.merge(over_inputs<SpawnScore>(
            20 + seed, inputs(effort, 8000, 1.5e5),
            [&](Rng& rng, SpawnScore& score) { spawn(*scene, ray_at_ground(rng), rng, score); }));
        rings(radius, effort == Effort::full ? 128 : 32, naive_rings, own_rings);
    }
    result.measures.push_back(error.measure("error of t in eps max(t, height)", 8));
    result.measures.push_back(spawned.nothing.measure("self-hits of rays that leave the ground"));
    result.measures.push_back({"rings in the light on the ground, peak over median of the spectrum",
                               naive_rings, own_rings, 3, Gate::at_most, ""});
    result.sweeps = {sweep};
    return result;
}

const bool kAdded = add_case(
    {"G11", Priority::p0, "huge spheres", "float quadratic",
     "quadratic in double, distance to the surface from compensated sums (Haines, Guenther, "
     "Akenine-Moeller 2019; Ogita, Rump, Oishi 2005)",
     "ebruneton/precomputed_atmospheric_scattering#21, rnd-team-dev/plotoptix#4, mmp/pbrt-v3#265",
     run});

}  // namespace
}  // namespace talbot::hardcases::g11
