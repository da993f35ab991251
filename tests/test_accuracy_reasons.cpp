// What an error is made of, and what a biased switch costs: light sorted by kind of path adds up to
// the sample, known scenes have the kinds that they must have, crossing times follow closed forms.
#include <gtest/gtest.h>

#include <map>

#include "core/integrate/path_kinds.h"
#include "core/session/bias_ledger.h"
#include "core/session/error_shares.h"
#include "core/session/render_pass.h"
#include "oracles/scene_builder.h"

namespace talbot {
namespace {

WorkerPool& workers() {
    static WorkerPool pool(2);
    return pool;
}

// A closed grey room with a lamp in the ceiling; in it a mirror or glass ball, or none.
std::shared_ptr<const Scene> room(const Material* ball) {
    SceneBuilder builder;
    builder.mesh(SceneBuilder::box(Vec3f(-2), Vec3f(2)),
                 builder.material(SceneBuilder::diffuse(0.6f)));
    Material lamp = SceneBuilder::diffuse(0);
    lamp.emissive_factor = Rgb(5);
    builder.mesh(SceneBuilder::quad(Vec3f(-0.5f, 1.9f, -0.5f), Vec3f(1, 0, 0), Vec3f(0, 0, 1)),
                 builder.material(lamp));
    if (ball != nullptr) builder.sphere(Vec3d(0, -0.8, -0.5), 0.7, builder.material(*ball));
    return builder.build(workers());
}

Material mirror() {
    Material m;
    m.metallic_factor = 1;
    m.roughness_factor = 0;
    return m;
}

Camera camera() {
    return camera_at(Vec3d(0, 0, 1.9), Vec3d(0), 1.6);
}

RenderSettings small() {
    RenderSettings settings;
    settings.width = 40;
    settings.height = 30;
    return settings;
}

struct Sorted {
    std::map<PathKind, double> light;
    double whole = 0;
    double worst = 0;  // |sum of parts - sample| over the sample
};

Sorted sort_all(const std::shared_ptr<const Scene>& scene, const RenderSettings& settings) {
    const RenderScene rs(scene);
    const CameraRays rays(camera(), scene->origin(), settings.width, settings.height,
                          scene->geometry().bounds);
    const PathSettings path = path_settings(settings);
    PathSorter sorter(rs, rays, path);
    // The kernel's own film, which the sorted samples must give again.
    Film film(settings.width, settings.height);
    std::stop_source stop;
    TileCounts counts;
    const std::size_t tier = smallest_tier(analyse_effects(*scene, camera()).active);
    render_pass({rs, camera(), settings, tier, 8}, film, workers(), stop, {}, counts);
    Sorted sorted;
    for (uint32_t y = 0; y < settings.height; ++y) {
        for (uint32_t x = 0; x < settings.width; ++x) {
            double pixel = 0;
            for (uint64_t s = 0; s < 8; ++s) {
                const PathSample sample = sorter.trace(x, y, s);
                Rgb sum(0);
                for (const PathSorter::Part& part : sorter.parts()) {
                    sum += part.radiance;
                    sorted.light[part.kind] += static_cast<double>(part.radiance.x);
                }
                sorted.whole += static_cast<double>(sample.Li.x);
                pixel += static_cast<double>(sample.Li.x);
                if (sample.Li.x > 0)
                    sorted.worst =
                        std::max(sorted.worst, double(std::abs(sum.x - sample.Li.x) / sample.Li.x));
            }
            EXPECT_NEAR(pixel, film.pixel(x, y).sum[0].value(), 1e-12 + 1e-12 * pixel);
        }
    }
    return sorted;
}

TEST(AccuracyReasons, PartsAddUpToTheSample) {
    const Material ball = mirror();
    for (const bool nee : {true, false}) {
        RenderSettings settings = small();
        settings.next_event_estimation = nee;
        const Sorted sorted = sort_all(room(&ball), settings);
        EXPECT_LT(sorted.worst, 1e-5);
        double sum = 0;
        for (const auto& [kind, light] : sorted.light) sum += light;
        EXPECT_NEAR(sum / sorted.whole, 1, 1e-6);
    }
}

TEST(AccuracyReasons, KindsAreThoseOfTheScene) {
    Sorted plain = sort_all(room(nullptr), small());
    EXPECT_EQ(plain.light[PathKind::caustic], 0);
    EXPECT_EQ(plain.light[PathKind::mirrored], 0);
    EXPECT_GT(plain.light[PathKind::direct], 0);
    EXPECT_GT(plain.light[PathKind::indirect], 0);
    EXPECT_GT(plain.light[PathKind::seen], 0);
    const Material ball = mirror();
    Sorted mirrored = sort_all(room(&ball), small());
    EXPECT_GT(mirrored.light[PathKind::caustic], 0);
    EXPECT_GT(mirrored.light[PathKind::mirrored], 0);
    // A path of one vertex has no indirect light, whoever finds the lamp.
    RenderSettings shallow = small();
    shallow.max_depth = 1;
    for (const bool nee : {true, false}) {
        shallow.next_event_estimation = nee;
        Sorted direct = sort_all(room(nullptr), shallow);
        EXPECT_EQ(direct.light[PathKind::indirect], 0);
        EXPECT_GT(direct.light[PathKind::direct], 0);
    }
}

const ErrorShare& row(const std::vector<ErrorShare>& list, const std::string& name) {
    for (const ErrorShare& share : list) {
        if (share.name == name) return share;
    }
    ADD_FAILURE() << "no row " << name;
    return list.front();
}

TEST(AccuracyReasons, SharesNameWhatIsNoisyAndWhatHelps) {
    const Material ball = mirror();
    ErrorSharePolicy policy;
    policy.budget_seconds = 1;
    policy.pixels = 1200;
    const ErrorShares shares =
        measure_error_shares(room(&ball), camera(), small(), policy, workers());
    ASSERT_TRUE(shares.valid);
    double error = 0, light = 0;
    for (const ErrorShare& s : shares.kinds) {
        error += s.error;
        light += s.light;
    }
    EXPECT_NEAR(error, 1, 1e-6);
    EXPECT_NEAR(light, 1, 1e-6);
    // Caustics of a mirror ball are a small part of the light and a large one of the error.
    const ErrorShare& caustic = row(shares.kinds, "caustic");
    EXPECT_GT(caustic.error, 3 * caustic.light);
    // Without light sampling it is what helps, and by far.
    RenderSettings blind = small();
    blind.next_event_estimation = false;
    const ErrorShares by_chance =
        measure_error_shares(room(nullptr), camera(), blind, policy, workers());
    EXPECT_EQ(by_chance.help, "without --no-nee");
    EXPECT_GT(by_chance.help_factor, 2);
    std::stop_source stop;
    stop.request_stop();
    EXPECT_FALSE(
        measure_error_shares(room(nullptr), camera(), small(), policy, workers(), stop.get_token())
            .valid);
}

ConvergenceFit law(double v1) {
    ConvergenceFit fit;
    fit.samples = 1;
    fit.v = v1;
    fit.terms[0] = {1, 1};
    return fit;
}

TEST(AccuracyReasons, LossBeginsWhereTheCurvesCross) {
    // floor^2 + 1 / t = 2 / t at t = 1 / floor^2; a sample of the biased side costs a half.
    EXPECT_NEAR(loss_after(law(1), 1, 5, law(2), 1), 400, 0.1);
    EXPECT_NEAR(loss_after(law(2), 0.5, 5, law(2), 1), 400, 0.1);
    // It never pays where it gains nothing, and always where it costs nothing.
    EXPECT_EQ(loss_after(law(2), 1, 5, law(2), 1), 0);
    EXPECT_EQ(loss_after(law(1), 1, 0, law(2), 1), HUGE_VAL);
}

TEST(AccuracyReasons, LedgerHoldsTheSwitchesThatAreOn) {
    EXPECT_TRUE(measure_bias(room(nullptr), camera(), small(), 0, workers()).empty());
    RenderSettings shallow = small();
    shallow.max_depth = 1;
    const std::vector<BiasEntry> ledger =
        measure_bias(room(nullptr), camera(), shallow, 0, workers());
    ASSERT_EQ(ledger.size(), 1u);
    EXPECT_EQ(ledger[0].name, "max-depth 1");
    EXPECT_TRUE(ledger[0].floor.significant);
    EXPECT_GT(ledger[0].floor.relrmse_percent, 5);
    ASSERT_TRUE(ledger[0].loss_after_seconds.has_value());
    EXPECT_LT(*ledger[0].loss_after_seconds, 60);
    // The limit can be so high that nothing is lost.
    shallow.max_depth = 63;
    const std::vector<BiasEntry> deep =
        measure_bias(room(nullptr), camera(), shallow, 0, workers());
    ASSERT_EQ(deep.size(), 1u);
    EXPECT_FALSE(deep[0].floor.significant);
    EXPECT_FALSE(deep[0].loss_after_seconds.has_value());
}

}  // namespace
}  // namespace talbot
