// The tree against brute force: identical hits, ties included, on every instruction set, quality
// and thread count.
#include <gtest/gtest.h>
#include <hwy/highway.h>

#include <string>
#include <vector>

#include "core/geometry/bvh.h"
#include "geometry_scenes.h"

namespace talbot::test {
namespace {

// Directions of four kinds: uniform, towards a vertex, towards an edge point, along an axis.
Ray make_ray(const SceneData& scene, const Bounds& bounds, Rng& rng) {
    const Vec3f middle = 0.5f * (bounds.lower + bounds.upper);
    const Vec3f extent = bounds.upper - bounds.lower;
    Ray ray;
    ray.o = middle + rng.in_box(-0.8f, 0.8f) * extent;
    ray.d = rng.direction();
    const uint32_t kind = rng.below(8);
    if (kind < 3 && !scene.meshes.empty()) {
        const MeshData& mesh = scene.meshes[rng.below(static_cast<uint32_t>(scene.meshes.size()))];
        const auto tri = mesh.triangle(rng.below(static_cast<uint32_t>(mesh.triangles())));
        const float s = kind == 0 ? 0.0f : rng.uniform();
        ray.d = tri[0] + s * (tri[1] - tri[0]) - ray.o;
    } else if (kind == 3) {
        ray.d = Vec3f(rng.below(2) != 0 ? 0.0f : -0.0f);
        ray.d[rng.between(0, 2)] = rng.below(2) != 0 ? 1.0f : -2.0f;
    }
    if (rng.below(4) == 0) ray.t_max = rng.uniform(0, 1);
    return ray;
}

SceneData soup_scene() {
    return scene_of(soup(300, 0.4f, 1));
}

SceneData sphere_scene() {
    return scene_of(displaced_sphere(7, 0.3f));
}

SceneData tie_scene() {
    // Coincident layers with different tessellations, and the same mesh twice.
    MeshData mesh;
    mesh.add_quad({0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0});
    mesh.add_quad({0, 1, 0}, {0, 0, 0}, {1, 0, 0}, {1, 1, 0});
    mesh.add_box({0, 0, 0}, {1, 1, 1});
    mesh.add_box({0.25f, 0.25f, 0}, {0.75f, 0.75f, 1});
    SceneData scene = scene_of(mesh);
    scene.show(mesh);
    return scene;
}

SceneData instanced_scene() {
    SceneData scene = scene_of(soup(60, 0.3f, 7));
    scene.meshes.push_back(displaced_sphere(2, 0.2f));
    for (int i = 0; i < 4; ++i) {
        Mat4d m(1.0);
        m[0] = Vec4d(0.4, 0.1 * i, 0, 0);
        m[1] = Vec4d(-0.1, i % 2 == 0 ? 0.3 : -0.3, 0.2, 0);
        m[2] = Vec4d(0, 0.1, 0.5, 0);
        m[3] = Vec4d(0.7 * i - 1, 0.5, 0.3 * i, 1);
        scene.place(1, m);
    }
    return scene;
}

SceneData mixed_scene() {
    SceneData scene = instanced_scene();
    scene.spheres.push_back({Vec3d(0, -100.5, 0), 100, false});
    scene.spheres.push_back({Vec3d(0.5, 0.5, 0.5), 0.3, false});
    scene.spheres.push_back({Vec3d(0.5, 0.5, 0.5), 0.3, false});
    for (int i = 0; i < 12; ++i) {
        scene.spheres.push_back({Vec3d(0.2 * i - 1, 0.3, 0.1 * i), 0.02 + 0.01 * i, false});
    }
    return scene;
}

// Number of rays whose answers differ between the two structures.
uint64_t differences(const SceneData& scene, const Accel& accel, const Accel& oracle, uint64_t rays,
                     uint64_t seed) {
    Rng rng(seed);
    const Bounds bounds = oracle.bounds();
    uint64_t wrong = 0;
    uint64_t hits = 0;
    for (uint64_t i = 0; i < rays; ++i) {
        Ray ray = make_ray(scene, bounds, rng);
        Hit expected;
        Hit hit;
        const bool expect = oracle.closest(ray, expected);
        const bool found = accel.closest(ray, hit);
        hits += expect;
        if (found != expect || !same_hit(hit, expected) || accel.occluded(ray) != expect) ++wrong;
        if (expect && rng.below(4) == 0) {
            // The next layer, as a path would look for it.
            ray.skip_from = expected.id;
            ray.o += expected.t * ray.d;
            const bool next = oracle.closest(ray, expected);
            if (accel.closest(ray, hit) != next || (next && !same_hit(hit, expected))) ++wrong;
        }
    }
    EXPECT_GT(hits, rays / 10);
    return wrong;
}

TEST(Bvh, EqualsBruteForce) {
    const std::vector<std::pair<std::string, SceneData>> scenes = {{"soup", soup_scene()},
                                                                   {"sphere", sphere_scene()},
                                                                   {"ties", tie_scene()},
                                                                   {"instances", instanced_scene()},
                                                                   {"mixed", mixed_scene()}};
    for (const auto& [name, scene] : scenes) {
        const auto oracle = build_brute_force(scene.input());
        for (const BuildQuality quality : {BuildQuality::fast, BuildQuality::high}) {
            const auto accel = build(scene, quality);
            EXPECT_EQ(differences(scene, *accel, *oracle, 50000 * test_scale(),
                                  17 + static_cast<uint64_t>(quality)),
                      0u)
                << name;
        }
    }
}

TEST(Bvh, LargeMeshEqualsBruteForce) {
    const SceneData scene = scene_of(displaced_sphere(60, 0.2f));
    const auto oracle = build_brute_force(scene.input());
    const auto accel = build(scene);
    EXPECT_EQ(accel->stats().triangles, scene.meshes[0].triangles());
    EXPECT_EQ(differences(scene, *accel, *oracle, 1000 * test_scale(), 3), 0u);
}

// A comparison that ignores ties must see differences, or the tie rule is not exercised.
TEST(Bvh, TieSceneHasTies) {
    const SceneData scene = tie_scene();
    const auto accel = build(scene);
    Rng rng(5);
    int ties = 0;
    for (int i = 0; i < 10000; ++i) {
        Ray ray;
        ray.o = Vec3f(rng.uniform(), rng.uniform(), -1);
        Hit first;
        if (!accel->closest(ray, first)) continue;
        ray.skip_from = first.id;
        Hit second;
        ties += accel->closest(ray, second) && same_bits(first.t, second.t);
        EXPECT_TRUE(second.id.instance > first.id.instance ||
                    second.id.primitive > first.id.primitive);
    }
    EXPECT_GT(ties, 9000);
}

// Directions so long that t is denormal and many different hits round to the same.
TEST(Bvh, TiesOfDenormalDistancesGoToTheLowerId) {
    SceneData scene = scene_of(soup(300, 0.4f, 1));
    for (int i = 0; i < 3; ++i) scene.show(scene.meshes[0]);
    const auto oracle = build_brute_force(scene.input());
    const auto accel = build(scene);
    Rng rng(12);
    HitComparison found{*accel, *oracle};
    for (int i = 0; i < 20000; ++i) {
        Ray ray = make_ray(scene, oracle->bounds(), rng);
        ray.t_max = kInfinity;
        ray.d = 0x1.8p+127f * normalize(ray.d);
        Hit expected;
        found.see(ray, expected);
    }
    EXPECT_EQ(found.wrong, 0u);
    EXPECT_GT(found.hits, 2000u);
}

TEST(Bvh, SameHitsOnEveryInstructionSet) {
    const std::vector<int64_t> targets = hwy::SupportedAndGeneratedTargets();
    std::vector<std::vector<Hit>> results;
    const SceneData scene = mixed_scene();
    const SceneData big = scene_of(displaced_sphere(40, 0.2f));
    for (const int64_t target : targets) {
        hwy::SetSupportedTargetsForTest(target);
        EXPECT_STREQ(traversal_target_name(), hwy::TargetName(target));
        std::vector<Hit> hits;
        for (const SceneData* s : {&scene, &big}) {
            const auto accel = build(*s);
            Rng rng(11);
            for (uint64_t i = 0; i < 50000 * test_scale(); ++i) {
                const Ray ray = make_ray(*s, accel->bounds(), rng);
                Hit hit;
                const bool found = accel->closest(ray, hit);
                EXPECT_EQ(accel->occluded(ray), found);
                hits.push_back(hit);
            }
        }
        results.push_back(std::move(hits));
    }
    hwy::SetSupportedTargetsForTest(0);
    for (size_t k = 1; k < results.size(); ++k) {
        uint64_t wrong = 0;
        for (size_t i = 0; i < results[k].size(); ++i)
            wrong += !same_hit(results[k][i], results[0][i]);
        EXPECT_EQ(wrong, 0u) << hwy::TargetName(targets[k]) << " against "
                             << hwy::TargetName(targets[0]);
    }
}

TEST(Bvh, TreeDoesNotDependOnThreads) {
    const SceneData scene = scene_of(displaced_sphere(50, 0.2f));
    const auto one = build(scene, BuildQuality::high, 1);
    const auto three = build(scene, BuildQuality::high, 3);
    EXPECT_EQ(one->stats().nodes, three->stats().nodes);
    EXPECT_EQ(one->stats().bytes, three->stats().bytes);
    Rng rng(2);
    for (int i = 0; i < 20000; ++i) {
        const Ray ray = make_ray(scene, one->bounds(), rng);
        Hit hit;
        uint32_t steps = 0;
        uint32_t other_steps = 0;
        one->closest_counting(ray, hit, steps);
        three->closest_counting(ray, hit, other_steps);
        ASSERT_EQ(steps, other_steps);
    }
}

TEST(Bvh, FilterRefusesHitsOfFilteredInstancesOnly) {
    SceneData scene;
    MeshData quad;
    quad.add_quad({-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0});
    scene.show(quad.moved({0, 0, 1}));
    scene.show(quad.moved({0, 0, 2}));
    scene.place(1, Mat4d(1.0));
    scene.instances[2].world_from_object[3] = Vec4d(0, 0, 1, 1);  // at z = 3
    scene.spheres.push_back({Vec3d(0, 0, 5), 1, true});
    scene.instances[0].filtered = true;
    scene.instances[2].filtered = true;
    const auto accel = build(scene);
    const auto oracle = build_brute_force(scene.input());
    struct Context {
        uint32_t refuse;
    };
    const auto accepts = [](const void* context, const Ray&, const Hit& hit) {
        EXPECT_NE(hit.id.instance, 1u);  // not filtered, never asked about
        return static_cast<const Context*>(context)->refuse != hit.id.instance;
    };
    Ray ray;
    ray.o = Vec3f(0.1f, 0.2f, 0);
    for (const auto* structure : {accel.get(), oracle.get()}) {
        for (const uint32_t refuse : {0u, 1u, 2u, kSphereInstance}) {
            const Context context{refuse};
            const HitFilter filter{accepts, &context};
            Hit hit;
            ASSERT_TRUE(structure->closest(ray, hit));
            EXPECT_EQ(hit.id.instance, 0u);
            ASSERT_TRUE(structure->closest(ray, hit, filter));
            EXPECT_EQ(hit.id.instance, refuse == 0 ? 1u : 0u);
            Ray from_second = ray;
            from_second.o.z = 2.5f;
            EXPECT_EQ(structure->closest(from_second, hit, filter), true);
            EXPECT_EQ(hit.id.instance, refuse == 2 ? kSphereInstance : 2u);
            from_second.t_max = 1;
            EXPECT_EQ(structure->occluded(from_second, filter), refuse != 2);
            EXPECT_TRUE(structure->occluded(from_second));
        }
    }
}

}  // namespace
}  // namespace talbot::test
