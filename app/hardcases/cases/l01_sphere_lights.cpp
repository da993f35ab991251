// L01: sphere lights from touching to 1e12 radii away, suns included. 1 - cos of the cone cancels,
// and a direction towards a far sphere misses it.
#include <algorithm>
#include <numbers>

#include "app/hardcases/cases/gltf_text.h"
#include "app/hardcases/cases/light_setup.h"
#include "oracles/stats/random.h"

namespace talbot::hardcases::l01 {
namespace {

using Real = long double;
constexpr Real kPiReal = std::numbers::pi_v<Real>;

// Irradiance by a sphere of radiance 1, its cone's half-angle given by its sine, seen at angle
// omega from the normal; clipped at the horizon (Snyder 1996, "Area light sources for real-time
// graphics").
Real irradiance(Real sin_cone, Real omega) {
    const Real sigma = std::asin(sin_cone);
    const Real half = kPiReal / 2;
    const Real whole = kPiReal * std::cos(omega) * sin_cone * sin_cone;
    if (omega <= half - sigma) return whole;
    if (omega >= half + sigma) return 0;
    const Real s = std::sin(omega);
    const Real c = std::cos(omega);
    const Real gamma = std::asin(std::min<Real>(1, std::cos(sigma) / s));
    const Real cos_gamma = std::cos(gamma);
    const Real g =
        -2 * s * std::cos(sigma) * cos_gamma + half - gamma + std::sin(gamma) * cos_gamma;
    const Real root = std::sqrt(std::max<Real>(0, sin_cone * sin_cone - cos_gamma * cos_gamma));
    const Real h = c * (cos_gamma * root +
                        sin_cone * sin_cone * std::asin(std::min<Real>(1, cos_gamma / sin_cone)));
    return omega < half ? whole + g - h : g + h;
}

// The control: the cone by its cosine in float.
struct NaiveCone {
    float cos_max, pdf;

    NaiveCone(float radius, float distance) {
        const float ratio = radius / distance;
        cos_max = std::sqrt(1 - ratio * ratio);
        pdf = 1 / (2 * kPi * (1 - cos_max));
    }
    Vec3f sample(const Vec2f& u) const {
        const float z = 1 - u.x * (1 - cos_max);
        const float s = std::sqrt(1 - z * z);
        return Vec3f(s * std::cos(2 * kPi * u.y), s * std::sin(2 * kPi * u.y), z);
    }
};

// One sphere of radius r at the origin, seen from distance d along z.
struct View1 {
    LampScene lamp;
    Vec3f p;
    Real sin_cone;

