// The estimator against closed forms: white furnaces, closed boxes, irradiance of simple lights,
// and its own variants.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/scattering/medium.h"
#include "oracles/scene_builder.h"

namespace talbot {
namespace {

WorkerPool& workers() {
    static WorkerPool pool;
    return pool;
}

PathSettings deep(uint32_t depth = 1024) {
    PathSettings settings;
    settings.max_depth = depth;
    return settings;
}

// Mean radiance of a sphere that fills the view, in a unit environment.
double furnace(const Material& material, uint64_t passes = 64) {
    SceneBuilder builder;
    builder.sphere(Vec3d(0), 1, builder.material(material));
    builder.environment(Rgb(1));
    const Camera camera = camera_at(Vec3d(0, 0, 4), Vec3d(0), 0.3);
    NonFiniteCount bad;
    const Film film =
        render_film(builder.build(workers()), camera, deep(), 32, 32, passes, workers(), -1, &bad);
    EXPECT_EQ(bad.total(), 0u);
    return film_mean(film);
}

TEST(WhiteFurnace, DiffuseMetalPlasticAndGlassReturnWhatArrives) {
    EXPECT_NEAR(furnace(SceneBuilder::diffuse(1)), 1, 1e-5);
    for (float roughness : {0.0f, 0.1f, 0.5f, 1.0f}) {
        Material metal;
        metal.roughness_factor = roughness;
        const double m = furnace(metal);
        EXPECT_NEAR(m, 1, 0.005) << "metal, roughness " << roughness;
        EXPECT_LT(m, 1.002);
        Material plastic;
        plastic.metallic_factor = 0;
        plastic.roughness_factor = roughness;
        const double p = furnace(plastic);
        EXPECT_NEAR(p, 1, 0.005) << "plastic, roughness " << roughness;
        EXPECT_LT(p, 1.002);
    }
    Material glass;
    glass.metallic_factor = 0;
    glass.roughness_factor = 0;
    glass.transmission_factor = 1;
    glass.thickness_factor = 1;
    EXPECT_NEAR(furnace(glass, 256), 1, 0.005);
}

TEST(WhiteFurnace, AGreySphereLosesItsAlbedoOnceAndLossesAreSeen) {
    // A convex body sees only the environment, so its radiance is its albedo; this is also the
    // control for the test above.
    EXPECT_NEAR(furnace(SceneBuilder::diffuse(0.98f)), 0.98, 1e-4);
}

// Every wall emits Le and reflects rho: L = Le / (1 - rho) everywhere, whatever the shape. Relative
// to that.
double closed_box(float rho, uint64_t passes, bool nee, bool roulette) {
    SceneBuilder builder;
    Material wall = SceneBuilder::diffuse(rho);
    wall.emissive_factor = Rgb(1);
    builder.mesh(SceneBuilder::box(Vec3f(-1), Vec3f(1, 1.5f, 2)), builder.material(wall));
    // What lies beyond this depth is below 1e-4 of the whole.
    PathSettings settings = deep(rho < 0.95f ? 128 : 1024);
    settings.next_event_estimation = nee;
    settings.russian_roulette = roulette;
    const Camera camera = camera_at(Vec3d(0.1, 0.2, 0.3), Vec3d(1, 0.3, 0.2), 1.2);
    return film_mean(
               render_film(builder.build(workers()), camera, settings, 16, 16, passes, workers())) *
           (1 - static_cast<double>(rho));
}

TEST(ClosedFurnace, BoxHoldsLeOverOneMinusRho) {
    for (float rho : {0.0f, 0.5f, 0.9f}) {
        EXPECT_NEAR(closed_box(rho, 256, true, false), 1, 0.002) << "rho " << rho;
        EXPECT_NEAR(closed_box(rho, 8, false, false), 1, 1e-4) << "rho " << rho << ", no NEE";
    }
    EXPECT_NEAR(closed_box(0.99f, 4, false, false), 1, 0.002);
}

TEST(ClosedFurnace, RouletteKeepsTheMean) {
    // With survival rho a path's length is geometric: the relative deviation of one sample is about
    // sqrt(rho).
    constexpr uint64_t kPasses = 512;
    EXPECT_NEAR(closed_box(0.9f, kPasses, false, true), 1, 4 / std::sqrt(256.0 * kPasses));
}

// Radiance of the middle of a white diffuse floor under the light of `add`.
template <typename Add>
double floor_radiance(Add add, uint64_t passes, bool nee = true) {
    SceneBuilder builder;
    const uint32_t floor = builder.material(SceneBuilder::diffuse(0.5f));
    builder.mesh(SceneBuilder::quad(Vec3f(-50, 0, -50), Vec3f(0, 0, 100), Vec3f(100, 0, 0)), floor);
    add(builder);
    PathSettings settings = deep(1);
    settings.next_event_estimation = nee;
    return film_mean(render_film(builder.build(workers()),
                                 camera_at(Vec3d(0, 1, 1), Vec3d(0), 1e-4), settings, 8, 8, passes,
                                 workers()));
}

TEST(Irradiance, PunctualLightsFollowTheInverseSquare) {
    PunctualLight point;
    point.kind = PunctualKind::point;
    point.intensity = 10;
    point.position = Vec3d(0, 2, 0);
    EXPECT_NEAR(floor_radiance([&](SceneBuilder& b) { b.light(point); }, 4),
                0.5 / std::numbers::pi * 10 / 4, 1e-4);

    PunctualLight sun;
    sun.kind = PunctualKind::directional;
    sun.intensity = 3;
    sun.direction = Vec3f(0, -0.6f, 0.8f);
    EXPECT_NEAR(floor_radiance([&](SceneBuilder& b) { b.light(sun); }, 4),
                0.5 / std::numbers::pi * 3 * 0.6, 1e-4);

    point.range = 1.9f;
    EXPECT_EQ(floor_radiance([&](SceneBuilder& b) { b.light(point); }, 4), 0);
}

// A disc-like closed form: a sphere light of radius r at height h gives E = pi L (r/h)^2.
TEST(Irradiance, SphereLightMatchesItsClosedForm) {
    for (double radius : {0.5, 1e-2, 1e-4}) {
        const auto add = [&](SceneBuilder& b) {
            Material lamp = SceneBuilder::diffuse(0);
            lamp.double_sided = false;
            lamp.emissive_factor = Rgb(1);
            lamp.emissive_strength = static_cast<float>(1 / (radius * radius));
            b.sphere(Vec3d(0, 2, 0), radius, b.material(lamp));
        };
        EXPECT_NEAR(floor_radiance(add, 256) / (0.5 / 4), 1, 2e-3) << "radius " << radius;
    }
}

// The form factor of a square of side 2a at height h, parallel, seen from below its middle.
double square_irradiance(double a, double h) {
    const double x = a / h;
    const double root = std::sqrt(1 + x * x);
    return 4 * (x / root) * std::atan(x / root);
}

TEST(Irradiance, QuadLightMatchesItsFormFactorNearAndFar) {
    for (float side : {0.1f, 1.0f, 10.0f}) {
        const auto add = [&](SceneBuilder& b) {
            Material lamp = SceneBuilder::diffuse(0);
            lamp.double_sided = false;
            lamp.emissive_factor = Rgb(1);
            b.mesh(SceneBuilder::quad(Vec3f(-side, 2, -side), Vec3f(2 * side, 0, 0),
                                      Vec3f(0, 0, 2 * side)),
                   b.material(lamp));
        };
        const double expected =
            0.5 / std::numbers::pi * square_irradiance(static_cast<double>(side), 2);
        EXPECT_NEAR(floor_radiance(add, 1024) / expected, 1, 3e-3) << "half side " << side;
        if (side >= 1) {
            EXPECT_NEAR(floor_radiance(add, 4096, false) / expected, 1, 2e-2)
                << "half side " << side;
        }
    }
}

TEST(Coverage, BlendedSheetsTransmitOneMinusAlphaEach) {
    SceneBuilder builder;
    Material sheet = SceneBuilder::diffuse(0);
    sheet.alpha_mode = AlphaMode::blend;
    sheet.base_color_factor.w = 0.25f;
    const uint32_t material = builder.material(sheet);
    constexpr int kSheets = 4;
    for (int i = 0; i < kSheets; ++i) {
        const auto z = static_cast<float>(i);
        builder.mesh(SceneBuilder::quad(Vec3f(-50, -50, -z), Vec3f(100, 0, 0), Vec3f(0, 100, 0)),
                     material);
    }
    builder.environment(Rgb(1));
    const Film film = render_film(builder.build(workers()), camera_at(Vec3d(0, 0, 5), Vec3d(0)),
                                  deep(0), 32, 32, 256, workers());
    EXPECT_NEAR(film_mean(film), std::pow(0.75, kSheets), 0.003);
}

TEST(Coverage, TheCameraDoesNotSeeBackFacesButLightDoes) {
    SceneBuilder builder;
    Material wall = SceneBuilder::diffuse(0.5f);
    wall.double_sided = false;
    // Front side along +z; the camera looks from behind.
    builder.mesh(SceneBuilder::quad(Vec3f(-50, -50, 0), Vec3f(100, 0, 0), Vec3f(0, 100, 0)),
                 builder.material(wall));
    builder.environment(Rgb(1));
    const auto scene = builder.build(workers());
    EXPECT_NEAR(film_mean(render_film(scene, camera_at(Vec3d(0, 0, -5), Vec3d(0)), deep(), 8, 8, 4,
                                      workers())),
                1, 1e-6);
    EXPECT_NEAR(film_mean(render_film(scene, camera_at(Vec3d(0, 0, 5), Vec3d(0)), deep(), 8, 8, 4,
                                      workers())),
                0.5, 1e-4);
}

TEST(Volume, ASolidAbsorbsAlongThePath) {
    SceneBuilder builder;
    Material glass;
    glass.metallic_factor = 0;
    glass.roughness_factor = 0;
    glass.ior = 1;  // no interface: straight through
    glass.transmission_factor = 1;
    glass.thickness_factor = 1;
    glass.attenuation_color = Rgb(0.5f, 0.25f, 1);
    glass.attenuation_distance = 2;
    builder.mesh(SceneBuilder::box(Vec3f(-50, -50, -3), Vec3f(50, 50, 0)), builder.material(glass));
    builder.environment(Rgb(1));
    const Film film =
        render_film(builder.build(workers()), camera_at(Vec3d(0, 0, 5), Vec3d(0), 1e-3), deep(), 4,
                    4, 4, workers());
    const FilmPixel& pixel = film.pixel(2, 2);
    EXPECT_NEAR(pixel.sum[0].value() / 4, std::pow(0.5, 1.5), 1e-5);
    EXPECT_NEAR(pixel.sum[1].value() / 4, std::pow(0.25, 1.5), 1e-5);
    EXPECT_NEAR(pixel.sum[2].value() / 4, 1, 1e-6);
}

TEST(Volume, TransmittanceKeepsItsDigitsAtDepth) {
    double worst = 0;
    double rounded = 0;
    for (int i = 1; i < 4000; ++i) {
        const float sigma = 0.0137f * static_cast<float>(i);
        constexpr float kDistance = 1.5999f;
        const double expected = std::exp(-static_cast<double>(sigma) * kDistance);
        const Rgb t = transmittance(Rgb(sigma, 0, kInfinity), kDistance);
        worst = std::max(worst, std::abs(t.x / expected - 1));
        rounded = std::max(rounded, std::abs(std::exp(-sigma * kDistance) / expected - 1));
        EXPECT_EQ(t.y, 1);
        EXPECT_EQ(t.z, 0);
    }
    EXPECT_LT(worst, 3e-7);
    EXPECT_GT(rounded, 1e-6) << "control: the product rounded to float";
    EXPECT_EQ(transmittance(Rgb(kInfinity), 0), Rgb(1));
}

// A small room with a lamp, a metal and a plain sphere.
std::shared_ptr<const Scene> room() {
    SceneBuilder builder;
    const uint32_t wall = builder.material(SceneBuilder::diffuse(0.7f));
    builder.mesh(SceneBuilder::box(Vec3f(-2), Vec3f(2)), wall);
    Material lamp = SceneBuilder::diffuse(0);
    lamp.emissive_factor = Rgb(5);
    builder.mesh(SceneBuilder::quad(Vec3f(-0.5f, 1.9f, -0.5f), Vec3f(1, 0, 0), Vec3f(0, 0, 1)),
                 builder.material(lamp));
    Material metal;
    metal.roughness_factor = 0.4f;
    builder.sphere(Vec3d(0.7, -1, 0), 0.8, builder.material(metal));
    builder.sphere(Vec3d(-0.9, -1.3, 0.2), 0.6, wall);
    return builder.build(workers());
}

TEST(Estimators, WithAndWithoutNextEventEstimationAgree) {
    const auto scene = room();
    const Camera camera = camera_at(Vec3d(0, 0, 1.9), Vec3d(0), 1.2);
    PathSettings settings = deep(16);
    const double with = film_mean(render_film(scene, camera, settings, 32, 32, 256, workers()));
    settings.next_event_estimation = false;
    const double without = film_mean(render_film(scene, camera, settings, 32, 32, 1024, workers()));
    EXPECT_NEAR(with / without, 1, 0.012);
}

TEST(Estimators, RouletteChangesNoMean) {
    const auto scene = room();
    const Camera camera = camera_at(Vec3d(0, 0, 1.9), Vec3d(0), 1.2);
    PathSettings settings = deep(64);
    const double with = film_mean(render_film(scene, camera, settings, 32, 32, 256, workers()));
    settings.russian_roulette = false;
    const double without = film_mean(render_film(scene, camera, settings, 32, 32, 64, workers()));
    EXPECT_NEAR(with / without, 1, 0.008);
}

TEST(Tiers, EveryTierThatCoversASceneGivesTheSameBytes) {
    const auto scene = room();
    const Camera camera = camera_at(Vec3d(0, 0, 1.9), Vec3d(0), 1.2);
    const std::size_t smallest = smallest_tier(analyse_effects(*scene, camera).active);
    EXPECT_EQ(kTiers[smallest].name, "glossy");
    const std::string hash = render_film(scene, camera, deep(16), 48, 48, 8, workers()).hash();
    for (std::size_t tier = smallest; tier < kTiers.size(); ++tier) {
        EXPECT_EQ(render_film(scene, camera, deep(16), 48, 48, 8, workers(), static_cast<int>(tier))
                      .hash(),
                  hash)
            << kTiers[tier].name;
    }
    // The control: a tier that lacks what the scene needs does not.
    EXPECT_NE(render_film(scene, camera, deep(16), 48, 48, 8, workers(), 0).hash(), hash);
}

TEST(Scale, PowersOfTwoChangeNoByte) {
    const auto film = [](double scale) {
        SceneBuilder builder;
        const auto s = static_cast<float>(scale);
        Material lamp = SceneBuilder::diffuse(0.2f);
        lamp.emissive_factor = Rgb(5);
        builder.mesh(SceneBuilder::box(Vec3f(-2 * s), Vec3f(2 * s)),
                     builder.material(SceneBuilder::diffuse(0.7f)));
        builder.mesh(SceneBuilder::quad(Vec3f(-0.5f, 1.9f, -0.5f) * s, Vec3f(1, 0, 0) * s,
                                        Vec3f(0, 0, 1) * s),
                     builder.material(lamp));
        Material metal;
        metal.roughness_factor = 0.4f;
        builder.sphere(Vec3d(0.7, -1, 0) * scale, 0.8 * scale, builder.material(metal));
        return render_film(builder.build(workers()),
                           camera_at(Vec3d(0, 0, 1.9) * scale, Vec3d(0), 1.2), deep(16), 32, 32, 4,
                           workers())
            .hash();
    };
    const std::string hash = film(1);
    for (int k : {-20, -7, 3, 20}) EXPECT_EQ(film(std::exp2(k)), hash) << "scale 2^" << k;
}

}  // namespace
}  // namespace talbot
