// Refitted structures against brute force on what has moved, and when a refit is refused.
#include <gtest/gtest.h>

#include <filesystem>
#include <limits>
#include <set>

#include "core/geometry/bvh_accel.h"
#include "core/io/gltf_loader.h"
#include "core/scene/scene.h"
#include "geometry_scenes.h"
#include "tests/shared_scenes.h"

namespace talbot::test {
namespace {

using AccelPtr = std::unique_ptr<const Accel>;

// Everything bends and twists a little.
void bend(MeshData& mesh, float amount) {
    for (Vec3f& p : mesh.positions) {
        const float a = amount * p.y;
        const Vec3f q = p;
        p.x = std::cos(a) * q.x - std::sin(a) * q.z + 0.2f * amount * q.y * q.y;
        p.z = std::sin(a) * q.x + std::cos(a) * q.z;
    }
}

uint64_t differences(const Accel& accel, const Accel& oracle, uint64_t rays) {
    Rng rng(7);
    const Bounds box = oracle.bounds();
    uint64_t wrong = 0;
    uint64_t hits = 0;
    for (uint64_t i = 0; i < rays; ++i) {
        Ray ray;
        ray.o = 0.5f * (box.lower + box.upper) + rng.in_box(-0.8f, 0.8f) * (box.upper - box.lower);
        ray.d = rng.direction();
        Hit expected;
        Hit hit;
        const bool expect = oracle.closest(ray, expected);
        hits += expect;
        wrong += accel.closest(ray, hit) != expect || (expect && !same_hit(hit, expected)) ||
                 accel.occluded(ray) != expect;
    }
    EXPECT_GT(hits, rays / 20);
    return wrong;
}

SceneData mixed() {
    SceneData scene = scene_of(displaced_sphere(8, 0.2f));
    scene.show(soup(100, 0.3f, 7));
    scene.meshes.push_back(displaced_sphere(2, 0.2f));
    for (int i = 0; i < 4; ++i) {
        Mat4d m(0.4);
        m[3] = Vec4d(0.7 * i - 1, 0.5, 0.3 * i, 1);
        scene.place(2, m);
    }
    scene.spheres.push_back({Vec3d(0.5, 0.5, 0.5), 0.3, false});
    return scene;
}

// Clusters far apart beside a mesh: subtrees that are built apart, some of very few triangles.
SceneData archipelago() {
    MeshData mesh = displaced_sphere(30, 0.2f);
    Rng rng(3);
    for (int cluster = 0; cluster < 30; ++cluster) {
        const Vec3f at = rng.in_box(-8, 8);
        for (int i = 0; i < 3 + cluster; ++i) {
            const Vec3f p = at + rng.in_box(-0.2f, 0.2f);
            mesh.add_triangle(p, p + Vec3f(0.1f, 0, 0), p + Vec3f(0, 0.1f, 0.02f));
        }
    }
    return scene_of(std::move(mesh));
}

// Places of nodes that something not empty refers to more than once, or that refer to themselves.
uint64_t wrong_links(const Accel& accel) {
    const Tree& tree = dynamic_cast<const BvhAccel&>(accel).scene.top;
    std::set<uint32_t> seen;
    uint64_t wrong = 0;
    for (size_t n = 0; n < tree.nodes.size(); ++n) {
        const WideNode& node = tree.nodes[n];
        for (size_t i = 0; i < kNodeWidth; ++i) {
            const uint32_t child = node.child[i];
            if (ChildRef::is_leaf(child) || !(node.plane[0][i] <= node.plane[1][i])) continue;
            wrong += child <= n || !seen.insert(child).second ? 1 : 0;
        }
    }
    return wrong;
}

TEST(Refit, UnusedChildrenStayUnused) {
    const SceneData scene = archipelago();
    WorkerPool pool(2);
    const AccelPtr built = build_accel(scene.input(BuildQuality::fast), pool);
    EXPECT_GT(built->stats().triangles, 8192u);
    EXPECT_EQ(wrong_links(*built), 0u);
    const AccelPtr accel = refit_accel(*built, scene.input(BuildQuality::fast), pool);
    ASSERT_NE(accel, nullptr);
    ASSERT_EQ(wrong_links(*accel), 0u);
    const AccelPtr oracle = build_brute_force(scene.input());
    const MeshData& mesh = scene.meshes[0];
    Rng rng(4);
    for (size_t i = mesh.triangles() - 400; i < mesh.triangles(); ++i) {
        const auto tri = mesh.triangle(i);
        Ray ray;
        ray.o = rng.in_box(-10, 10);
        ray.d = 0.4f * tri[0] + 0.3f * tri[1] + 0.3f * tri[2] - ray.o;
        Hit expected;
        Hit hit;
        ASSERT_TRUE(oracle->closest(ray, expected));
        ASSERT_TRUE(accel->closest(ray, hit));
        EXPECT_TRUE(same_hit(hit, expected));
    }
}

TEST(Refit, EqualsBruteForceAfterEveryMove) {
    SceneData scene = mixed();
    AccelPtr accel = build(scene, BuildQuality::fast);
    WorkerPool pool(2);
    for (int step = 1; step <= 3; ++step) {
        for (MeshData& mesh : scene.meshes) bend(mesh, 0.1f);
        for (AccelInstance& instance : scene.instances) {
            if (!instance.identity) instance.world_from_object[3].y += 0.05;
        }
        scene.spheres[0].center.x += 0.1;
        accel = refit_accel(*accel, scene.input(BuildQuality::fast), pool);
        ASSERT_NE(accel, nullptr) << step;
        const AccelPtr oracle = build_brute_force(scene.input());
        EXPECT_EQ(differences(*accel, *oracle, 20000), 0u) << step;
        const Bounds box = accel->bounds();
        const Bounds expected = build(scene, BuildQuality::fast)->bounds();
        EXPECT_EQ(box.lower, expected.lower);
        EXPECT_EQ(box.upper, expected.upper);
    }
}

TEST(Refit, OfNothingMovedIsTheSameTree) {
    const SceneData scene = mixed();
    const AccelPtr accel = build(scene, BuildQuality::fast);
    WorkerPool pool(2);
    const AccelPtr again = refit_accel(*accel, scene.input(BuildQuality::fast), pool);
    ASSERT_NE(again, nullptr);
    Rng rng(3);
    for (int i = 0; i < 5000; ++i) {
        Ray ray;
        ray.o = rng.in_box(-2, 2);
        ray.d = rng.direction();
        Hit hit;
        uint32_t steps = 0;
        uint32_t other = 0;
        accel->closest_counting(ray, hit, steps);
        again->closest_counting(ray, hit, other);
        ASSERT_EQ(steps, other);
    }
}

TEST(Refit, RefusesOtherTopologyAndBadTrees) {
    SceneData scene = mixed();
    const AccelPtr accel = build(scene, BuildQuality::fast);
    WorkerPool pool(2);
    SceneData other = scene;
    other.meshes[0].indices.resize(other.meshes[0].indices.size() - 3);
    EXPECT_EQ(refit_accel(*accel, other.input(), pool), nullptr);
    other = scene;
    other.spheres.clear();
    EXPECT_EQ(refit_accel(*accel, other.input(), pool), nullptr);
    EXPECT_EQ(refit_accel(*build_brute_force(scene.input()), scene.input(), pool), nullptr);
    // Triangles that were neighbours fly apart.
    other = scene;
    Rng rng(5);
    MeshData& mesh = other.meshes[0];
    for (size_t i = 0; i < mesh.triangles(); ++i) {
        const Vec3f by = rng.in_box(-20, 20);
        for (size_t k = 0; k < 3; ++k) mesh.positions[mesh.indices[3 * i + k]] += by;
    }
    EXPECT_EQ(refit_accel(*accel, other.input(), pool), nullptr);
}

TEST(Refit, StopsWhenAsked) {
    const SceneData scene = mixed();
    const AccelPtr accel = build(scene, BuildQuality::fast);
    WorkerPool pool(2);
    std::stop_source stop;
    EXPECT_NE(refit_accel(*accel, scene.input(BuildQuality::fast), pool, stop.get_token()),
              nullptr);
    stop.request_stop();
    EXPECT_EQ(refit_accel(*accel, scene.input(BuildQuality::fast), pool, stop.get_token()),
              nullptr);
}

// A triangle without area comes and goes; one that the build has dropped asks for a new build.
TEST(Refit, TrianglesThatNothingCanMeet) {
    SceneData scene = scene_of(soup(200, 0.3f, 9));
    const AccelPtr whole = build(scene, BuildQuality::fast);
    WorkerPool pool(2);
    SceneData flat = scene;
    MeshData& mesh = flat.meshes[0];
    mesh.positions[mesh.indices[1]] = mesh.positions[mesh.indices[0]];
    mesh.positions[mesh.indices[3]].x = std::numeric_limits<float>::quiet_NaN();
    const AccelPtr less = refit_accel(*whole, flat.input(), pool);
    ASSERT_NE(less, nullptr);
    EXPECT_EQ(less->stats().dropped_triangles, 2u);
    EXPECT_EQ(differences(*less, *build_brute_force(flat.input()), 20000), 0u);
    const AccelPtr back = refit_accel(*less, scene.input(), pool);
    ASSERT_NE(back, nullptr);
    EXPECT_EQ(back->stats().dropped_triangles, 0u);
    EXPECT_EQ(differences(*back, *build_brute_force(scene.input()), 20000), 0u);
    const AccelPtr without = build(flat, BuildQuality::fast);
    EXPECT_NE(refit_accel(*without, flat.input(), pool), nullptr);
    EXPECT_EQ(refit_accel(*without, scene.input(), pool), nullptr);
}

// A skinned model at several moments: the scene that takes over the structure of the last moment
// gives the hits of one that is built anew.
TEST(Refit, AnAnimatedModel) {
    const std::filesystem::path file = test::shared_folder() / "models/CesiumMan/CesiumMan.glb";
    if (!std::filesystem::exists(file)) GTEST_SKIP() << "NO SAMPLE MODEL AT " << file;
    WorkerPool pool(2);
    const auto open = GltfFile::open(file);
    ASSERT_TRUE(open.ok());
    SceneBuildOptions refitting;
    refitting.quality = BuildQuality::fast;
    double built = 0;
    double refitted = 0;
    for (int moment = 0; moment < 6; ++moment) {
        LoadOptions options;
        options.animation_time = 0.3 * moment;
        SceneBuildOptions building;
        building.quality = BuildQuality::fast;
        const auto fresh = Scene::build(*(*open)->read(options), pool, building);
        const auto scene = Scene::build(*(*open)->read(options), pool, refitting);
        built += fresh->accel().stats().build_seconds;
        if (moment > 0) refitted += scene->accel().stats().build_seconds;
        EXPECT_EQ(differences(scene->accel(), fresh->accel(), 20000), 0u) << moment;
        refitting.previous = scene;
    }
    std::printf("CesiumMan: build %.2f ms, refit %.2f ms\n", 1e3 * built / 6, 1e3 * refitted / 5);
}

// What it is for: it must cost a small part of a build.
TEST(Refit, CostsLessThanABuild) {
    SceneData scene = scene_of(displaced_sphere(100, 0.2f));
    WorkerPool pool(2);
    double built = std::numeric_limits<double>::infinity();
    double refitted = built;
    AccelPtr accel;
    for (int i = 0; i < 3; ++i) {
        accel = build_accel(scene.input(BuildQuality::fast), pool);
        built = std::min(built, accel->stats().build_seconds);
    }
    for (int i = 0; i < 3; ++i) {
        bend(scene.meshes[0], 0.05f);
        accel = refit_accel(*accel, scene.input(BuildQuality::fast), pool);
        ASSERT_NE(accel, nullptr);
        refitted = std::min(refitted, accel->stats().build_seconds);
    }
    RecordProperty("build_ms", std::to_string(1e3 * built));
    RecordProperty("refit_ms", std::to_string(1e3 * refitted));
    std::printf("120000 triangles: build %.1f ms, refit %.1f ms\n", 1e3 * built, 1e3 * refitted);
    EXPECT_LT(refitted, 0.7 * built);
}

}  // namespace
}  // namespace talbot::test
