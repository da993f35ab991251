// G15: mirrored, squeezed and sheared instances against the mesh transformed beforehand in double.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "geometry_scenes.h"

namespace talbot::test {
namespace {

struct WorldTriangle {
    Vec3d a, b, c;
};

std::vector<WorldTriangle> transformed(const MeshData& mesh, const Mat4d& m) {
    std::vector<WorldTriangle> out;
    for (size_t i = 0; i < mesh.triangles(); ++i) {
        const auto tri = mesh.triangle(i);
        Vec3d p[3];
        for (size_t k = 0; k < 3; ++k) p[k] = Vec3d(m * Vec4d(Vec3d(tri[k]), 1));
        out.push_back({p[0], p[1], p[2]});
    }
    return out;
}

// All crossings along the ray by plain double arithmetic; `margin` is the least barycentric
// distance to an edge among all triangles, so that a caller can leave out rays that pass too near
// to one.
[[gnu::noipa]] std::vector<double> crossings(const std::vector<WorldTriangle>& triangles,
                                             const Ray& ray, double& margin) {
    const Vec3d o(ray.o);
    const Vec3d d(ray.d);
    std::vector<double> ts;
    margin = 1;
    for (const WorldTriangle& tri : triangles) {
        const Vec3d e1 = tri.b - tri.a;
        const Vec3d e2 = tri.c - tri.a;
        const Vec3d p = cross(d, e2);
        const double det = dot(e1, p);
        if (det == 0) continue;
        const Vec3d s = o - tri.a;
        const double u = dot(s, p) / det;
        const Vec3d q = cross(s, e1);
        const double v = dot(d, q) / det;
        const double least = std::min(u, std::min(v, 1 - u - v));
        const double t = dot(e2, q) / det;
        if (t > 0 && std::abs(least) < margin) margin = std::abs(least);
        if (least >= 0 && t > 0) ts.push_back(t);
    }
    std::sort(ts.begin(), ts.end());
    return ts;
}

// Every hit along the ray, continued by (t, id) through the filter.
struct After {
    float t = -1;
    PrimitiveId id{};
};
bool is_after(const void* context, const Ray&, const Hit& hit) {
    const After& last = *static_cast<const After*>(context);
    if (hit.t != last.t) return hit.t > last.t;
    return hit.id.instance != last.id.instance ? hit.id.instance > last.id.instance
                                               : hit.id.primitive > last.id.primitive;
}
std::vector<float> all_hits(const Accel& accel, const Ray& ray) {
    std::vector<float> ts;
    After last;
    Hit hit;
    while (accel.closest(ray, hit, {is_after, &last})) {
        ts.push_back(hit.t);
        last = {hit.t, hit.id};
    }
    return ts;
}

std::vector<Mat4d> transforms() {
    std::vector<Mat4d> list;
    const auto scaled = [](double x, double y, double z) {
        Mat4d m(1.0);
        m[0][0] = x;
        m[1][1] = y;
        m[2][2] = z;
        return m;
    };
    Mat4d turn(1.0);
    turn[0] = Vec4d(0.36, 0.48, -0.8, 0);
    turn[1] = Vec4d(-0.8, 0.6, 0, 0);
    turn[2] = Vec4d(0.48, 0.64, 0.6, 0);
    Mat4d sheared(1.0);
    sheared[1][0] = 100;
    Mat4d moved(1.0);
    moved[3] = Vec4d(1e4, -2e4, 3e4, 1);
    list.push_back(scaled(1, 1, -1));
    list.push_back(turn * scaled(-1, 1, 1));
    list.push_back(scaled(1, 1e-7, 1));
    list.push_back(turn * scaled(2, 1e-3, 1));
    list.push_back(scaled(1e6, 1, 1e-6));
    list.push_back(sheared);
    list.push_back(moved * turn * scaled(0.1, 0.2, -3));
    list.push_back(scaled(0x1p-40, 0x1p-40, 0x1p-40));
    return list;
}

TEST(Instances, EqualTheTransformedMesh) {
    const MeshData mesh = displaced_sphere(6, 0.2f);
    Rng rng(1);
    const std::vector<Mat4d> list = transforms();
    for (size_t k = 0; k < list.size(); ++k) {
        SceneData scene;
        scene.meshes.push_back(mesh);
        scene.place(0, list[k]);
        scene.instances[0].filtered = true;
        const auto accel = build(scene);
        const std::vector<WorldTriangle> world = transformed(mesh, list[k]);
        uint64_t compared = 0;
        uint64_t wrong_count = 0;
        uint64_t wrong_depth = 0;
        for (uint64_t i = 0; i < 6000 * test_scale(); ++i) {
            const auto inside = [&] { return Vec3d(list[k] * Vec4d(Vec3d(rng.in_box(-1, 1)), 1)); };
            Ray ray;
            ray.o = Vec3f(Vec3d(list[k] * Vec4d(3.0 * Vec3d(rng.direction()), 1)));
            ray.d = Vec3f(inside() - Vec3d(ray.o));
            double margin = 0;
            const std::vector<double> expected = crossings(world, ray, margin);
            if (margin < 1e-3) continue;
            const std::vector<float> found = all_hits(*accel, ray);
            ++compared;
            wrong_count += found.size() != expected.size();
            if (found.size() != expected.size()) continue;
            for (size_t n = 0; n < found.size(); ++n) {
                wrong_depth += !(std::abs(found[n] - expected[n]) <= 1e-5 * expected.back());
            }
            Hit hit;
            EXPECT_EQ(accel->closest(ray, hit), !expected.empty());
            EXPECT_EQ(accel->occluded(ray), !expected.empty());
        }
        EXPECT_GT(compared, 100u) << k;
        EXPECT_EQ(wrong_count, 0u) << k;
        EXPECT_EQ(wrong_depth, 0u) << k;
    }
}

// The closed mesh stays closed under every transform: rays from inside at vertices and edges always
// hit.
TEST(Instances, StayWatertight) {
    const MeshData mesh = displaced_sphere(8, 0.1f);
    Rng rng(2);
    for (const Mat4d& m : transforms()) {
        SceneData scene;
        scene.meshes.push_back(mesh);
        scene.place(0, m);
        const auto accel = build(scene);
        uint64_t leaks = 0;
        for (uint64_t i = 0; i < 20000 * test_scale(); ++i) {
            const auto tri = mesh.triangle(rng.below(static_cast<uint32_t>(mesh.triangles())));
            const Vec3d target(tri[0] +
                               (rng.below(2) != 0 ? rng.uniform() : 0.0f) * (tri[1] - tri[0]));
            Ray ray;
            ray.o = Vec3f(Vec3d(m * Vec4d(Vec3d(rng.in_box(-0.2f, 0.2f)), 1)));
            ray.d = Vec3f(Vec3d(m * Vec4d(target, 1)) - Vec3d(ray.o));
            Hit hit;
            leaks += !accel->closest(ray, hit) || !accel->occluded(ray);
        }
        EXPECT_EQ(leaks, 0u);
    }
}

// One mesh both merged into the top level and placed, under many instances.
TEST(Instances, IdsNameTheInstance) {
    SceneData scene;
    MeshData quad;
    quad.add_quad({-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0});
    scene.show(quad);
    for (int i = 1; i < 40; ++i) {
        Mat4d m(1.0);
        m[3] = Vec4d(3.0 * i, 0, 0, 1);
        scene.place(0, m);
    }
    const auto accel = build(scene);
    EXPECT_EQ(accel->stats().instances, 40u);
    EXPECT_EQ(accel->stats().triangles, 4u);
    for (uint32_t i = 0; i < 40; ++i) {
        Ray ray;
        ray.o = Vec3f(3 * static_cast<float>(i) + 0.25f, 0.5f, 2);
        ray.d = Vec3f(0, 0, -1);
        Hit hit;
        ASSERT_TRUE(accel->closest(ray, hit));
        EXPECT_EQ(hit.id, (PrimitiveId{i, 1}));
        EXPECT_EQ(hit.t, 2.0f);
    }
}

// Many merged instances, some of nothing, some of few and some of many triangles, beside one under
// a transform: hits name the instance and its own triangle, and leaves are found by them.
TEST(Instances, MergedOnesKeepTheirIds) {
    SceneData scene;
    Rng rng(11);
    for (int i = 0; i < 300; ++i) {
        MeshData mesh;
        const uint32_t count = i % 50 == 49 ? 700 : rng.below(4);
        for (uint32_t k = 0; k < count; ++k) {
            const Vec3f p = rng.in_box(-3, 3);
            mesh.add_triangle(p, p + rng.in_box(-1, 1), p + rng.in_box(-1, 1));
        }
        scene.show(std::move(mesh));
        if (i == 100) {
            Mat4d larger(1.5);
            larger[3][3] = 1;
            scene.place(49, larger);
        }
    }
    for (const BuildQuality quality : {BuildQuality::fast, BuildQuality::high}) {
        const auto accel = build(scene, quality);
        const auto oracle = build_brute_force(scene.input());
        uint64_t hits = 0;
        uint64_t small = 0;
        uint64_t wrong = 0;
        for (int i = 0; i < 4000; ++i) {
            Ray ray;
            ray.o = rng.in_box(-5, 5);
            ray.d = rng.direction();
            Hit expected;
            Hit hit;
            const bool expect = oracle->closest(ray, expected);
            const bool found = accel->closest(ray, hit);
            wrong += found != expect || (expect && !same_hit(hit, expected));
            if (!expect || !found) continue;
            ++hits;
            small += scene.meshes[scene.instances[hit.id.instance].mesh].triangles() < 4;
            LeafPlace place;
            wrong += !accel->find_leaf(ray, hit, place);
        }
        EXPECT_EQ(wrong, 0u);
        EXPECT_GT(hits, 1000u);
        EXPECT_GT(small, 10u);
    }
}

// A ray from far away is rounded more coarsely than the instance is large, in world space as in
// object space; what it meets there is found all the same.
TEST(Instances, AreFoundByRaysFromFarAway) {
    SceneData scene = scene_of(displaced_sphere(4, 0.2f));
    scene.meshes.push_back(displaced_sphere(6, 0.3f));
    for (int i = 0; i < 6; ++i) {
        Mat4d m(1.0);
        m[0] = Vec4d(0.4, 0.1 * i, 0.3, 0);
        m[1] = Vec4d(-0.2, 0.5, 0.1 * i, 0);
        m[2] = Vec4d(0.1, -0.2, 0.6, 0);
        m[3] = Vec4d(3 * i, 5 - i, 2 * i, 1);
        scene.place(1, m);
    }
    const auto oracle = build_brute_force(scene.input());
    const auto accel = build(scene);
    Rng rng(8);
    HitComparison found{*accel, *oracle};
    uint64_t hits = 0;  // on instances
    uint64_t wrong = 0;
    for (int i = 0; i < 5000; ++i) {
        const Vec3f target(rng.uniform(-1, 16), rng.uniform(-1, 6), rng.uniform(-1, 11));
        Ray ray;
        ray.o = std::exp2(rng.uniform(4, 44)) * rng.direction();
        ray.d = target - ray.o;
        Hit expected;
        Hit hit;
        const bool expect = found.see(ray, expected);
        Beam beam;
        beam.add(ray);
        const BeamEntry entry = accel->enter(beam);
        wrong += accel->closest(ray, hit, entry) != expect || accel->occluded(ray) != expect;
        LeafPlace place;
        wrong += expect && !accel->find_leaf(ray, expected, place);
        hits += expect && expected.id.instance > 0;
    }
    EXPECT_EQ(found.wrong, 0u);
    EXPECT_EQ(wrong, 0u);
    EXPECT_GT(hits, 100u);
}

TEST(InstancesDeathTest, SingularTransformsMustNotArrive) {
    SceneData scene;
    scene.meshes.push_back(displaced_sphere(1, 0));
    Mat4d flat(1.0);
    flat[2][2] = 0;
    scene.place(0, flat);
    EXPECT_DEATH(build_brute_force(scene.input()), "check failed");
}

}  // namespace
}  // namespace talbot::test
