// Output variables against closed forms and against the image of the same samples.
#include <gtest/gtest.h>

#include <cmath>
#include <iterator>
#include <map>

#include "core/integrate/aov_pass.h"
#include "core/integrate/tiers.h"
#include "oracles/scene_builder.h"

namespace talbot {
namespace {

constexpr uint32_t kSide = 24;

// A unit sphere over a large one, below a lamp, in a blue sky; the camera stands at z = 6.
struct View {
    std::shared_ptr<const Scene> scene;
    Camera camera;
    PathSettings settings;
    WorkerPool pool{2};

    View() {
        SceneDesc desc;
        desc.materials.resize(4);
        desc.materials[1].base_color_factor = Vec4f(0.8f, 0.4f, 0.2f, 1);
        desc.materials[1].metallic_factor = 0;
        desc.materials[2].base_color_factor = Vec4f(0.5f, 0.5f, 0.5f, 1);
        desc.materials[2].metallic_factor = 0;
        desc.materials[3].emissive_factor = Rgb(8);
        desc.spheres.push_back({Vec3d(0, 0, 0), 1, 1, 0});
        desc.spheres.push_back({Vec3d(0, -101, 0), 100, 2, 1});
        desc.spheres.push_back({Vec3d(2.5, 2.5, 1), 0.5, 3, 2});
        desc.objects = {{"ball"}, {"floor"}, {"lamp"}};
        desc.environment.color = Rgb(0.1f, 0.2f, 0.4f);
        scene = Scene::build(std::move(desc), pool);
        camera.position = Vec3d(0, 0, 6);
    }
    CameraRays rays() const { return CameraRays(camera, scene->origin(), kSide, kSide, Bounds{}); }
    AovImage image(Aov aov, uint32_t samples) {
        const RenderScene rs(scene);
        AovBuffer buffer(aov, kSide, kSide);
        for (uint32_t i = 0; i < samples; ++i) buffer.add_pass(rs, rays(), settings, 0, pool, {});
        return buffer.image();
    }
    static std::size_t at(uint32_t x, uint32_t y) { return std::size_t{y} * kSide + x; }
};

TEST(Aov, EmissionDirectAndIndirectLightAddUpToTheImage) {
    View view;
    constexpr uint32_t kSamples = 16;
    const AovImage emission = view.image(Aov::emission, kSamples);
    const AovImage direct = view.image(Aov::direct, kSamples);
    const AovImage indirect = view.image(Aov::indirect, kSamples);
    const RenderScene rs(view.scene);
    const CameraRays rays = view.rays();
    Film film(kSide, kSide);
    TileCounts counts;
    const TileKernel kernel = tile_kernel(kTiers.size() - 1);
    kernel(TileJob{&rs, &rays, &view.settings, &film, 0, kSamples, 0, 0, kSide, kSide}, {}, counts);
    const ImageRgba beauty = film.image(false);
    double lit_twice = 0;
    for (std::size_t i = 0; i < beauty.rgb.size(); ++i) {
        for (int c = 0; c < 3; ++c) {
            const float sum =
                emission.image.rgb[i][c] + direct.image.rgb[i][c] + indirect.image.rgb[i][c];
            EXPECT_NEAR(sum, beauty.rgb[i][c], 1e-5f * (1 + beauty.rgb[i][c])) << "pixel " << i;
            EXPECT_GE(direct.image.rgb[i][c], 0);
            EXPECT_GE(indirect.image.rgb[i][c], -1e-6f);
            lit_twice += static_cast<double>(indirect.image.rgb[i][c]);
        }
    }
    EXPECT_GT(lit_twice, 1);
    // The sky is seen directly, and nothing else is there.
    EXPECT_NEAR(emission.image.rgb[View::at(0, 2)].z, 0.4f, 1e-6f);
    EXPECT_EQ(direct.image.rgb[View::at(0, 2)].z, 0);
    // The ball itself does not shine.
    EXPECT_EQ(emission.image.rgb[View::at(kSide / 2, kSide / 2)], Rgb(0));
}

TEST(Aov, DirectLightIsThatOfDepthOne) {
    View view;
    const AovImage direct = view.image(Aov::direct, 8);
    const AovImage emission = view.image(Aov::emission, 8);
    view.settings.max_depth = 1;
    const RenderScene rs(view.scene);
    const CameraRays rays = view.rays();
    Film film(kSide, kSide);
    TileCounts counts;
    tile_kernel(kTiers.size() - 1)(
        TileJob{&rs, &rays, &view.settings, &film, 0, 8, 0, 0, kSide, kSide}, {}, counts);
    const ImageRgba shallow = film.image(false);
    for (std::size_t i = 0; i < shallow.rgb.size(); ++i) {
        EXPECT_NEAR(direct.image.rgb[i].y + emission.image.rgb[i].y, shallow.rgb[i].y,
                    1e-5f * (1 + shallow.rgb[i].y));
    }
}

TEST(Aov, FirstHitsHaveTheirClosedForms) {
    View view;
    const AovImage depth = view.image(Aov::depth, 3);
    const AovImage position = view.image(Aov::position, 3);
    const AovImage normal = view.image(Aov::geometric_normal, 1);
    const AovImage object = view.image(Aov::object_id, 3);
    const AovImage material = view.image(Aov::material_id, 3);
    const AovImage albedo = view.image(Aov::albedo, 4);
    EXPECT_EQ(depth.samples, 1u) << "distances are not averaged";
    int balls = 0;
    for (uint32_t y = 0; y < kSide; ++y) {
        for (uint32_t x = 0; x < kSide; ++x) {
            const std::size_t i = View::at(x, y);
            const float id = object.image.rgb[i].x;
            if (id < 0) {
                EXPECT_TRUE(std::isinf(depth.image.rgb[i].x));
                EXPECT_EQ(material.image.rgb[i].x, -1);
                continue;
            }
            EXPECT_EQ(material.image.rgb[i].x, id + 1);
            const Vec3d p(position.image.rgb[i]);
            EXPECT_NEAR(length(p - view.camera.position), depth.image.rgb[i].x, 1e-4);
            if (id != 0) continue;
            ++balls;
            EXPECT_NEAR(length(p), 1, 1e-5) << "on the unit sphere";
            EXPECT_LT(length(Vec3d(normal.image.rgb[i]) - p), 1e-4) << "its normal is its point";
        }
    }
    EXPECT_GT(balls, 20);
    const Rgb middle = albedo.image.rgb[View::at(kSide / 2, kSide / 2)];
    EXPECT_EQ(middle, Rgb(0.8f, 0.4f, 0.2f));
    EXPECT_LE(depth.upper.x, 60);
    EXPECT_GE(depth.lower.x, 2);
}

// Spheres have leaves of their own, one level or more below the root.
TEST(Aov, LeavesAreThoseOfTheObjects) {
    View view;
    const AovImage objects = view.image(Aov::object_id, 1);
    const AovImage depth = view.image(Aov::bvh_depth, 1);
    const AovImage leaves = view.image(Aov::bvh_leaf, 1);
    std::map<float, float> leaf_of;
    for (std::size_t i = 0; i < objects.image.rgb.size(); ++i) {
        const float object = objects.image.rgb[i].x;
        const float leaf = leaves.image.rgb[i].x;
        if (object < 0) {
            EXPECT_EQ(leaf, -1);
            EXPECT_EQ(depth.image.rgb[i].x, -1);
            continue;
        }
        EXPECT_GE(depth.image.rgb[i].x, 1);
        EXPECT_EQ(leaf_of.emplace(object, leaf).first->second, leaf);
    }
    ASSERT_GE(leaf_of.size(), 2u);
    EXPECT_NE(leaf_of.begin()->second, std::next(leaf_of.begin())->second);
}

TEST(Aov, ImagesDoNotDependOnThreads) {
    View view;
    const RenderScene rs(view.scene);
    for (const Aov aov : {Aov::indirect, Aov::albedo, Aov::traversal_steps}) {
        AovBuffer one(aov, kSide, kSide), three(aov, kSide, kSide);
        WorkerPool single(1), several(3);
        for (int i = 0; i < 3; ++i) {
            one.add_pass(rs, view.rays(), view.settings, 5, single, {});
            three.add_pass(rs, view.rays(), view.settings, 5, several, {});
        }
        EXPECT_EQ(one.image().image.rgb, three.image().image.rgb) << aov_info(aov).name;
    }
}

TEST(Aov, BlocksAndSamplesComeFromTheFilm) {
    Film film(20, 9);
    NonFiniteCount counts;
    film.add(19, 8, Rgb(1), true, 0, counts);
    const AovImage samples = film_aov(Aov::samples, film, {});
    EXPECT_EQ(samples.image.rgb.back(), Rgb(1));
    EXPECT_EQ(samples.image.rgb.front(), Rgb(0));
    const std::vector<float> blocks{1, 2, 3, 4, 5, 6};
    const AovImage errors = film_aov(Aov::block_error, film, blocks);
    EXPECT_EQ(errors.image.rgb[7], Rgb(1));
    EXPECT_EQ(errors.image.rgb[16], Rgb(3));
    EXPECT_EQ(errors.image.rgb[8 * 20 + 8], Rgb(5));
}

}  // namespace
}  // namespace talbot