    View1(double radius, double distance, WorkerPool& pool) : lamp(scene_of(radius), pool) {
        p = lamp.local(Vec3d(0, 0, distance));
        sin_cone = static_cast<Real>(radius) / p.z;
    }
    static SceneBuilder scene_of(double radius) {
        SceneBuilder builder;
        builder.sphere(Vec3d(0), radius, builder.material(lamp_material()));
        return builder;
    }
};

struct Irradiances {
    double naive = 0, own = 0;
};

// Both estimates over a grid of samples; n is tilted by omega from the axis. The integrand is
// linear in u where nothing is clipped, so that the grid is exact.
Irradiances estimate(const View1& v, double omega, int steps, double& naive_bad, double& own_bad) {
    const Vec3d n(std::sin(omega), 0, -std::cos(omega));
    const NaiveCone naive(static_cast<float>(v.lamp.light(0).e1.x), v.p.z);
    Irradiances sum;
    for (int i = 0; i < steps; ++i) {
        for (int j = 0; j < steps; ++j) {
            const Vec2f u = grid_point(i, j, steps);
            const auto s = sample_sphere_light(*v.lamp.scene, v.lamp.light(0), v.p, u);
            if (s) {
                if (!is_finite(s->wi) || !is_finite(s->pdf) || !is_finite(s->target)) ++own_bad;
                sum.own += std::max(0.0, dot(Vec3d(s->wi), n)) / static_cast<double>(s->pdf);
            }
            const Vec3f w = naive.sample(u);
            const Vec3d wi(Vec3d(w.x, w.y, -w.z));
            if (!is_finite(w) || !is_finite(naive.pdf)) {
                ++naive_bad;
            } else {
                sum.naive += std::max(0.0, dot(wi, n)) / static_cast<double>(naive.pdf);
            }
        }
    }
    const double count = static_cast<double>(steps) * steps;
    return {sum.naive / count, sum.own / count};
}

// Kolmogorov-Smirnov: p that values in [0, 1] are even.
double evenness(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    const auto n = static_cast<double>(values.size());
    double d = 0;
    for (std::size_t i = 0; i < values.size(); ++i) {
        const auto k = static_cast<double>(i);
        d = std::max({d, (k + 1) / n - values[i], values[i] - k / n});
    }
    const double x = d * (std::sqrt(n) + 0.12 + 0.11 / std::sqrt(n));
    if (x < 0.2) return 1;  // the series below is 1 there but converges slowly
    double p = 0;
    for (int k = 1; k < 101; ++k) p += (k % 2 == 1 ? 2 : -2) * std::exp(-2.0 * k * k * x * x);
    return std::clamp(p, 0.0, 1.0);
}

// (1 - cos) / (1 - cos_max) of samples, from the point on the sphere: a float direction cannot say
// where on a far sphere it goes.
double radial_p(const View1& v, int draws, uint64_t seed, bool naive) {
    const NaiveCone control(static_cast<float>(v.lamp.light(0).e1.x), v.p.z);
    const Real s2 = v.sin_cone * v.sin_cone;
    const Real whole = s2 / (1 + std::sqrt(1 - s2));
    stats::Random random(case_seed(seed));
    std::vector<double> depths;
    for (int i = 0; i < draws; ++i) {
        const Vec2f u = random.pair();
        Vec3d to;
        if (naive) {
            to = Vec3d(control.sample(u));
        } else {
            const auto s = sample_sphere_light(*v.lamp.scene, v.lamp.light(0), v.p, u);
            if (!s) continue;
            to = Vec3d(s->target) - Vec3d(v.p);
        }
        const Real r2 = static_cast<Real>(to.x) * to.x + static_cast<Real>(to.y) * to.y;
        const Real sin2 = r2 / (r2 + static_cast<Real>(to.z) * to.z);
        depths.push_back(static_cast<double>(sin2 / (1 + std::sqrt(1 - sin2)) / whole));
    }
    return evenness(std::move(depths));
}

// A floor under a tiny far lamp of constant irradiance, against the control's estimate of it.
CaseImages picture(Effort effort, double& worst, uint64_t& nonfinite, WorkerPool& pool) {
    constexpr uint32_t kSize = 64;
    constexpr double kSine = 1e-4;
    SceneBuilder builder;
    builder.mesh(SceneBuilder::quad(Vec3f(-2, 0, -2), Vec3f(0, 0, 4), Vec3f(4, 0, 0)),
                 builder.material(SceneBuilder::diffuse(0.8f)));
    Material sun = lamp_material();
    sun.emissive_strength = static_cast<float>(1 / (kSine * kSine));
    builder.sphere(Vec3d(0, 10, 0), 10 * kSine, builder.material(sun));
    const Camera camera = camera_at(Vec3d(0, 2, 4), Vec3d(0), 0.6);
    const auto scene = builder.build(pool);
    PathSettings settings;
    settings.max_depth = 1;
    NonFiniteCount bad;
    CaseImages images;
    images.own = render_film(scene, camera, settings, kSize, kSize, effort == Effort::full ? 64 : 8,
                             pool, -1, &bad)
                     .image(false);
    images.naive = images.own;
    nonfinite += bad.total();
    const CameraRays rays(camera, scene->origin(), kSize, kSize, Bounds{});
    for (uint32_t y = 0; y < kSize; ++y) {
        for (uint32_t x = 0; x < kSize; ++x) {
            const Ray ray =
                rays.ray(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f, Vec2f(0));
            Hit hit;
            if (!scene->accel().closest(ray, hit) || hit.is_sphere()) continue;
            const Vec3d p =
                Vec3d(ray.o) + static_cast<double>(hit.t) * Vec3d(ray.d) + scene->origin();
            const Vec3d to = Vec3d(0, 10, 0) - p;
            const double d = length(to);
            const double cosine = to.y / d;
            const double expected = 0.8 * cosine * 100 / (d * d);
            // Pixels over the floor's edge mix with the black behind it.
            if (std::abs(p.x) < 1.8 && std::abs(p.z) < 1.8)
                worst = std::max(
                    worst,
                    relative(static_cast<double>(images.own.rgb[y * kSize + x].y), expected));
            const NaiveCone naive(static_cast<float>(10 * kSine), static_cast<float>(d));
            images.naive.rgb[y * kSize + x] =
                Rgb(0.8f * kInvPi * static_cast<float>(cosine) / naive.pdf * sun.emissive_strength);
        }
    }
    images.scene_file_name = "l01-small-sun.gltf";
    images.scene_gltf = gltf_text(builder.desc(), camera, kSize, kSize);
    return images;
}

CaseResult run(Effort effort) {
    const bool full = effort == Effort::full;
    WorkerPool pool(run_settings().threads);
    CaseResult result;
    WorstError naive;
    WorstError own;
    double naive_bad = 0;
    double own_bad = 0;
    Sweep sweep{"radius over distance", "relative error of the irradiance", true, 1e-5, {}};
    for (int e = -24; e <= 0; ++e) {
        const double ratio = std::pow(10.0, 0.5 * e) * (e == 0 ? 1 / (1 + 1e-7) : 1);
        WorstError naive_here;
        WorstError own_here;
        for (const double radius : {1.0, 0.1, 37.0}) {
            const View1 v(radius, radius / ratio, pool);
            if (!(v.sin_cone < 1)) continue;  // rounded onto the sphere
            const Real expected = irradiance(v.sin_cone, 0);
            const Irradiances got = estimate(v, 0, 16, naive_bad, own_bad);
            own.add(relative(got.own, expected), [&] {
                return "radius " + exact(radius) + " distance " + exact(double{v.p.z});
            });
            own_here.add(relative(got.own, expected));
            naive.add(relative(got.naive, expected));
            naive_here.add(relative(got.naive, expected));
        }
        sweep.points.push_back({ratio, std::min(naive_here.value, 1e3), own_here.value});
    }
    // Below the horizon in part.
    WorstError clipped;
    WorstError naive_clipped;
    const int steps = full ? 2000 : 900;
    for (const double ratio : {0.9, 0.5, 1e-2}) {
        if (!full && ratio == 0.5) continue;
        const View1 v(1, 1 / ratio, pool);
        for (const double share : {-0.8, 0.0, 0.6}) {
            if (!full && share < 0) continue;
            const double omega = std::numbers::pi / 2 + share * std::asin(ratio);
            const Real expected = irradiance(v.sin_cone, omega);
            const Irradiances got = estimate(v, omega, steps, naive_bad, own_bad);
            clipped.add(relative(got.own, expected),
                        [&] { return "ratio " + exact(ratio) + " angle " + exact(omega); });
            naive_clipped.add(relative(got.naive, expected));
        }
    }
    // On the surface and inside: nothing is sampled, and no density is claimed.
    double claimed = 0;
    double naive_claimed = 0;
    for (const double ratio : {1.0, 1 - 1e-7, 0.5, 0.0}) {
        const View1 v(1, ratio, pool);
        const float pdf = pdf_sphere_light(v.lamp.light(0), v.p);
        if (pdf != 0 || sample_sphere_light(*v.lamp.scene, v.lamp.light(0), v.p, Vec2f(0.4f)))
            ++claimed;
        if (NaiveCone(1, static_cast<float>(ratio)).pdf != 0) ++naive_claimed;
    }
    double p = 1;
    double naive_p = 1;
    std::string where;
    uint64_t seed = 1;
    for (const double ratio : {0.99, 1e-2, 1e-4, 4.65e-3, 1e-6, 1e-9, 1e-12}) {
        const View1 v(1, 1 / ratio, pool);
        const int draws = full ? 80000 : 5000;
        const double here =
            confirmed_p(++seed, [&](uint64_t s) { return radial_p(v, draws, s, false); });
        if (here < p) p = here, where = "ratio " + exact(ratio);
        naive_p = std::min(naive_p, radial_p(v, draws, seed, true));
    }
    double image = 0;
    result.images.push_back(picture(effort, image, result.nonfinite, pool));
    result.measures.push_back({"relative error of the irradiance", naive.or_infinite(),
                               own.or_infinite(), 1e-5, Gate::at_most, own.where});
    result.measures.push_back({"the same with part of the sphere below the horizon",
                               naive_clipped.or_infinite(), clipped.or_infinite(), 1e-5,
                               Gate::at_most, clipped.where});
    result.measures.push_back(
        {"samples that are not finite", naive_bad, own_bad, 0, Gate::at_most, ""});
    result.measures.push_back({"places inside or on the sphere where a density is claimed",
                               naive_claimed, claimed, 0, Gate::at_most, ""});
    result.measures.push_back(
        {"smallest p that radial quantiles are even", naive_p, p, 1e-4, Gate::at_least, where});
    // Within a pixel the irradiance itself varies by about as much.
    result.measures.push_back({"relative error of a pixel under a sun of half-angle 1e-4",
                               std::nan(""), image, 0.02, Gate::at_most, ""});
    result.sweeps.push_back(sweep);
    return result;
}

const bool kAdded = add_case(
    {"L01", Priority::p0, "sphere lights, tiny, far, near and from inside",
     "1 - cos of the cone in float",
     "1 - cos = sin^2 / (1 + cos); the point on the sphere is computed, not intersected again",
     "mmp/pbrt-v3#212, #319; LuxCoreRender/LuxCore#443, #446; papaboo/Bifrost3D#44", run});

}  // namespace
}  // namespace talbot::hardcases::l01
