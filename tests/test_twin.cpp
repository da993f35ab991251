// The double twin: that it is one, that the comparison sees planted defects, and the command.
#include <gtest/gtest.h>

#include <cmath>

#include "core/io/gltf_loader.h"
#include "oracles/scene_builder.h"
#include "oracles/twin/compare_twins.h"
#include "tests/program.h"

namespace talbot {
namespace {

constexpr twin::Budget kBudget{24, 24, 8};
// Without glass.
constexpr double kTogether = 1e-5;

SceneDesc load(const std::string& name) {
    Result<SceneDesc> desc = load_gltf(TALBOT_SOURCE_DIR "/assets/scenes/" + name);
    EXPECT_TRUE(desc) << desc.error().line();
    return *desc;
}

// `own` in float against `twin` in double.
twin::Comparison compare(const SceneDesc& own, const SceneDesc& twin, const Camera& camera,
                         const PathSettings& own_settings = {}) {
    WorkerPool pool(2);
    PathSettings settings;
    const auto a =
        twin::make_float_tracer(own, camera, own_settings, kBudget.width, kBudget.height, pool);
    const auto b = twin::make_double_tracer(twin, camera, settings, kBudget.width, kBudget.height);
    ++settings.seed;
    const auto c = twin::make_double_tracer(twin, camera, settings, kBudget.width, kBudget.height);
    return twin::compare_twins(*a, *b, *c, kBudget, pool);
}

TEST(Twin, CalculatesInDouble) {
    SceneBuilder builder;
    builder.sphere(Vec3d(0.1, 0.2, 0.3), 0.7, builder.material(SceneBuilder::diffuse(0.5f)));
    builder.environment(Rgb(1));
    const Camera camera = camera_at(Vec3d(3, 2, 4), Vec3d(0.1, 0.2, 0.3), 0.3);
    WorkerPool pool(1);
    const auto own = twin::make_float_tracer(builder.desc(), camera, {}, 16, 16, pool);
    const auto twin = twin::make_double_tracer(builder.desc(), camera, {}, 16, 16);
    // Re-centred at the origin that both choose: that of the sphere up to a step.
    const Vec3d center = Vec3d(0.1, 0.2, 0.3) - builder.build(pool)->origin();
    double own_error = 0;
    double twin_error = 0;
    int hits = 0;
    for (uint32_t i = 0; i < 256; ++i) {
        const twin::Path a = own->trace(i % 16, i / 16, 0);
        const twin::Path b = twin->trace(i % 16, i / 16, 0);
        ASSERT_EQ(a.steps.empty(), b.steps.empty());
        if (!a.steps[0].found || !b.steps[0].found) continue;
        ++hits;
        own_error = std::max(own_error, std::abs(length(a.steps[0].p - center) - 0.7));
        twin_error = std::max(twin_error, std::abs(length(b.steps[0].p - center) - 0.7));
    }
    EXPECT_GT(hits, 100);
    EXPECT_LT(twin_error, 1e-15);
    EXPECT_GT(own_error, 1e-9);
    EXPECT_LT(own_error, 1e-6);
}

TEST(Twin, FloatDrownsInTheNoiseOfBuiltInScenes) {
    for (const char* name : {"cornell.gltf", "spheres.gltf", "report.gltf"}) {
        const SceneDesc desc = load(name);
        const twin::Comparison c = compare(desc, desc, desc.cameras.at(0));
        EXPECT_EQ(c.samples, 24u * 24u * 8u);
        EXPECT_EQ(c.nonfinite, 0u);
        EXPECT_GT(c.noise, 0) << name;
        EXPECT_LE(c.share_of_noise(), 0.1) << name;
        EXPECT_GT(c.together, 0) << name << ": both in one precision?";
        EXPECT_LE(c.together, kTogether) << name;
        EXPECT_LE(c.parted_share(), 0.02) << name;
        EXPECT_LE(std::abs(c.bias), 4.5 * c.bias_error + kTogether) << name;
    }
}

TEST(Twin, PlantedDefectsAreSeen) {
    const SceneDesc desc = load("cornell.gltf");
    const Camera camera = desc.cameras.at(0);
    // Corners that lost their last bits, as in a scene baked 10 km from the origin.
    SceneDesc coarse = desc;
    for (Mesh& mesh : coarse.meshes) {
        for (Vec3f& p : mesh.positions) p = (p + Vec3f(1e4f)) - Vec3f(1e4f);
    }
    EXPECT_GT(compare(coarse, desc, camera).together, kTogether);
    // A reflectance off by a thousandth.
    SceneDesc darker = desc;
    for (Material& m : darker.materials) m.base_color_factor *= 0.999f;
    EXPECT_GT(compare(darker, desc, camera).together, kTogether);
    // Other random numbers: every sample is another one, and the difference is noise.
    PathSettings other;
    other.seed = 7;
    const twin::Comparison c = compare(desc, desc, camera, other);
    EXPECT_GT(c.parted_share(), 0.5);
    EXPECT_GT(c.share_of_noise(), 0.1);
}

twin::Path path_of(std::vector<twin::Step> steps) {
    twin::Path path;
    path.steps = std::move(steps);
    if (!path.steps.empty()) path.radiance = path.steps.back().radiance;
    return path;
}

TEST(Twin, PartingsAreFoundAndNamed) {
    twin::Step hit;
    hit.found = true;
    hit.goes_on = true;
    hit.wi = glm::dvec3(0, 0, 1);
    hit.radiance = glm::dvec3(1);
    const twin::Path path = path_of({hit, hit, hit});
    uint32_t vertex = 0;
    twin::Parting why = twin::Parting::surface;
    EXPECT_FALSE(twin::find_parting(path, path, vertex, why));

    const auto expect = [&](const twin::Path& other, uint32_t at, twin::Parting reason) {
        ASSERT_TRUE(twin::find_parting(other, path, vertex, why));
        EXPECT_EQ(vertex, at);
        EXPECT_EQ(why, reason);
    };
    twin::Path other = path;
    other.steps[1].primitive = 5;
    expect(other, 1, twin::Parting::surface);
    other = path;
    other.steps[2].found = false;
    expect(other, 2, twin::Parting::surface);
    other = path;
    other.steps[0].transmitted = true;
    expect(other, 0, twin::Parting::lobe);
    other = path;
    other.steps[1].wi = glm::dvec3(0, std::sin(0.2), std::cos(0.2));
    expect(other, 1, twin::Parting::direction);
    other = path;
    other.steps[1].radiance = glm::dvec3(1.1);
    expect(other, 1, twin::Parting::light);
    other = path;
    other.steps.pop_back();
    expect(other, 1, twin::Parting::roulette);
}

TEST(TwinCommand, ComparesASceneAndWritesWhatItFound) {
    const program::Folder folder("twin");
    const std::string json = folder / "twin.json";
    const std::string picture = folder / "difference.exr";
    const program::Outcome run =
        program::run("hardcases --twin " TALBOT_SOURCE_DIR
                     "/assets/scenes/cornell.gltf --size 16x16 --frames 4 --json " +
                     json + " --difference " + picture);
    EXPECT_EQ(run.code, 0) << run.output;
    EXPECT_NE(run.output.find("KEPT"), std::string::npos) << run.output;
    const nlohmann::json j = program::read_json(json);
    EXPECT_EQ(j["schema"], "talbot-twin/1");
    EXPECT_EQ(j["samples"], 16 * 16 * 4);
    EXPECT_EQ(j["kept"], true);
    EXPECT_TRUE(program::fs::exists(picture));
    EXPECT_EQ(program::run("hardcases --twin /no/such.gltf").code, 3);
    EXPECT_EQ(program::run("hardcases --difference x.exr").code, 2);
    EXPECT_EQ(program::run("hardcases --twin x.gltf --scene y.gltf").code, 2);
}

}  // namespace
}  // namespace talbot
