// G04, G05, G17: bad triangles, bad rays and inputs that break naive builders.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>

#include "core/geometry/bvh.h"
#include "geometry_scenes.h"

namespace talbot::test {
namespace {

uint64_t differences(const Accel& accel, const Accel& oracle, const Bounds& box, uint64_t rays) {
    Rng rng(99);
    uint64_t wrong = 0;
    for (uint64_t i = 0; i < rays; ++i) {
        Ray ray;
        ray.o = 0.5f * (box.lower + box.upper) + rng.in_box(-1, 1) * (box.upper - box.lower);
        const Vec3f target = box.lower + rng.in_box(0, 1) * (box.upper - box.lower);
        ray.d = rng.below(2) != 0 ? rng.direction() : target - ray.o;
        Hit hit;
        Hit expected;
        const bool expect = oracle.closest(ray, expected);
        wrong += accel.closest(ray, hit) != expect || !same_hit(hit, expected);
        wrong += accel.occluded(ray) != expect;
    }
    return wrong;
}

void expect_like_brute_force(const MeshData& mesh, uint64_t rays) {
    const SceneData scene = scene_of(mesh);
    const auto oracle = build_brute_force(scene.input());
    for (const BuildQuality quality : {BuildQuality::fast, BuildQuality::high}) {
        const auto accel = build(scene, quality);
        EXPECT_LE(accel->stats().depth, kMaxDepth);
        EXPECT_EQ(accel->stats().triangles, oracle->stats().triangles);
        EXPECT_EQ(accel->stats().dropped_triangles, oracle->stats().dropped_triangles);
        const Bounds box =
            accel->stats().triangles == 0 ? Bounds{Vec3f(-1), Vec3f(1)} : accel->bounds();
        EXPECT_EQ(differences(*accel, *oracle, box, rays), 0u);
    }
}

TEST(DegenerateBuild, NoneOneAndTwo) {
    expect_like_brute_force({}, 100);
    MeshData mesh;
    mesh.add_triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    expect_like_brute_force(mesh, 1000);
    mesh.add_triangle({0, 0, 1}, {1, 0, 1}, {0, 1, 1});
    expect_like_brute_force(mesh, 1000);
    const auto empty = build(SceneData{});
    EXPECT_TRUE(empty->bounds().is_empty());
    EXPECT_FALSE(empty->occluded(Ray{}));
}

TEST(DegenerateBuild, IdenticalTriangles) {
    MeshData mesh;
    for (uint64_t i = 0; i < 100000; ++i) mesh.add_triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    const SceneData scene = scene_of(mesh);
    const auto accel = build(scene);
    EXPECT_LE(accel->stats().depth, kMaxDepth);
    Ray ray;
    ray.o = Vec3f(0.2f, 0.3f, -1);
    Hit hit;
    ASSERT_TRUE(accel->closest(ray, hit));
    EXPECT_EQ(hit.id, (PrimitiveId{0, 0}));
    EXPECT_EQ(hit.t, 1.0f);
    ray.o.x = 0.9f;
    EXPECT_FALSE(accel->closest(ray, hit));
    EXPECT_EQ(accel->stats().crowd, 100000u);
    EXPECT_EQ(accel->stats().crowd_mesh, 0u);
}

// Triangles in one place among others are counted, all of them, and their mesh is named.
TEST(DegenerateBuild, ACrowdIsCounted) {
    Rng rng(7);
    MeshData others;
    MeshData mixed;
    const auto scatter = [&](MeshData& mesh, int count) {
        for (int i = 0; i < count; ++i) {
            const Vec3f p = rng.in_box(-5, 5);
            mesh.add_triangle(p, p + rng.in_box(0, 1), p + rng.in_box(0, 1));
        }
    };
    scatter(others, 20000);
    scatter(mixed, 10000);
    for (int i = 0; i < 1000; ++i) mixed.add_triangle({1, 1, 1}, {2, 1, 1}, {1, 2, 1});
    scatter(mixed, 10000);
    Mat4d moved(1.0);
    moved[3].x = 3;
    WorkerPool pool(2);
    for (const bool is_shared : {false, true}) {
        SceneData scene;
        scene.show(others);
        scene.show(mixed);
        if (is_shared) {
            scene.instances.pop_back();
            scene.place(1, moved);
        }
        for (const BuildQuality quality : {BuildQuality::fast, BuildQuality::high}) {
            const auto accel = build(scene, quality);
            EXPECT_EQ(accel->stats().crowd, 1000u);
            EXPECT_EQ(accel->stats().crowd_mesh, 1u);
            if (quality == BuildQuality::high) continue;
            const auto refitted = refit_accel(*accel, scene.input(), pool);
            ASSERT_TRUE(refitted);
            EXPECT_EQ(refitted->stats().crowd, 1000u);
        }
    }
    EXPECT_LT(build(scene_of(others))->stats().crowd, 4u);
}

TEST(DegenerateBuild, CentroidsAtPowersOfTwo) {
    MeshData mesh;
    for (int j = -120; j <= 120; ++j) {
        const float s = std::ldexp(1.0f, j);
        mesh.add_triangle({s, 0, 0}, {1.5f * s, s, 0}, {s, 0, s});
    }
    expect_like_brute_force(mesh, 3000);
    // Rays at each scale of its own, where the box of all would be hit by none.
    const SceneData scene = scene_of(mesh);
    const auto accel = build(scene);
    const auto oracle = build_brute_force(scene.input());
    uint64_t hits = 0;
    for (int j = -60; j <= 49; ++j) {
        const float s = std::ldexp(1.0f, j);
        for (int k = 0; k < 20; ++k) {
            Ray ray;
            ray.o = Vec3f(0.3f * s, -s, 0.1f * s);
            ray.d = Vec3f(1.2f * s, 0.3f * s, 0.02f * static_cast<float>(k) * s) - ray.o;
            Hit hit;
            Hit expected;
            const bool expect = oracle->closest(ray, expected);
            EXPECT_EQ(accel->closest(ray, hit), expect);
            EXPECT_TRUE(same_hit(hit, expected));
            hits += expect;
        }
    }
    EXPECT_GT(hits, 1000u);
}

TEST(DegenerateBuild, ConcentricShells) {
    MeshData mesh;
    const MeshData shell = displaced_sphere(2, 0);
    for (int j = 0; j < 24; ++j) {
        MeshData scaled = shell;
        for (Vec3f& p : scaled.positions) p *= std::ldexp(1.0f, j - 12);
        mesh.add(scaled);
    }
    expect_like_brute_force(mesh, 10000);
}

TEST(DegenerateBuild, CollinearAndCoincidentCentroids) {
    MeshData line;
    Rng rng(1);
    for (int i = 0; i < 100000; ++i) {
        const auto x = static_cast<float>(i);
        line.add_triangle({x, 0, 0}, {x + 0.5f, 0.25f, 0}, {x, 0, 0.5f});
    }
    expect_like_brute_force(line, 15);
    MeshData nested;  // equal centroids, every size
    for (int i = 1; i < 1000; ++i) {
        const auto s = static_cast<float>(i);
        nested.add_quad({-s, -s, 0}, {s, -s, 0}, {s, s, 0}, {-s, s, 0});
    }
    expect_like_brute_force(nested, 2000);
}

TEST(DegenerateBuild, ManyEqualSpheresAndInstances) {
    SceneData scene;
    scene.meshes.push_back(displaced_sphere(1, 0));
    for (int i = 0; i < 100; ++i) {
        scene.spheres.push_back({Vec3d(0), 1, false});
        scene.place(0, Mat4d(1.0));
    }
    const auto accel = build(scene);
    const auto oracle = build_brute_force(scene.input());
    EXPECT_EQ(differences(*accel, *oracle, accel->bounds(), 2000), 0u);
}

// G05: one bad vertex leaves everything as in the mesh whose bad triangles are degenerate.
TEST(BadVertices, DropTheirTrianglesOnly) {
    const MeshData good = displaced_sphere(16, 0.1f);
    constexpr float kInf = std::numeric_limits<float>::infinity();
    for (const float bad : {std::numeric_limits<float>::quiet_NaN(), kInf, -kInf,
                            std::numeric_limits<float>::max()}) {
        for (int axis = 0; axis < 3; ++axis) {
            const uint32_t vertex = 17u + static_cast<uint32_t>(axis) * 100u;
            MeshData mesh = good;
            mesh.positions[vertex][axis] = bad;
            MeshData without = good;
            uint64_t affected = 0;
            for (size_t i = 0; i < good.triangles(); ++i) {
                uint32_t* t = &without.indices[3 * i];
                if (t[0] != vertex && t[1] != vertex && t[2] != vertex) continue;
                t[0] = t[1] = t[2];
                ++affected;
            }
            const auto accel = build(scene_of(mesh));
            const auto oracle = build(scene_of(without));
            EXPECT_GT(affected, 2u);
            EXPECT_EQ(accel->stats().dropped_triangles, affected);
            EXPECT_EQ(differences(*accel, *oracle, oracle->bounds(), 3000), 0u);
        }
    }
}

TEST(BadVertices, DenormalsCountAsZero) {
    MeshData mesh = displaced_sphere(8, 0.1f);
    mesh.positions[5] = Vec3f(std::numeric_limits<float>::denorm_min());
    MeshData zero = mesh;
    zero.positions[5] = Vec3f(0);
    const auto accel = build(scene_of(mesh));
    const auto oracle = build(scene_of(zero));
    EXPECT_EQ(differences(*accel, *oracle, oracle->bounds(), 3000), 0u);
}

// G04: zero-area triangles of every kind change nothing.
TEST(BadVertices, DegenerateTrianglesChangeNothing) {
    MeshData mesh = displaced_sphere(8, 0.1f);
    const auto without = build(scene_of(mesh));
    Rng rng(3);
    for (int i = 0; i < 200; ++i) {
        const Vec3f p = rng.in_box(-1, 1);
        const Vec3f q = rng.in_box(-1, 1);
        mesh.add_triangle(p, p, p);
        mesh.add_triangle(p, q, p);
        mesh.add_triangle(p, 2.0f * p, 4.0f * p);
    }
    const auto with = build(scene_of(mesh));
    EXPECT_EQ(with->stats().dropped_triangles, 600u);
    EXPECT_EQ(differences(*with, *without, without->bounds(), 5000), 0u);
}

TEST(BadRays, AnyBitPatternIsSafe) {
    SceneData scene = scene_of(displaced_sphere(4, 0.1f));
    scene.spheres.push_back({Vec3d(0.5), 1, false});
    scene.place(0, Mat4d(2.0));
    scene.instances.back().world_from_object[3] = Vec4d(3, 0, 0, 1);
    const auto accel = build(scene);
    const auto oracle = build_brute_force(scene.input());
    Rng rng(5);
    constexpr uint32_t kSpecial[] = {0x00000000, 0x80000000, 0x00000001, 0x807FFFFF,
                                     0x00800000, 0x3F7FFFFF, 0x3F800000, 0x3F800001,
                                     0x7F7FFFFF, 0xFF7FFFFF, 0x7F800000, 0xFF800000,
                                     0x7FC00000, 0x7F800001, 0x58800000, 0x26800000};
    const auto any = [&](float usual) {
        switch (rng.below(4)) {
            case 0:
                return std::bit_cast<float>(kSpecial[rng.below(16)]);
            case 1:
                return std::bit_cast<float>(static_cast<uint32_t>(rng.bits()));
            default:
                return usual;
        }
    };
    for (int i = 0; i < 100000; ++i) {
        Ray ray;
        const Vec3f d = rng.direction();
        for (int k = 0; k < 3; ++k) {
            ray.o[k] = any(rng.uniform(-3, 3));
            ray.d[k] = any(d[k]);
        }
        ray.t_max = any(kInfinity);
        Hit hit;
        Hit expected;
        const bool found = accel->closest(ray, hit);
        ASSERT_EQ(found, oracle->closest(ray, expected)) << i;
        ASSERT_TRUE(same_hit(hit, expected)) << i;
        if (!found) continue;
        ASSERT_TRUE(hit.t > 0 && hit.t < ray.t_max);
        ASSERT_TRUE(hit.u >= 0 && hit.v >= 0 && hit.u <= 1 && hit.v <= 1);
    }
}

TEST(Building, StopsWhenAsked) {
    const SceneData scene = scene_of(soup(50000, 0.01f, 1));
    WorkerPool pool(2);
    std::stop_source stop;
    stop.request_stop();
    EXPECT_EQ(build_accel(scene.input(), pool, stop.get_token()), nullptr);
    float last = 0;
    const auto accel =
        build_accel(scene.input(), pool, {}, [&](float done) { last = std::max(last, done); });
    ASSERT_NE(accel, nullptr);
    EXPECT_EQ(last, 1.0f);
}

}  // namespace
}  // namespace talbot::test
