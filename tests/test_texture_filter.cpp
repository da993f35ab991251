// Texture filtering by ray cones: the level of a lookup against areas measured with rays, how cones
// go on at surfaces, and what filtering does to pictures.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <glm/gtc/matrix_transform.hpp>

#include "core/integrate/path_observer.h"
#include "core/session/bias_ledger.h"
#include "core/session/prepared_view.h"
#include "oracles/scene_builder.h"
#include "tests/effect_scenes.h"
#include "tests/program.h"

namespace talbot {
namespace {

namespace fs = std::filesystem;

WorkerPool& workers() {
    static WorkerPool pool(2);
    return pool;
}

std::array<int, 4> black_or_white(uint32_t x, uint32_t y) {
    const int v = (x / 8 + y / 8) % 2 == 0 ? 240 : 15;
    return {v, v, v, 255};
}

// --- The level of a lookup ---------------------------------------------------------------------

// The texture coordinates, by surface, that a ray of the image meets.
using UvAt = std::function<Vec2d(double px, double py)>;

// Half the logarithm of the number of texels of an image of `side` texels a side that pixel (x, y)
// covers: the area in texture space of what its corners' rays meet.
double measured_level(const UvAt& uv_at, double x, double y, double side) {
    // A small piece about the pixel's middle, so that perspective within it does not matter.
    constexpr double kPart = 0.01;
    const Vec2d middle(x + 0.5, y + 0.5);
    Vec2d corner[4];
    const Vec2d offset[4] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
    for (int i = 0; i < 4; ++i) {
        const Vec2d at = middle + 0.5 * kPart * offset[i];
        corner[i] = uv_at(at.x, at.y) * side / kPart;
    }
    double twice = 0;
    for (int i = 0; i < 4; ++i) {
        const Vec2d& a = corner[i];
        const Vec2d& b = corner[(i + 1) % 4];
        twice +=
            (a.x - corner[0].x) * (b.y - corner[0].y) - (b.x - corner[0].x) * (a.y - corner[0].y);
    }
    return 0.5 * std::log2(0.5 * std::abs(twice));
}

constexpr uint32_t kWidth = 64, kHeight = 48;
constexpr uint32_t kSide = 64;

struct LevelScene {
    std::shared_ptr<const Scene> scene;
    Camera camera;
    TextureSlot slot;
};

// The level that the kernels take at the middle of a pixel; empty where nothing is hit.
std::optional<double> level_at(const LevelScene& s, const RenderScene& rs, uint32_t x, uint32_t y) {
    const CameraRays rays(s.camera, s.scene->origin(), kWidth, kHeight, s.scene->geometry().bounds);
    const Ray ray = rays.ray(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f, Vec2f(0));
    Hit hit;
    if (!s.scene->accel().closest(ray, hit)) return std::nullopt;
    RayCone cone = rays.cone(ray);
    cone.advance(hit.t);
    const SurfaceInteraction si = make_surface_interaction<kFullTier>(*s.scene, ray, hit);
    const FilteredPoint at =
        texture_point(si, texture_footprint(*s.scene, rs.pyramids(), si, ray.d, cone));
    const TexturePyramid* pyramid = rs.pyramids()->find(s.slot.texture, TexelMean::srgb);
    return static_cast<double>(texture_level(at, s.slot, *pyramid));
}

// The same texture coordinates by the scene's own rays, which are tested elsewhere.
Vec2d uv_by_rays(const LevelScene& s, double px, double py) {
    const CameraRays rays(s.camera, s.scene->origin(), kWidth, kHeight, s.scene->geometry().bounds);
    const Ray ray = rays.ray(static_cast<float>(px), static_cast<float>(py), Vec2f(0));
    Hit hit;
    if (!s.scene->accel().closest(ray, hit)) return Vec2d(NAN);
    const SurfaceInteraction si = make_surface_interaction<kFullTier>(*s.scene, ray, hit);
    const Vec2f uv = si.uv[s.slot.uv_set];
    return Vec2d(s.slot.apply(uv));
}

// Shapes of one material, which has the chequers in that slot.
LevelScene chequered_scene(
    Camera camera, TextureSlot slot,
    const std::function<void(SceneBuilder&, uint32_t material)>& add_shapes) {
    SceneBuilder builder;
    slot.texture = add_texture(builder.desc(), kSide, black_or_white);
    Material m = SceneBuilder::diffuse(1);
    m.base_color_texture = slot;
    add_shapes(builder, builder.material(m));
    return {builder.build(workers()), std::move(camera), slot};
}

// A floor of 100 m by 100 m; what is used twice and large is placed through a second level.
LevelScene floor_scene(Camera camera, TextureSlot slot, const Mat4d& placed, bool twice) {
    Mesh mesh = SceneBuilder::quad(Vec3f(-50, 0, 50), Vec3f(100, 0, 0), Vec3f(0, 0, -100));
    mesh.uv[0] = {Vec2f(0, 0), Vec2f(40, 0), Vec2f(40, 25), Vec2f(0, 25)};
    mesh.uv[1] = {Vec2f(0, 0), Vec2f(3, 0), Vec2f(3, 90), Vec2f(0, 90)};
    if (twice) {
        mesh = detail::fine_grid();
        for (Vec3f& p : mesh.positions) {
            const Vec2f at(p.x + 0.5f, p.y + 0.5f);
            mesh.uv[0].push_back(at * Vec2f(40, 25));
            mesh.uv[1].push_back(at * Vec2f(3, 90));
            p = Vec3f(100 * p.x, 0, -100 * p.y);
        }
    }
    return chequered_scene(std::move(camera), slot, [&](SceneBuilder& builder, uint32_t material) {
        builder.mesh(mesh, material, placed);
        if (twice) builder.instance(0, glm::translate(Mat4d(1.0), Vec3d(0, -60, 0)));
    });
}

// The largest deviation over the image of a scene's levels from measured ones.
double worst_level(const LevelScene& s, const UvAt& uv_at, int& pixels) {
    const RenderScene rs(s.scene, nullptr, {}, {},
                         make_texture_pyramids(*s.scene, workers(), nullptr));
    double worst = 0;
    pixels = 0;
    for (uint32_t y = 1; y < kHeight; y += 3) {
        for (uint32_t x = 1; x < kWidth; x += 5) {
            const std::optional<double> level = level_at(s, rs, x, y);
            const double want = measured_level(uv_at, x, y, kSide);
            if (!level || !std::isfinite(want)) continue;
            ++pixels;
            worst = std::max(worst, std::abs(*level - want));
        }
    }
    return worst;
}

TEST(TextureLevel, OfAFloorInClosedForm) {
    // A pinhole 3 m above a floor: where the ray through a pixel meets it, by hand.
    const Camera camera = camera_at(Vec3d(0, 3, 0), Vec3d(2, 0, -6), 0.9);
    const LevelScene s = floor_scene(camera, {}, Mat4d(1.0), false);
    const auto uv_at = [&](double px, double py, double bend) {
        const double half = std::tan(0.45);
        const Vec3d d = camera.right * ((2 * px / kWidth - 1) * half * kWidth / kHeight) +
                        camera.up * ((1 - 2 * py / kHeight) * half) - camera.backward;
        const Vec3d p = camera.position - d * (3 / d.y);
        return d.y < 0 ? Vec2d((p.x + 50) * 0.4, (50 - p.z) * 0.25 * bend) : Vec2d(NAN);
    };
    int pixels = 0;
    EXPECT_LT(worst_level(
                  s, [&](double x, double y) { return uv_at(x, y, 1); }, pixels),
              0.002);
    EXPECT_GT(pixels, 100);
    // The control: a texture that is twice as dense in one direction is half a level away.
    const double wrong = worst_level(
        s, [&](double x, double y) { return uv_at(x, y, 2); }, pixels);
    EXPECT_NEAR(wrong, 0.5, 0.01);
}

TEST(TextureLevel, OfPlacedTransformedAndSecondCoordinates) {
    Camera perspective = camera_at(Vec3d(1, 4, 3), Vec3d(2, 0, -6), 0.9);
    perspective.lens_shift = Vec2d(0.3, -0.2);
    Camera far = camera_at(Vec3d(100, 400, 300), Vec3d(2, 0, -6), 0.02);
    Camera orthographic = camera_at(Vec3d(1, 4, 3), Vec3d(2, 0, -6));
    orthographic.kind = CameraKind::orthographic;
    orthographic.xmag = 3;
    orthographic.ymag = 2;
    TextureSlot second;
    second.uv_set = 1;
    TextureSlot transformed;
    transformed.has_transform = true;
    transformed.transform_u = Vec3f(0.2f, 1.5f, 0.3f);
    transformed.transform_v = Vec3f(-2.5f, 0.1f, 0);
    const Mat4d stretched =
        glm::rotate(glm::scale(Mat4d(1.0), Vec3d(0.3, 1, 2)), 0.7, Vec3d(0, 1, 0));
    for (const Camera& camera : {perspective, far, orthographic}) {
        for (const TextureSlot& slot : {TextureSlot{}, second, transformed}) {
            for (const bool twice : {false, true}) {
                const LevelScene s = floor_scene(camera, slot, stretched, twice);
                EXPECT_EQ(s.scene->geometry().instances[0].identity, !twice);
                int pixels = 0;
                const double worst = worst_level(
                    s, [&](double x, double y) { return uv_by_rays(s, x, y); }, pixels);
                // Differences of float coordinates.
                EXPECT_LT(worst, 0.1);
                EXPECT_GT(pixels, 100);
            }
        }
    }
}

TEST(TextureLevel, OfASphere) {
    const LevelScene s = chequered_scene(
        camera_at(Vec3d(-3, 2, 6), Vec3d(0), 0.6), {},
        [](SceneBuilder& builder, uint32_t material) { builder.sphere(Vec3d(0), 2.5, material); });
    int pixels = 0;
    EXPECT_LT(worst_level(
                  s, [&](double x, double y) { return uv_by_rays(s, x, y); }, pixels),
              0.1);
    EXPECT_GT(pixels, 80);
}

TEST(TextureLevel, WhereThereAreNoCoordinatesNothingIsFiltered) {
    const LevelScene s = chequered_scene(
        camera_at(Vec3d(0, 0, 3), Vec3d(0)), {}, [](SceneBuilder& builder, uint32_t material) {
            builder.mesh(SceneBuilder::quad(Vec3f(-1, -1, 0), Vec3f(2, 0, 0), Vec3f(0, 2, 0)),
                         material);
        });
    const RenderScene rs(s.scene, nullptr, {}, {},
                         make_texture_pyramids(*s.scene, workers(), nullptr));
    const std::optional<double> level = level_at(s, rs, kWidth / 2, kHeight / 2);
    ASSERT_TRUE(level.has_value());
    EXPECT_FALSE(*level > 0);
}

struct ConeRecorder final : PathObserver {
    struct Step {
        RayCone cone;  // at the ray's origin
        float t;
        float pdf;
        bool delta;
    };
    std::vector<Step> steps;

