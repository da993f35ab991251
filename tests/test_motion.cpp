// Motion blur: pictures against integrals over time, and what must not change by it.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "core/io/film_file.h"
#include "core/io/scene_motion.h"
#include "core/session/render_pass.h"
#include "core/session/retrace.h"
#include "core/session/session.h"
#include "tests/io_gltf_builder.h"
#include "tests/program.h"

namespace talbot {
namespace {

using test::GltfBuilder;
using test::Json;
using test::TemporaryFolder;

WorkerPool& workers() {
    static WorkerPool pool;
    return pool;
}

// Node 0 shows a shining quad of one metre, lower left corner at the origin, that goes 2 m along x
// within the first second; node 1 is an orthographic camera that sees 8 m x 8 m round the origin.
struct SweepingQuad : GltfBuilder {
    SweepingQuad() {
        const int material =
            add_material({{"emissiveFactor", {1, 1, 1}},
                          {"doubleSided", true},
                          {"pbrMetallicRoughness", {{"baseColorFactor", {0, 0, 0, 1}}}}});
        add_node(
            {{"mesh", add_mesh(quad_attributes(), quad_indices(), 4, material)}, {"name", "quad"}});
        push("cameras",
             {{"type", "orthographic"},
              {"orthographic", {{"xmag", 4}, {"ymag", 4}, {"znear", 0.1}, {"zfar", 100}}}});
        add_node({{"camera", 0}, {"translation", {0, 0, 5}}});
        root["scenes"][0]["nodes"] = {0, 1};
    }
};

void drive(GltfBuilder& b, int node, const std::vector<float>& times,
           const std::vector<float>& values, const char* interpolation = "LINEAR") {
    b.push(
        "animations",
        {{"name", "Go"},
         {"samplers", Json::array({{{"input", b.add_floats(times, "SCALAR")},
                                    {"output", b.add_floats(values, "VEC3")},
                                    {"interpolation", interpolation}}})},
         {"channels",
          Json::array({{{"sampler", 0}, {"target", {{"node", node}, {"path", "translation"}}}}})}});
}

struct MovingQuad : SweepingQuad {
    MovingQuad() { drive(*this, 0, {0, 1}, {0, 0, 0, 2, 0, 0}); }
};

std::shared_ptr<const Scene> load(const GltfBuilder& b, double open, double shutter) {
    const TemporaryFolder folder;
    LoadOptions options;
    options.animation_time = open;
    options.shutter_seconds = shutter;
    auto file = GltfFile::open(b.write_gltf(folder / "scene.gltf"), options);
    EXPECT_TRUE(file.ok());
    auto desc = (*file)->read(options);
    EXPECT_TRUE(desc.ok());
    auto scene = set_in_motion(Scene::build(std::move(*desc), workers()), *file, options);
    EXPECT_TRUE(scene.ok());
    return *scene;
}

RenderSettings small() {
    RenderSettings settings;
    settings.width = settings.height = 32;
    return settings;
}

Film render(const std::shared_ptr<const Scene>& scene, const RenderSettings& settings,
            uint64_t passes, WorkerPool& pool = workers()) {
    ViewMoments view(prepare_view(scene, scene->cameras().front(), settings, pool));
    Film film(settings.width, settings.height);
    std::stop_source stop;
    TileCounts counts;
    EXPECT_TRUE(render_pass(view, settings, passes, film, pool, stop, {}, counts));
    return film;
}

double mean(const Film& film, uint32_t x, uint32_t y) {
    const FilmPixel& p = film.pixel(x, y);
    return p.sum[0].value() / static_cast<double>(p.samples);
}

// Light of a pixel column of 0.25 m while the quad's left edge goes from `first` to `last`: the
// mean over time of how much of the column it covers.
double covered(uint32_t column, double first, double last) {
    constexpr int kSteps = 100000;
    const double left = -4 + 0.25 * column;
    double sum = 0;
    for (int i = 0; i < kSteps; ++i) {
        const double edge = first + (last - first) * (i + 0.5) / kSteps;
        sum += std::max(0.0, std::min(left + 0.25, edge + 1) - std::max(left, edge)) / 0.25;
    }
    return sum / kSteps;
}

// Of the four rows that the quad covers wholly.
double column_mean(const Film& film, uint32_t x) {
    return 0.25 * (mean(film, x, 12) + mean(film, x, 13) + mean(film, x, 14) + mean(film, x, 15));
}

double largest_gap(const Film& film, double first, double last) {
    double gap = 0;
    for (uint32_t x = 0; x < 32; ++x)
        gap = std::max(gap, std::abs(column_mean(film, x) - covered(x, first, last)));
    return gap;
}

// Moments are spread evenly to one in so many passes. Where in a pixel a sample lies has nothing to
// do with its moment, which matters while an edge crosses the column: the indicator's variance
// there is 1/6 on average. Two edges, four rows, four standard deviations.
double gap_limit(double shutter, uint64_t passes) {
    constexpr double kCrossing = 0.25 / 2;  // seconds
    const double n = static_cast<double>(passes);
    return 4 * std::sqrt(2 * (kCrossing / shutter) / 6 / n / 4) + 1 / n;
}

TEST(Motion, ASweepingQuadLeavesTheIntegralOverTime) {
    constexpr uint64_t kPasses = 256;
    const double limit = gap_limit(1, kPasses);
    const auto gap = [&](double open, double shutter, double first, double last) {
        return largest_gap(render(load(MovingQuad(), open, shutter), small(), kPasses), first,
                           last);
    };
    EXPECT_LT(gap(0, 1, 0, 2), limit);
    EXPECT_LT(gap(0.25, 0.5, 0.5, 1.5), gap_limit(0.5, kPasses));
    // After its last key it stands: half of the time in one place.
    const Film half = render(load(MovingQuad(), 0.5, 1), small(), kPasses);
    for (uint32_t x = 0; x < 32; ++x)
        EXPECT_NEAR(column_mean(half, x), 0.5 * covered(x, 1, 2) + 0.5 * covered(x, 2, 2), limit);
    // The controls: a shutter that opens a twentieth too late, and none at all.
    EXPECT_GT(gap(0.05, 1, 0, 2), limit);
    EXPECT_GT(gap(0, 0, 0, 2), limit);
}

TEST(Motion, ACameraOfTheFileMovesAndOneSetByHandStands) {
    SweepingQuad b;
    drive(b, 1, {0, 1}, {0, 0, 5, -2, 0, 5});
    const auto scene = load(b, 0, 1);
    constexpr uint64_t kPasses = 128;
    EXPECT_LT(largest_gap(render(scene, small(), kPasses), 0, 2), gap_limit(1, kPasses));
    Camera by_hand = scene->cameras().front();
    by_hand.position.x += 1;
    ViewMoments view(prepare_view(scene, by_hand, small(), workers()));
    for (uint64_t i = 0; i < 4; ++i)
        EXPECT_EQ(view.at(i, small(), workers())->camera.position, by_hand.position);
}

TEST(Motion, OnlyWhatChangesMeanwhileIsMotion) {
    EXPECT_NE(load(MovingQuad(), 0, 1)->motion(), nullptr);
    EXPECT_EQ(load(MovingQuad(), 0, 1)->motion()->witness,
              "animation 'Go' drives /nodes/0/translation");
    EXPECT_EQ(load(MovingQuad(), 0, 0)->motion(), nullptr) << "no shutter";
    EXPECT_EQ(load(MovingQuad(), 1, 5)->motion(), nullptr) << "after the last key";
    EXPECT_NE(load(MovingQuad(), 0.99, 0.02)->motion(), nullptr);
    SweepingQuad still;
    drive(still, 0, {0, 1, 2}, {1, 2, 3, 1, 2, 3, 1, 2, 3});
    EXPECT_EQ(load(still, 0, 2)->motion(), nullptr) << "equal keys";
    SweepingQuad there_and_back;
    drive(there_and_back, 0, {0, 1, 2}, {0, 0, 0, 1, 0, 0, 0, 0, 0});
    EXPECT_NE(load(there_and_back, 0, 2)->motion(), nullptr);
    // Equal values, but the spline leaves them on its way.
    SweepingQuad spline;
    drive(spline, 0, {0, 1}, {0, 0, 0, 0, 0, 0, 4, 0, 0, 4, 0, 0, 0, 0, 0, 0, 0, 0}, "CUBICSPLINE");
    EXPECT_NE(load(spline, 0, 1)->motion(), nullptr);
    SweepingQuad step;
    drive(step, 0, {0, 1}, {0, 0, 0, 2, 0, 0}, "STEP");
    EXPECT_EQ(load(step, 0.1, 0.8)->motion(), nullptr);
    EXPECT_NE(load(step, 0.1, 1)->motion(), nullptr);
}

TEST(Motion, IsAnEffectThatCanBeForcedOff) {
    const auto moving = load(MovingQuad(), 0, 1);
    const auto still = load(MovingQuad(), 0, 0);
    RenderSettings settings = small();
    const PreparedView view = prepare_view(moving, moving->cameras().front(), settings, workers());
    EXPECT_TRUE(view.effects.active.has(Effect::motion));
    EXPECT_FALSE(analyse_effects(*still, still->cameras().front()).active.has(Effect::motion));
    const std::string blurred = render(moving, settings, 8).hash();
    settings.forced_off.add(Effect::motion);
    const std::string off = render(moving, settings, 8).hash();
    EXPECT_EQ(off, render(still, small(), 8).hash());
    EXPECT_NE(off, blurred);
}

TEST(Motion, SameBytesForThreadsTilesHalvesAndReplays) {
    const auto scene = load(MovingQuad(), 0, 1);
    const std::string hash = render(scene, small(), 16).hash();
    for (const unsigned threads : {1u, 3u}) {
        WorkerPool pool(threads);
        EXPECT_EQ(render(scene, small(), 16, pool).hash(), hash);
    }
    SessionPolicy policy;
    policy.interactive = true;
    RenderSession session(policy);
    RenderSettings settings = small();
    settings.tile_size = 8;
    session.submit(SetSettings{settings});
    session.submit(SetPassLimit{7});
    ASSERT_TRUE(session.wait_for(session.submit(SetScene{scene, scene->cameras().front()}), 7, 60));
    ASSERT_TRUE(session.wait_for(session.submit(SetPassLimit{16}), 16, 60));
    session.with_film([&](const FilmView& view) { EXPECT_EQ(view.film.hash(), hash); });

    // A sample again, alone.
    Retracer retracer;
    settings.first_sample = 5;
    const Film one = render(scene, settings, 1);
    for (uint32_t x = 0; x < 32; ++x) {
        const ReplayedPath path = retracer.path(scene, scene->cameras().front(), small(), x, 14, 5);
        EXPECT_EQ(static_cast<double>(path.radiance.x), mean(one, x, 14)) << x;
    }
}

TEST(Motion, EditsHoldAtEveryMoment) {
    const auto scene = load(MovingQuad(), 0, 1);
    const uint32_t index = scene->geometry().instances.front().material;
    Material dim = scene->materials()[index];
    dim.emissive_factor = Rgb(0.25f);
    const auto edited = scene->with_material(index, dim);
    const Film full = render(scene, small(), 16), quarter = render(edited, small(), 16);
    for (uint32_t x = 0; x < 32; ++x)
        EXPECT_EQ(mean(quarter, x, 14), 0.25 * mean(full, x, 14)) << x;
}

TEST(Motion, PartsOfARenderMergeToTheWhole) {
    const TemporaryFolder folder;
    const std::string scene = MovingQuad().write_gltf(folder / "scene.gltf").string();
    const auto film = [&](const char* name, const std::string& options) {
        const std::string file = (folder / name).string();
        const program::Outcome done = program::run(
            "'" + scene + "' --size 32x32" +
            std::string(options.find("--shutter") == std::string::npos ? " --shutter 1 " : " ") +
            options + " --film '" + file + "'");
        EXPECT_EQ(done.code, 0) << done.output;
        return file;
    };
    const std::string whole = film("whole.film", "--frames 12");
    const std::string first = film("first.film", "--frames 5");
    const std::string second = film("second.film", "--frames 7 --first-sample 5");
    const std::string merged = (folder / "merged.film").string();
    EXPECT_EQ(program::run("merge '" + merged + "' '" + first + "' '" + second + "'").code, 0);
    const auto a = load_film(whole), b = load_film(merged);
    ASSERT_TRUE(a.ok() && b.ok());
    EXPECT_EQ(a->film.hash(), b->film.hash());
    // Another shutter is another picture.
    const std::string other = film("other.film", "--frames 7 --first-sample 5 --shutter 0.5");
    const program::Outcome refused =
        program::run("merge '" + merged + "' '" + first + "' '" + other + "'");
    EXPECT_EQ(refused.code, 3) << refused.output;
    for (const char* bad : {"-1", "nan", "inf", "x"}) {
        EXPECT_EQ(program::run("'" + scene + "' --frames 1 --shutter " + bad).code, 2) << bad;
    }
}

}  // namespace
}  // namespace talbot
