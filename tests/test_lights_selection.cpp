// Which light is sampled and how: every selection gives the sum over all lights and picks as often
// as it says; sun discs and compensated environments against closed forms.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>

#include "core/lights/light_table.h"
#include "core/lights/spherical_triangle.h"
#include "core/lights/surface_light.h"
#include "core/math/frame.h"
#include "oracles/scene_builder.h"
#include "oracles/stats/chi2.h"
#include "oracles/stats/random.h"
#include "oracles/stats/ztest.h"

namespace talbot {
namespace {

constexpr double kPi64 = std::numbers::pi;

WorkerPool& workers() {
    static WorkerPool pool(2);
    return pool;
}

PunctualLight directional(float intensity, const Vec3f& direction, float diameter = 0) {
    PunctualLight light;
    light.kind = PunctualKind::directional;
    light.intensity = intensity;
    light.direction = Vec3f(normalize(Vec3d(direction)));
    light.angular_diameter = diameter;
    return light;
}

// Point lights over a floor, two suns, and far below all a triangle that places the origin.
struct ManyLights {
    std::shared_ptr<const Scene> scene;
    double irradiance = 0;  // of the floor at the world's origin, facing +Y
    std::vector<double> intensities;

    ManyLights() {
        SceneBuilder builder;
        stats::Random random(4);
        for (int i = 0; i < 20; ++i) {
            PunctualLight light;
            light.intensity = static_cast<float>(random.between(0.1, 10));
            light.position =
                Vec3d(random.between(-3, 3), random.between(0.5, 3), random.between(-3, 3));
            intensities.push_back(static_cast<double>(light.intensity));
            const double d2 = dot(light.position, light.position);
            irradiance += intensities.back() * light.position.y / (d2 * std::sqrt(d2));
            builder.light(light);
        }
        builder.light(directional(2, Vec3f(0.6f, -0.8f, 0)));
        builder.light(directional(3, Vec3f(0, -0.6f, 0.8f), 0.2f));
        irradiance += 2 * 0.8 + 3 * 0.6;
        builder.mesh(SceneBuilder::quad(Vec3f(-4, 0, -4), Vec3f(0, 0, 8), Vec3f(8, 0, 0)),
                     builder.material(SceneBuilder::diffuse(0.5f)));
        scene = builder.build(workers());
    }
};

// One estimate of the irradiance; `fault` scales every density.
stats::Moments irradiance_of(const ManyLights& many, LightSelection selection, double fault = 1) {
    const LightTable table(*many.scene, nullptr, {selection, EnvironmentSampling::luminance});
    stats::Random random(static_cast<uint64_t>(selection) + 9);
    const Vec3f p(-many.scene->origin());
    const Vec3f n(0, 1, 0);
    stats::Moments estimate;
    for (int i = 0; i < 400000; ++i) {
        const float u = random();
        const std::optional<LightSample> s = table.sample(*many.scene, p, n, u, random.pair());
        const double value = s ? static_cast<double>(s->radiance.x) *
                                     static_cast<double>(std::max(s->wi.y, 0.0f)) /
                                     static_cast<double>(s->pdf)
                               : 0.0;
        estimate.add(value * fault);
    }
    return estimate;
}

TEST(LightSelection, EachGivesTheSumOverAllLights) {
    const ManyLights many;
    for (const LightSelectionInfo& info : kLightSelections) {
        const stats::Moments estimate = irradiance_of(many, info.kind);
        EXPECT_GT(stats::z_test(estimate, many.irradiance), stats::kFalseAlarm)
            << info.name << ": " << estimate.mean() << " for " << many.irradiance;
        EXPECT_LT(stats::z_test(irradiance_of(many, info.kind, 1.05), many.irradiance),
                  stats::kFalseAlarm)
            << info.name << ": a density that is off by 5 % must be seen";
    }
    EXPECT_LT(irradiance_of(many, LightSelection::tree).variance(),
              irradiance_of(many, LightSelection::uniform).variance());
}

// How often each of the point lights is picked.
std::vector<double> picks(const ManyLights& many, LightSelection selection, int draws) {
    const LightTable table(*many.scene, nullptr, {selection, EnvironmentSampling::luminance});
    const Vec3f p(-many.scene->origin());
    std::vector<double> counts(many.intensities.size() + 1, 0);
    for (int i = 0; i < draws; ++i) {
        const float u = (static_cast<float>(i) + 0.5f) / static_cast<float>(draws);
        const auto s = table.sample(*many.scene, p, Vec3f(0, 1, 0), u, Vec2f(u, 0.5f));
        std::size_t slot = counts.size() - 1;
        for (std::size_t k = 0; s && !s->infinite && k + 1 < counts.size(); ++k) {
            if (s->target == table.lights()[k].p0) slot = k;
        }
        ++counts[slot];
    }
    return counts;
}

TEST(LightSelection, PowerAndUniformPickAsTheySay) {
    const ManyLights many;
    constexpr int kDraws = 100000;
    const std::vector<double> uniform = picks(many, LightSelection::uniform, kDraws);
    for (std::size_t k = 0; k + 1 < uniform.size(); ++k)
        EXPECT_NEAR(uniform[k], kDraws / 22.0, 2) << "light " << k;
    EXPECT_NEAR(uniform.back(), kDraws / 22.0 * 2, 3) << "the two suns";
    const std::vector<double> power = picks(many, LightSelection::power, kDraws);
    for (std::size_t k = 1; k + 1 < power.size(); ++k)
        EXPECT_NEAR(power[k] / power[0], many.intensities[k] / many.intensities[0],
                    0.01 * many.intensities[k] / many.intensities[0] + 1e-3);
    EXPECT_GT(std::abs(power[1] - uniform[1]), 2) << "the two differ";
}

// A quad lamp above the origin, and far off a faint one.
std::shared_ptr<const Scene> quad_lamps(float faint) {
    SceneBuilder builder;
    Material lamp = SceneBuilder::diffuse(0);
    lamp.double_sided = false;
    lamp.emissive_factor = Rgb(1);
    const uint32_t bright = builder.material(lamp);
    builder.mesh(SceneBuilder::quad(Vec3f(-1, 2, -1), Vec3f(2, 0, 0), Vec3f(0, 0, 2)), bright);
    if (faint > 0) {
        lamp.emissive_factor = Rgb(faint);
        builder.mesh(SceneBuilder::quad(Vec3f(1, 2, -1), Vec3f(2, 0, 0), Vec3f(0, 0, 2)),
                     builder.material(lamp));
    }
    return builder.build(workers());
}

TEST(LightSelection, FewLightsArePickedByTheNumberThatSamplesThem) {
    const auto scene = quad_lamps(1);
    const LightTable table(*scene);
    ASSERT_EQ(table.lights().size(), 2u);
    const Vec3f p(-scene->origin());
    const Vec3f up(0, 1, 0);
    for (const float u_choice : {0.0f, 0.4f, 0.99f}) {
        for (int half = 0; half < 2; ++half) {
            const Vec2f u(0.5f * static_cast<float>(half) + 0.15f, 0.3f);
            const auto picked = table.sample(*scene, p, up, u_choice, u);
            const Light& light = table.lights()[static_cast<std::size_t>(half)];
            const auto alone = sample_quad_light(*scene, light, p, Vec2f(0.3f, 0.3f));
            ASSERT_TRUE(picked && alone);
            EXPECT_LT(length(picked->target - alone->target), 1e-5f);
            EXPECT_NEAR(picked->pdf, 0.5f * alone->pdf, 1e-6f);
        }
    }
}

TEST(LightSelection, ALightThatIsRarelyPickedIsStillSampledAllOver) {
    // Of the 2^24 first numbers the faint lamp gets 16: were they not refined, it would be seen
    // from 16 directions.
    const auto scene = quad_lamps(0x1p-20f);
    const LightTable table(*scene, nullptr,
                           {LightSelection::power, EnvironmentSampling::luminance});
    ASSERT_EQ(table.lights().size(), 2u);
    const Vec3f p(-scene->origin());
    const auto edge = static_cast<float>(1 - scene->origin().x);
    stats::Random random(8);
    std::set<float> coarse, fine;
    for (int i = 0; i < 8000; ++i) {
        const Vec2f u(1 - 0x1p-24f * static_cast<float>(1 + i % 15), 0.5f);
        const auto s = table.sample(*scene, p, Vec3f(0, 1, 0), random(), u);
        const auto same = table.sample(*scene, p, Vec3f(0, 1, 0), 0.5f, u);
        ASSERT_TRUE(s && same);
        EXPECT_GE(s->target.x, edge - 1e-5f) << "the faint lamp";
        fine.insert(s->wi.x);
        coarse.insert(same->wi.x);
    }
    EXPECT_LE(coarse.size(), 16u);
    EXPECT_GT(fine.size(), 1000u);
}

// E of a floor under a disc whose middle stands at this cosine, by quadrature over the disc.
double irradiance_under_disc(double radius, double cosine) {
    const double sine = std::sqrt(1 - cosine * cosine);
    const double t = 2 * std::pow(std::sin(0.5 * radius), 2);
    constexpr int kSteps = 700;
    double sum = 0;
    for (int i = 0; i < kSteps; ++i) {
        const double m = t * (i + 0.5) / kSteps;
        const double away = std::sqrt(m * (2 - m));
        for (int k = 0; k < kSteps; ++k) {
            const double phi = 2 * kPi64 * (k + 0.5) / kSteps;
            sum += std::max(0.0, cosine * (1 - m) + sine * away * std::cos(phi));
        }
    }
    const double radiance = 1 / (kPi64 * t * (2 - t));
    return radiance * 2 * kPi64 * t * sum / (double{kSteps} * kSteps);
}

TEST(SunDisc, GivesItsIlluminanceAtEveryAngle) {
    for (const double diameter : {2e-6, 1e-3, 0.00925, 0.1, 1.0, 2.5, kPi64}) {
        for (const double cosine : {1.0, 0.6, 0.05, -0.1}) {
            const SunDisc sun = make_sun_disc(
                directional(1, Vec3f(Vec3d(std::sqrt(1 - cosine * cosine), -cosine, 0)),
                            static_cast<float>(diameter)));
            stats::Moments estimate;
            stats::Random random(11);
            for (int i = 0; i < 100000; ++i) {
                const Vec3f d = sample_sun_disc(sun, random.pair());
                estimate.add(static_cast<double>(sun.radiance.x) *
                             static_cast<double>(std::max(d.y, 0.0f)) /
                             static_cast<double>(pdf_sun_disc(sun)));
            }
            const double radius = 0.5 * static_cast<double>(static_cast<float>(diameter));
            const double expected =
                cosine > std::sin(radius) ? cosine : irradiance_under_disc(radius, cosine);
            EXPECT_LT(std::abs(estimate.mean() - expected),
                      4 * estimate.standard_error() + 1e-5 * expected + 1e-7)
                << "diameter " << diameter << ", cosine " << cosine;
        }
    }
}

TEST(SunDisc, SamplesFillTheDiscEvenlyAndAreSeenInIt) {
    const Vec3f down(0.3f, -0.9f, 0.2f);
    for (const float diameter : {2e-3f, 0.00925f, 0.5f, 3.0f}) {
        const SunDisc sun = make_sun_disc(directional(1, down, diameter));
        constexpr int kDraws = 200000;
        std::vector<double> rings(50, 0);
        stats::Random random(5);
        int outside = 0;
        for (int i = 0; i < kDraws; ++i) {
            const Vec2f u = random.pair();
            const Vec3f d = sample_sun_disc(sun, u);
            outside += u.x < 0.9995f && !sun.holds(d);
            const Vec3d off = Vec3d(d) - Vec3d(sun.to);
            const double share = 0.5 * dot(off, off) / sun.one_minus_cos;
            ++rings[std::min(static_cast<std::size_t>(share * 50), rings.size() - 1)];
        }
        EXPECT_EQ(outside, 0) << "diameter " << diameter;
        const std::vector<double> even(rings.size(), kDraws / 50.0);
        EXPECT_GT(stats::chi2_test(rings, even).p, stats::kFalseAlarm) << "diameter " << diameter;
    }
    const SunDisc sun = make_sun_disc(directional(1, down, 0.01f));
    const Frame frame = Frame::from_normal(sun.to);
    const auto at = [&](double angle) {
        return Vec3f(std::cos(angle) * Vec3d(frame.n) + std::sin(angle) * Vec3d(frame.t));
    };
    EXPECT_TRUE(sun.holds(at(0.0049)));
    EXPECT_FALSE(sun.holds(at(0.0051)));
}

// A floor with this material under the scene that `add` makes; mean and its standard error over
// pixels.
template <typename Add>
stats::Moments floor_radiance(Add add, const Material& material, const PathSettings& settings,
                              const LightSampling& sampling, uint64_t passes) {
    SceneBuilder builder;
    builder.mesh(SceneBuilder::quad(Vec3f(-50, 0, -50), Vec3f(0, 0, 100), Vec3f(100, 0, 0)),
                 builder.material(material));
    add(builder);
    const Film film =
        render_film(builder.build(workers()), camera_at(Vec3d(0, 1, 1), Vec3d(0), 1e-4), settings,
                    32, 32, passes, workers(), -1, nullptr, sampling);
    return pixel_moments(film);
}

PathSettings one_bounce(bool nee = true) {
    PathSettings settings;
    settings.max_depth = 1;
    settings.next_event_estimation = nee;
    settings.sampler = SamplerKind::independent;  // pixels then tell their mean's error
    return settings;
}

TEST(SunDisc, LightAndScatterSamplingAgreeOnDiffuseAndGlossyFloors) {
    Material glossy;
    glossy.roughness_factor = 0.3f;
    const auto add = [](SceneBuilder& b) { b.light(directional(2, Vec3f(0, -1, -1), 0.4f)); };
    for (const Material& material : {SceneBuilder::diffuse(0.5f), glossy}) {
        const stats::Moments both = floor_radiance(add, material, one_bounce(), {}, 256);
        const stats::Moments scatter = floor_radiance(add, material, one_bounce(false), {}, 1024);
        const double error = std::hypot(both.standard_error(), scatter.standard_error());
        EXPECT_GT(stats::z_test(both.mean() - scatter.mean(), 0, error), stats::kFalseAlarm)
            << both.mean() << " with light sampling, " << scatter.mean() << " without";
        EXPECT_LT(both.variance(), scatter.variance());
    }
    const stats::Moments diffuse =
        floor_radiance(add, SceneBuilder::diffuse(0.5f), one_bounce(), {}, 256);
    EXPECT_NEAR(diffuse.mean(), 0.5 / kPi64 * 2 * std::numbers::sqrt2 / 2,
                4 * diffuse.standard_error() + 1e-6);
}

TEST(SunDisc, IsSeenInMirrorsAndByTheCamera) {
    Material mirror;
    mirror.roughness_factor = 0;
    const auto add = [](SceneBuilder& b) { b.light(directional(2, Vec3f(0, -1, 1), 0.2f)); };
    const double sine = std::sin(0.1);
    const double radiance = 2 / (kPi64 * sine * sine);
    EXPECT_NEAR(floor_radiance(add, mirror, one_bounce(), {}, 4).mean(), radiance, 1e-4 * radiance);
    // The camera looks along (0, -1, -1); a mirror sends it to (0, 1, -1), where the disc stands.
    const auto aside = [](SceneBuilder& b) { b.light(directional(2, Vec3f(0, -1, -1), 0.2f)); };
    EXPECT_EQ(floor_radiance(aside, mirror, one_bounce(), {}, 4).mean(), 0);

    SceneBuilder builder;
    builder.mesh(SceneBuilder::quad(Vec3f(-1, -9, -1), Vec3f(0, 0, 1), Vec3f(1, 0, 0)),
                 builder.material(SceneBuilder::diffuse(0.5f)));
    builder.light(directional(2, Vec3f(0, 0, 1), 0.2f));
    PathSettings settings = one_bounce();
    const Camera camera = camera_at(Vec3d(0), Vec3d(0, 0, -1), 0.01);
    const auto seen = [&] {
        return film_mean(
            render_film(builder.build(workers()), camera, settings, 8, 8, 2, workers()));
    };
    EXPECT_NEAR(seen(), radiance, 1e-4 * radiance);
    settings.transparent_background = true;
    EXPECT_EQ(seen(), 0);
}

// A sky of a gradient with a bright patch.
std::shared_ptr<const EnvironmentImage> sky_with_patch() {
    auto image = std::make_shared<EnvironmentImage>();
    image->width = 64;
    image->height = 32;
    for (uint32_t y = 0; y < image->height; ++y) {
        for (uint32_t x = 0; x < image->width; ++x) {
            const bool patch = y >= 6 && y < 10 && x >= 20 && x < 26;
            image->texels.push_back(patch ? Rgb(40) : Rgb(1 - static_cast<float>(y) / 40));
        }
    }
    return image;
}

TEST(EnvironmentSampling, AllKindsGiveTheSameFloorAndCompensationTheLeastNoise) {
    const auto image = sky_with_patch();
    // E by quadrature of the lookup.
    Environment environment;
    environment.image = image;
    const EnvironmentLight light(environment);
    double expected = 0;
    constexpr int kSteps = 1024;
    for (int i = 0; i < kSteps; ++i) {
        const double cosine = (i + 0.5) / kSteps;
        const double sine = std::sqrt(1 - cosine * cosine);
        for (int k = 0; k < kSteps; ++k) {
            const double phi = 2 * kPi64 * (k + 0.5) / kSteps;
            const Vec3f d(Vec3d(sine * std::cos(phi), cosine, sine * std::sin(phi)));
            expected += static_cast<double>(light.eval(d).y) * cosine;
        }
    }
    expected *= 2 * kPi64 / (double{kSteps} * kSteps) * 0.5 / kPi64;
    const auto add = [&](SceneBuilder& b) { b.desc().environment.image = image; };
    double variance[3];
    for (const EnvironmentSamplingInfo& info : kEnvironmentSamplings) {
        const stats::Moments m = floor_radiance(add, SceneBuilder::diffuse(0.5f), one_bounce(),
                                                {LightSelection::tree, info.kind}, 256);
        EXPECT_LT(std::abs(m.mean() - expected), 4 * m.standard_error() + 1e-4 * expected)
            << info.name << ": " << m.mean() << " for " << expected;
        variance[static_cast<std::size_t>(info.kind)] = m.variance();
    }
    EXPECT_LT(variance[0], variance[1]);
    EXPECT_LT(variance[1], variance[2]);
}

TEST(EnvironmentSampling, CompensatedDensityIntegratesToOneAndLeavesTheDarkOut) {
    Environment environment;
    environment.image = sky_with_patch();
    const EnvironmentLight light(environment, nullptr, EnvironmentSampling::compensated);
    stats::Random random(3);
    stats::Moments integral;
    for (int i = 0; i < 400000; ++i) {
        const double y = random.between(-1, 1);
        const double phi = random.between(0, 2 * kPi64);
        const double s = std::sqrt(1 - y * y);
        integral.add(
            4 * kPi64 *
            static_cast<double>(light.pdf(Vec3f(Vec3d(s * std::cos(phi), y, s * std::sin(phi))))));
    }
    EXPECT_GT(stats::z_test(integral, 1), stats::kFalseAlarm) << integral.mean();
    EXPECT_EQ(light.pdf(Vec3f(0, -1, 0)), 0);
    for (int i = 0; i < 1000; ++i) {
        const auto s = light.sample(random.pair());
        ASSERT_TRUE(s);
        EXPECT_GT(luminance(s->radiance), luminance(light.mean()) * 0.5f);
        EXPECT_NEAR(light.pdf(s->wi) / s->pdf, 1, 1e-3);
    }
    // Nothing of a constant lies above its mean: scattering finds it all.
    auto constant = std::make_shared<EnvironmentImage>();
    constant->width = 4;
    constant->height = 2;
    constant->texels.assign(8, Rgb(0.5f));
    environment.image = constant;
    const EnvironmentLight flat(environment, nullptr, EnvironmentSampling::compensated);
    EXPECT_FALSE(flat.is_black());
    EXPECT_FALSE(flat.is_sampled());
}

}  // namespace
}  // namespace talbot