    void ray(uint32_t, const Ray&, bool, const Hit& hit, const PathState& path) override {
        steps.push_back({path.cone, hit.t, 0, false});
    }
    void vertex(uint32_t, const SurfaceInteraction&, const Material&, const ShadingParams&,
                const std::optional<BsdfSample>& scattered, const PathState&) override {
        if (!scattered) return;
        steps.back().pdf = scattered->pdf;
        steps.back().delta = scattered->delta;
    }
};

// A corridor of two walls that face each other, of one material.
std::shared_ptr<const Scene> corridor(const Material& m) {
    SceneBuilder builder;
    const uint32_t index = builder.material(m);
    builder.mesh(SceneBuilder::quad(Vec3f(-50, -50, -2), Vec3f(100, 0, 0), Vec3f(0, 100, 0)),
                 index);
    builder.mesh(SceneBuilder::quad(Vec3f(-50, -50, 2), Vec3f(100, 0, 0), Vec3f(0, 100, 0)), index);
    return builder.build(workers());
}

std::vector<ConeRecorder::Step> cones_of(const Material& m, uint64_t sample) {
    const auto scene = corridor(m);
    const RenderScene rs(scene);
    const CameraRays rays(camera_at(Vec3d(0), Vec3d(1, 0.5, -2)), scene->origin(), kWidth, kHeight,
                          scene->geometry().bounds);
    PathSettings settings;
    settings.max_depth = 5;
    settings.russian_roulette = false;
    ConeRecorder recorder;
    observe_path(rs, rays, settings, kWidth / 2, kHeight / 2, sample, recorder);
    return recorder.steps;
}

TEST(RayCones, MirrorsKeepTheSpreadAndOthersAddTheirShare) {
    Material mirror = SceneBuilder::diffuse(1);
    mirror.metallic_factor = mirror.specular_factor = 1;
    mirror.roughness_factor = 0;
    Material satin = mirror;
    satin.roughness_factor = 0.3f;
    const Material matte = SceneBuilder::diffuse(0.9f);
    double satin_spread = 0, matte_spread = 0;
    for (uint64_t sample = 0; sample < 32; ++sample) {
        for (const Material* m : std::array<const Material*, 3>{&mirror, &satin, &matte}) {
            const std::vector<ConeRecorder::Step> steps = cones_of(*m, sample);
            for (std::size_t i = 1; i < steps.size(); ++i) {
                const ConeRecorder::Step& before = steps[i - 1];
                const RayCone& now = steps[i].cone;
                EXPECT_EQ(before.delta, m == &mirror);
                EXPECT_FLOAT_EQ(now.width, before.cone.width + before.t * before.cone.spread);
                const double grown = static_cast<double>(now.spread - before.cone.spread);
                if (m == &mirror) {
                    EXPECT_EQ(grown, 0);
                    continue;
                }
                // The side of a square of the solid angle that the direction stands for.
                EXPECT_NEAR(grown, kConeShare / std::sqrt(static_cast<double>(before.pdf)),
                            1e-5 * (1 + grown));
                if (i == 1) (m == &satin ? satin_spread : matte_spread) += grown / 32;
            }
        }
    }
    EXPECT_GT(matte_spread, 2 * satin_spread);
    EXPECT_GT(satin_spread, 0.001);
}

// --- Pictures ----------------------------------------------------------------------------------

struct Floor {
    static constexpr uint32_t kFloorWidth = 96, kFloorHeight = 54;
    std::shared_ptr<const Scene> scene;
    Camera camera = camera_at(Vec3d(0, 1.6, 0), Vec3d(0, 1.2, -5), 0.9);

