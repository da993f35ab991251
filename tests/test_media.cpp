// Media inside volumes against closed forms: the phase function, free paths, nested and overlapping
// bodies, white bodies in a uniform surrounding, light inside a volume.
#include <gtest/gtest.h>

#include <random>

#include "core/integrate/medium_stack.h"
#include "core/integrate/tiers.h"
#include "core/scattering/henyey_greenstein.h"
#include "core/scattering/medium.h"
#include "oracles/scene_builder.h"
#include "oracles/stats/chi2.h"

namespace talbot {
namespace {

WorkerPool& workers() {
    static WorkerPool pool(2);
    return pool;
}

// Cumulative probability of cosines up to c, in the textbook form, in long double.
long double phase_cdf(long double g, long double c) {
    if (std::abs(g) < 1e-4L) return (1 + c) / 2;
    return (1 - g * g) / (2 * g) * (1 / std::sqrt(1 + g * g - 2 * g * c) - 1 / (1 + g));
}

// p-value of the sampled turns of `sampled` against the cdf of `expected`.
double phase_p_value(float sampled, float expected) {
    constexpr int kBins = 40;
    constexpr int kSamples = 100000;
    std::mt19937 random(5);
    std::uniform_real_distribution<float> unit(0, 1);
    const HenyeyGreenstein phase(sampled);
    const Vec3f d = safe_normalize(Vec3f(0.3f, -0.5f, 0.8f), Vec3f(0, 0, 1));
    std::vector<double> observed(2 * kBins, 0);
    for (int i = 0; i < kSamples; ++i) {
        const Vec3f wi = phase.sample(d, Vec2f(unit(random), unit(random)));
        const Vec3d between = Vec3d(d) - Vec3d(wi);
        const long double c = 1 - 0.5L * dot(between, between);
        const auto bin = static_cast<int>(phase_cdf(expected, c) * kBins);
        const bool left =
            dot(wi, Vec3f(0.9f, 0.1f, 0.2f) - dot(Vec3f(0.9f, 0.1f, 0.2f), d) * d) > 0;
        ++observed[static_cast<std::size_t>(std::clamp(bin, 0, kBins - 1) * 2 + (left ? 1 : 0))];
    }
    const std::vector<double> even(observed.size(), kSamples / (2.0 * kBins));
    return stats::chi2_test(observed, even).p;
}

TEST(HenyeyGreenstein, TurnsAsItsDensitySays) {
    for (const float g : {0.0f, 0.3f, -0.7f, 0.9f, -0.95f, 0.99f}) {
        EXPECT_GT(phase_p_value(g, g), 1e-4) << "g " << g;
    }
    // A g that is off by 2 % is seen.
    EXPECT_LT(phase_p_value(0.9f, 0.882f), 1e-4);
}

TEST(HenyeyGreenstein, DensityIntegratesToOneAndHasItsMeanCosine) {
    for (const float g : {0.0f, 0.5f, -0.8f, 0.99f, 0.9999f}) {
        const HenyeyGreenstein phase(g);
        const Vec3f d(0, 0, 1);
        double sum = 0;
        double cosine = 0;
        constexpr int kSteps = 200000;
        // 1 - cos from 1e-14 to 2 in even steps of its logarithm, towards the side of the peak.
        const double low = std::log(1e-14);
        const double high = std::log(2.0);
        for (int i = 0; i < kSteps; ++i) {
            const double t = std::exp(low + (high - low) * (i + 0.5) / kSteps);
            const double side = g < 0 ? -1 : 1;
            const Vec3d wi(std::sqrt(t * (2 - t)), 0, side * (1 - t));
            // The vector is rounded to float: its own turn is what the density belongs to.
            const double weight = 2 * std::numbers::pi * t * (high - low) / kSteps;
            const double p = static_cast<double>(phase.pdf(d, Vec3f(wi)));
            sum += weight * p;
            cosine += weight * p * side * (1 - t);
        }
        EXPECT_NEAR(sum, 1, 1e-3) << "g " << g;
        EXPECT_NEAR(cosine, static_cast<double>(g), 1e-3) << "g " << g;
    }
}

TEST(Medium, FreePathsAreUnbiasedInEveryChannel) {
    Medium medium;
    medium.sigma_t = Rgb(0.5f, 3, 0);
    medium.albedo = Rgb(0.9f, 0.5f, 0.7f);
    std::mt19937 random(3);
    std::uniform_real_distribution<float> unit(0, 1);
    for (const float reach : {0.01f, 1.0f, 20.0f}) {
        const Rgb beta(1, 0.2f, 0.6f);
        Vec3d passed(0);
        Vec3d scattered(0);
        constexpr int kSamples = 400000;
        for (int i = 0; i < kSamples; ++i) {
            const MediumSample s =
                sample_medium(medium, beta, reach, Vec2f(unit(random), unit(random)));
            (s.scattered ? scattered : passed) += Vec3d(s.weight) / double{kSamples};
        }
        for (int c = 0; c < 3; ++c) {
            const double through = std::exp(-double{medium.sigma_t[c]} * double{reach});
            EXPECT_NEAR(passed[c], through, 0.01) << "reach " << reach << " channel " << c;
            EXPECT_NEAR(scattered[c], double{medium.albedo[c]} * (1 - through), 0.01)
                << "reach " << reach << " channel " << c;
        }
    }
}

Material clear_body(const Rgb& color, float distance, float priority = 0) {
    Material m;
    m.metallic_factor = 0;
    m.roughness_factor = 0;
    m.ior = 1;
    m.transmission_factor = 1;
    m.thickness_factor = 1;
    m.attenuation_color = color;
    m.attenuation_distance = distance;
    m.nested_priority = priority;
    return m;
}

// Radiance of one straight ray through the middle, in a uniform surrounding of 1.
Vec3d seen_through(const SceneBuilder& builder) {
    const auto scene = builder.build(workers());
    const Camera camera = camera_at(Vec3d(0, 0, 10), Vec3d(0), 1e-3);
    const Film film = render_film(scene, camera, PathSettings{}, 1, 1, 4, workers());
    Vec3d mean(0);
    for (int c = 0; c < 3; ++c) mean[c] = film.pixel(0, 0).sum[c].value() / 4;
    return mean;
}

TEST(NestedVolumes, EachAttenuatesWhereItFillsTheSpace) {
    SceneBuilder builder;
    builder.environment(Rgb(1));
    builder.sphere(Vec3d(0), 2, builder.material(clear_body(Rgb(0.5f, 0.8f, 1), 1)));
    builder.sphere(Vec3d(0, 0, 0.5), 1, builder.material(clear_body(Rgb(0.9f, 0.2f, 1), 1)));
    const Vec3d seen = seen_through(builder);
    EXPECT_NEAR(seen.x, std::pow(0.5, 2) * std::pow(0.9, 2), 1e-5);
    EXPECT_NEAR(seen.y, std::pow(0.8, 2) * std::pow(0.2, 2), 1e-5);
    EXPECT_NEAR(seen.z, 1, 1e-6);
}

TEST(NestedVolumes, WhereBodiesOverlapThePriorityDecides) {
    for (const bool first_wins : {true, false}) {
        SceneBuilder builder;
        builder.environment(Rgb(1));
        // Along the ray: from 3 to -1 the first, from 1 to -3 the second; they share 2 metres.
        builder.sphere(Vec3d(0, 0, 1), 2,
                       builder.material(clear_body(Rgb(0.5f, 1, 1), 1, first_wins ? 1 : 0)));
        builder.sphere(Vec3d(0, 0, -1), 2,
                       builder.material(clear_body(Rgb(1, 0.5f, 1), 1, first_wins ? 0 : 1)));
        const Vec3d seen = seen_through(builder);
        EXPECT_NEAR(seen.x, std::pow(0.5, first_wins ? 4 : 2), 1e-5) << first_wins;
        EXPECT_NEAR(seen.y, std::pow(0.5, first_wins ? 2 : 4), 1e-5) << first_wins;
    }
}

TEST(NestedVolumes, GlassInGlassIsInvisible) {
    const auto build = [](bool with_inner) {
        SceneBuilder builder;
        builder.environment(Rgb(0));
        builder.desc().environment.gradient = EnvironmentGradient{};
        Material glass = clear_body(Rgb(1), 1);
        glass.ior = 1.5f;
        builder.sphere(Vec3d(0), 1, builder.material(glass));
        if (with_inner) builder.sphere(Vec3d(0.2, 0, 0), 0.5, builder.material(glass));
        Material lamp = SceneBuilder::diffuse(0);
        lamp.emissive_factor = Rgb(1);
        builder.mesh(SceneBuilder::quad(Vec3f(-3, -3, -3), Vec3f(3, 0, 0), Vec3f(0, 6, 0)),
                     builder.material(lamp));
        return builder.build(workers());
    };
    const Camera camera = camera_at(Vec3d(0, 0, 4), Vec3d(0), 0.6);
    const Film plain = render_film(build(false), camera, PathSettings{}, 16, 16, 256, workers());
    const Film nested = render_film(build(true), camera, PathSettings{}, 16, 16, 256, workers());
    EXPECT_GT(film_mean(plain), 0.1);
    EXPECT_NEAR(film_mean(nested) / film_mean(plain), 1, 0.01);
}

TEST(NestedVolumes, WaterInGlassReflectsByTheRatioOfIndices) {
    // Straight through the middle of concentric spheres: two outer and two inner interfaces.
    SceneBuilder builder;
    builder.environment(Rgb(0));
    Material glass = clear_body(Rgb(1), 1);
    glass.ior = 1.5f;
    Material water = clear_body(Rgb(1), 1);
    water.ior = 1.2f;
    builder.sphere(Vec3d(0), 2, builder.material(glass));
    builder.sphere(Vec3d(0), 1, builder.material(water));
    Material lamp = SceneBuilder::diffuse(0);
    lamp.emissive_factor = Rgb(1);
    builder.mesh(SceneBuilder::quad(Vec3f(-50, -50, -30), Vec3f(100, 0, 0), Vec3f(0, 100, 0)),
                 builder.material(lamp));
    const auto scene = builder.build(workers());
    const Camera camera = camera_at(Vec3d(0, 0, 10), Vec3d(0), 1e-3);
    const Film film = render_film(scene, camera, PathSettings{}, 4, 4, 16384, workers());
    // Incoherent sum over all reflections between plane-parallel interfaces at normal incidence:
    // with x = r / (1 - r) each, T = 1 / (1 + sum of x).
    const auto x = [](double n) {
        const double r = (n - 1) * (n - 1) / ((n + 1) * (n + 1));
        return r / (1 - r);
    };
    const double expected = 1 / (1 + 2 * x(1.5) + 2 * x(1.5 / 1.2));
    EXPECT_NEAR(film_mean(film) / expected, 1, 0.003);
}

Material foggy_body(float ior, float g, float distance) {
    Material m = clear_body(Rgb(0.2f, 0.5f, 0.9f), distance);
    m.ior = ior;
    m.multiscatter_color = Rgb(1);
    m.scatter_anisotropy = g;
    return m;
}

TEST(ScatteringMedia, WhiteBodiesVanishInAUniformSurrounding) {
    for (const float ior : {1.0f, 1.5f}) {
        for (const float g : {0.0f, 0.8f, -0.5f}) {
            for (const float distance : {0.05f, 1.0f}) {
                SceneBuilder builder;
                builder.environment(Rgb(1));
                builder.sphere(Vec3d(0), 1, builder.material(foggy_body(ior, g, distance)));
                const Camera camera = camera_at(Vec3d(0, 0, 3), Vec3d(0), 0.5);
                const double mean = film_mean(render_film(builder.build(workers()), camera,
                                                          PathSettings{}, 8, 8, 512, workers()));
                EXPECT_NEAR(mean, 1, 0.01) << "ior " << ior << " g " << g << " d " << distance;
            }
        }
    }
}

// What an isotropically scattering half-space returns of uniform light towards its normal: 1 - H(1)
// sqrt(1 - albedo) (Chandrasekhar 1950, sections 33 and 42).
double half_space_return(double albedo) {
    constexpr int kNodes = 400;
    const double root = std::sqrt(1 - albedo);
    const auto mu = [](int i) { return (i + 0.5) / kNodes; };
    std::vector<double> h(kNodes, 1);
    const auto next = [&](double m) {
        double sum = 0;
        for (int i = 0; i < kNodes; ++i)
            sum += mu(i) * h[static_cast<std::size_t>(i)] / (m + mu(i));
        return 1 / (root + 0.5 * albedo * sum / kNodes);
    };
    for (int round = 0; round < 200; ++round) {
        std::vector<double> better(kNodes);
        for (int i = 0; i < kNodes; ++i) better[static_cast<std::size_t>(i)] = next(mu(i));
        h = better;
    }
    return 1 - next(1) * root;
}

TEST(ScatteringMedia, AThickBodyReturnsItsColour) {
    SceneBuilder builder;
    builder.environment(Rgb(1));
    Material m = clear_body(Rgb(0.01f), 0.001f);
    m.multiscatter_color = Rgb(0.2f, 0.5f, 0.8f);
    builder.sphere(Vec3d(0), 1, builder.material(m));
    const Camera camera = camera_at(Vec3d(0, 0, 3), Vec3d(0), 0.05);
    const Film film =
        render_film(builder.build(workers()), camera, PathSettings{}, 16, 16, 256, workers());
    Vec3d mean(0);
    for (const FilmPixel& pixel : film.pixels()) {
        for (int c = 0; c < 3; ++c) mean[c] += pixel.sum[c].value() / (256.0 * 256.0);
    }
    const Rgb albedo = single_scatter_albedo(m);
    for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(mean[c] / half_space_return(double{albedo[c]}), 1, 0.01);
        // The colour is meant of all directions together; towards the normal less comes back.
        EXPECT_NEAR(mean[c] / double{m.multiscatter_color[c]}, 0.9, 0.1);
    }
}

TEST(ScatteringMedia, LightInsideIsFoundByBothStrategies) {
    SceneBuilder builder;
    Material body = clear_body(Rgb(0.3f, 0.6f, 0.9f), 1);
    body.roughness_factor = 0.5f;
    body.ior = 1.3f;
    body.multiscatter_color = Rgb(0.8f);
    builder.sphere(Vec3d(0), 1, builder.material(body));
    Material lamp = SceneBuilder::diffuse(0.2f);
    lamp.emissive_factor = Rgb(10);
    builder.sphere(Vec3d(0.2, 0.3, 0), 0.2, builder.material(lamp));
    const auto scene = builder.build(workers());
    const Camera camera = camera_at(Vec3d(0, 0, 3), Vec3d(0), 0.7);
    PathSettings settings;
    const double with = film_mean(render_film(scene, camera, settings, 16, 16, 1024, workers()));
    settings.next_event_estimation = false;
    const double without = film_mean(render_film(scene, camera, settings, 16, 16, 1024, workers()));
    EXPECT_NEAR(with / without, 1, 0.01);
    // Absorbed alone, through a rough surface: the transmissive tier.
    body.multiscatter_color = Rgb(0);
    builder.desc().materials[1] = body;
    const auto absorbing = builder.build(workers());
    EXPECT_EQ(kTiers[smallest_tier(analyse_effects(*absorbing, camera).active)].name,
              "transmissive");
    settings.next_event_estimation = true;
    const double seen =
        film_mean(render_film(absorbing, camera, settings, 16, 16, 1024, workers()));
    settings.next_event_estimation = false;
    const double found =
        film_mean(render_film(absorbing, camera, settings, 16, 16, 1024, workers()));
    EXPECT_NEAR(seen / found, 1, 0.01);
    // Both tiers that know volumes give the same bytes.
    const Film a = render_film(absorbing, camera, settings, 8, 8, 8, workers(), 3);
    const Film b = render_film(absorbing, camera, settings, 8, 8, 8, workers(), 4);
    EXPECT_EQ(a.hash(), b.hash());
}

}  // namespace
}  // namespace talbot