    Floor() {
        SceneBuilder builder;
        builder.environment(Rgb(1));
        Material m = SceneBuilder::diffuse(1);
        m.base_color_texture = slot_of(add_texture(builder.desc(), kSide, black_or_white));
        Mesh mesh = SceneBuilder::quad(Vec3f(-200, 0, 2), Vec3f(400, 0, 0), Vec3f(0, 0, -400));
        mesh.uv[0] = {Vec2f(0, 0), Vec2f(50, 0), Vec2f(50, 50), Vec2f(0, 50)};
        builder.mesh(mesh, builder.material(m));
        scene = builder.build(workers());
    }
    RenderSettings settings(TextureFiltering filter, uint64_t seed = 0) const {
        RenderSettings s;
        s.width = kFloorWidth;
        s.height = kFloorHeight;
        s.texture_filter = filter;
        s.seed = seed;
        return s;
    }
    PreparedView view(const RenderSettings& s, const PreparedView* previous = nullptr) const {
        return prepare_view(scene, camera, s, workers(), previous);
    }
};

double value(const Film& film, uint32_t x, uint32_t y) {
    const FilmPixel& p = film.pixel(x, y);
    return p.sum[0].value() / static_cast<double>(p.samples);
}

// Mean squared difference over rows of the floor: far ones, or all.
double far_error(const Film& film, const Film& reference) {
    double sum = 0;
    // The horizon is in row 21 or so; ten rows below it what is far away ends.
    for (uint32_t y = 18; y < 32; ++y) {
        for (uint32_t x = 0; x < Floor::kFloorWidth; ++x) {
            const double d = value(film, x, y) - value(reference, x, y);
            sum += d * d;
        }
    }
    return sum / (14 * Floor::kFloorWidth);
}

TEST(TextureFilter, AFarFloorIsNearerToItsConvergedPicture) {
    const Floor floor;
    const RenderSettings plain = floor.settings(TextureFiltering::none, 7);
    const Film reference = render_view(floor.view(plain), plain, 1024, workers());
    double unfiltered = 0, filtered = 0, wrong = 0;
    for (uint64_t seed = 0; seed < 4; ++seed) {
        const RenderSettings off = floor.settings(TextureFiltering::none, seed);
        unfiltered += far_error(render_view(floor.view(off), off, 4, workers()), reference);
        const RenderSettings on = floor.settings(TextureFiltering::cones, seed);
        const PreparedView view = floor.view(on);
        EXPECT_EQ(kTiers[view.tier].name, "filtered");
        filtered += far_error(render_view(view, on, 4, workers()), reference);
        // The control: levels that are too coarse by a factor of 16.
        const TexturePyramid* pyramid = view.pyramids->find(0, TexelMean::srgb);
        const_cast<TexturePyramid*>(pyramid)->log2_side += 4;
        wrong += far_error(render_view(view, on, 4, workers()), reference);
    }
    EXPECT_LT(filtered, 0.5 * unfiltered);
    EXPECT_GT(wrong, 0.5 * unfiltered);
    std::printf("mean squared error: unfiltered %.5f, filtered %.5f, four levels off %.5f\n",
                unfiltered / 4, filtered / 4, wrong / 4);
}

TEST(TextureFilter, GivesTheSameBytesForAnyThreadsAndTiles) {
    const Floor floor;
    const RenderSettings on = floor.settings(TextureFiltering::cones);
    const PreparedView view = floor.view(on);
    const std::string hash = render_view(view, on, 4, workers()).hash();
    WorkerPool other(3);
    EXPECT_EQ(render_view(prepare_view(floor.scene, floor.camera, on, other), on, 4, other).hash(),
              hash);
    const CameraRays rays(view.camera, floor.scene->origin(), on.width, on.height, Bounds{});
    const PathSettings path = path_settings(on);
    Film film(on.width, on.height);
    TileCounts counts;
    for (uint32_t y = 0; y < on.height; y += 27) {
        for (uint32_t x = 0; x < on.width; x += 32) {
            const TileJob job{view.scene.get(), &rays, &path, &film, 0, 4, x, y, x + 32, y + 27};
            tile_kernel(view.tier)(job, {}, counts);
        }
    }
    EXPECT_EQ(film.hash(), hash);
    // Off: the bytes of a view that never knew of it, by way of one that did.
    const RenderSettings off = floor.settings(TextureFiltering::none);
    const PreparedView back = floor.view(off, &view);
    EXPECT_EQ(back.pyramids, nullptr);
    const std::string plain = render_view(floor.view(off), off, 4, workers()).hash();
    EXPECT_EQ(render_view(back, off, 4, workers()).hash(), plain);
    EXPECT_NE(plain, hash);
    // And the kernel with cones gives them where no pyramids are.
    PreparedView larger = floor.view(off);
    larger.tier = kTiers.size() - 1;
    EXPECT_EQ(render_view(larger, off, 4, workers()).hash(), plain);
}

TEST(TextureFilter, CoverageIsNotFiltered) {
    const Floor floor;
    SceneBuilder builder;
    builder.environment(Rgb(1));
    Material m = SceneBuilder::diffuse(1);
    m.alpha_mode = AlphaMode::mask;
    m.base_color_texture = slot_of(add_texture(builder.desc(), kSide, [](uint32_t x, uint32_t y) {
        std::array<int, 4> t = black_or_white(x + 3, y);
        t[3] = (x / 4 + y / 4) % 3 == 0 ? 255 : 0;
        return t;
    }));
    Mesh mesh = SceneBuilder::quad(Vec3f(-200, 0, 2), Vec3f(400, 0, 0), Vec3f(0, 0, -400));
    mesh.uv[0] = {Vec2f(0, 0), Vec2f(50, 0), Vec2f(50, 50), Vec2f(0, 50)};
    builder.mesh(mesh, builder.material(m));
    const auto scene = builder.build(workers());
    Film films[2];
    for (const TextureFiltering filter : {TextureFiltering::none, TextureFiltering::cones}) {
        const RenderSettings s = floor.settings(filter);
        films[filter == TextureFiltering::cones ? 1 : 0] =
            render_view(prepare_view(scene, floor.camera, s, workers()), s, 4, workers());
    }
    uint64_t covered = 0, pixels = 0;
    for (std::size_t i = 0; i < films[0].pixels().size(); ++i) {
        EXPECT_EQ(films[0].pixels()[i].covered, films[1].pixels()[i].covered);
        covered += films[0].pixels()[i].covered;
        pixels += 4;
    }
    EXPECT_GT(covered, pixels / 20);
    EXPECT_LT(covered, pixels / 2);
    EXPECT_NE(films[0].hash(), films[1].hash());
}

TEST(TextureFilter, TheLedgerMeasuresIt) {
    // A wall of checks of 2x2 pixels, edges on edges: without filtering there is no noise, and with
    // it every pixel has some of its neighbours.
    SceneBuilder builder;
    builder.environment(Rgb(1));
    Material m = SceneBuilder::diffuse(1);
    m.base_color_texture = slot_of(add_texture(builder.desc(), kSide, black_or_white));
    Mesh mesh = SceneBuilder::quad(Vec3f(-1, -1, 0), Vec3f(2, 0, 0), Vec3f(0, 2, 0));
    mesh.uv[0] = {Vec2f(0, 4), Vec2f(4, 4), Vec2f(4, 0), Vec2f(0, 0)};
    builder.mesh(mesh, builder.material(m));
    const auto scene = builder.build(workers());
    Camera camera = camera_at(Vec3d(0, 0, 3), Vec3d(0));
    camera.kind = CameraKind::orthographic;
    RenderSettings on;
    on.width = on.height = 64;
    on.texture_filter = TextureFiltering::cones;
    const std::vector<BiasEntry> ledger = measure_bias(scene, camera, on, 0, workers());
    ASSERT_EQ(ledger.size(), 1u);
    EXPECT_EQ(ledger[0].name, "texture-filter cones");
    EXPECT_TRUE(ledger[0].floor.significant);
    std::printf("floor %.2f %%, a loss after %.3g s\n", ledger[0].floor.relrmse_percent,
                ledger[0].loss_after_seconds.value_or(-1));
    on.texture_filter = TextureFiltering::none;
    EXPECT_TRUE(biased_switches(on).empty());
}

class TextureFilterCommand : public testing::Test {
  protected:
    void SetUp() override {
        folder_ = fs::temp_directory_path() / ("talbot-filter-" + std::to_string(getpid()));
        fs::create_directories(folder_);
    }
    void TearDown() override { fs::remove_all(folder_); }
    std::string path(const std::string& name) const { return (folder_ / name).string(); }

    fs::path folder_;
};

TEST_F(TextureFilterCommand, IsNamedInTheRecordAndKeepsFilmsApart) {
    const std::string scene = "'" TALBOT_SOURCE_DIR "/assets/scenes/cornell.gltf' --size 16x16 ";
    const auto render = [&](const std::string& name, const std::string& flags) {
        return program::run(scene + flags + " --frames 2 --report " + path(name + ".json") +
                            " --output " + path(name + ".png") + " --film " + path(name + ".film"));
    };
    ASSERT_EQ(render("off", "").code, 0);
    ASSERT_EQ(render("on", "--texture-filter cones --first-sample 2").code, 0);
    ASSERT_EQ(render("next", "--first-sample 2").code, 0);
    EXPECT_EQ(program::read_json(path("off.json"))["texture_filter"], "none");
    const nlohmann::json record = program::read_json(path("on.json"));
    EXPECT_EQ(record["texture_filter"], "cones");
    ASSERT_EQ(record["bias"].size(), 1u);
    EXPECT_EQ(record["bias"][0]["switch"], "texture-filter cones");
    std::ifstream png(path("on.png"), std::ios::binary);
    std::ostringstream bytes;
    bytes << png.rdbuf();
    EXPECT_NE(bytes.str().find("TextureFilter"), std::string::npos);
    EXPECT_EQ(
        program::run("merge " + path("a.film") + " " + path("off.film") + " " + path("next.film"))
            .code,
        0);
    EXPECT_EQ(
        program::run("merge " + path("b.film") + " " + path("off.film") + " " + path("on.film"))
            .code,
        3);
    EXPECT_EQ(program::run(scene + "--frames 1 --texture-filter mips").code, 2);
}

}  // namespace
}  // namespace talbot
