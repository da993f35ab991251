// G06: with the primitive's identity excluded no spawned ray meets its own primitive again, at any
// size, offset or angle. Controls: no protection, and a fixed epsilon of 1e-4.
#include <gtest/gtest.h>

#include <cmath>

#include "geometry_scenes.h"

namespace talbot::test {
namespace {

struct SelfHits {
    uint64_t own = 0;
    uint64_t unprotected = 0;
    uint64_t epsilon = 0;
    uint64_t rays = 0;
};

// Hits a lone triangle, starts again from the float hit point, half of the time at a grazing angle.
void spawn(const Accel& accel, const std::array<Vec3f, 3>& world, Rng& rng, SelfHits& counts) {
    float b0 = rng.uniform();
    float b1 = rng.uniform();
    if (b0 + b1 > 1) {
        b0 = 1 - b0;
        b1 = 1 - b1;
    }
    const float size = length(world[1] - world[0]);
    const Vec3f target = b0 * world[0] + b1 * world[1] + (1 - b0 - b1) * world[2];
    const Vec3d normal = cross(Vec3d(world[1] - world[0]), Vec3d(world[2] - world[0]));
    if (!(length(normal) > 0)) return;
    const Vec3d n = normalize(normal);
    Ray ray;
    ray.o = target + size * (Vec3f(n) + rng.in_box(-0.5f, 0.5f));
    ray.d = target - ray.o;
    if (ray.d == Vec3f(0)) return;
    Hit hit;
    if (!accel.closest(ray, hit)) return;
    const Vec3f p = (1 - hit.u - hit.v) * world[0] + hit.u * world[1] + hit.v * world[2];
    const Vec3d along = normalize(cross(n, Vec3d(rng.direction())));
    const double slope = rng.below(2) != 0 ? 1e-3 : rng.uniform();
    Ray next;
    next.o = p;
    next.d = Vec3f(along + (rng.below(2) != 0 ? slope : -slope) * n);
    Hit again;
    counts.unprotected += accel.closest(next, again);
    Ray shifted = next;
    shifted.o += 1e-4f * next.d;
    counts.epsilon += accel.closest(shifted, again);
    next.skip_from = hit.id;
    counts.own += accel.closest(next, again) || accel.occluded(next);
    Ray last;
    last.o = next.o + size * next.d;
    last.d = p - last.o;
    last.t_max = 1 + 0x1p-20f;
    last.skip_to = hit.id;
    counts.own += accel.closest(last, again) || accel.occluded(last);
    ++counts.rays;
}

std::array<Vec3f, 3> random_triangle(Rng& rng) {
    const float size = std::pow(10.0f, rng.uniform(-6, 6));
    const Vec3f at =
        rng.direction() * (rng.below(4) == 0 ? 0.0f : std::pow(10.0f, rng.uniform(-6, 6)));
    return {at + size * rng.in_box(-1, 1), at + size * rng.in_box(-1, 1),
            at + size * rng.in_box(-1, 1)};
}

TEST(SelfHits, Triangles) {
    Rng rng(1);
    SelfHits counts;
    for (uint64_t i = 0; i < 4000 * test_scale(); ++i) {
        const auto tri = random_triangle(rng);
        MeshData mesh;
        mesh.add_triangle(tri[0], tri[1], tri[2]);
        const auto accel = build_brute_force(scene_of(mesh).input());
        const auto tree = build(scene_of(mesh), BuildQuality::fast, 1);
        for (int k = 0; k < 8; ++k) {
            spawn(*accel, tri, rng, counts);
            spawn(*tree, tri, rng, counts);
        }
    }
    EXPECT_GT(counts.rays, 10000u);
    EXPECT_EQ(counts.own, 0u);
    EXPECT_GT(counts.unprotected, counts.rays / 20);
    EXPECT_GT(counts.epsilon, counts.rays / 200);
}

TEST(SelfHits, InstancedTriangles) {
    Rng rng(2);
    SelfHits counts;
    for (uint64_t i = 0; i < 2000 * test_scale(); ++i) {
        const auto tri = random_triangle(rng);
        SceneData scene;
        scene.meshes.emplace_back();
        scene.meshes[0].add_triangle(tri[0], tri[1], tri[2]);
        Mat4d m(1.0);
        for (int c = 0; c < 3; ++c) m[c] = Vec4d(Vec3d(rng.in_box(-2, 2)), 0);
        m[3] = Vec4d(Vec3d(rng.in_box(-100, 100)), 1);
        if (std::abs(glm::determinant(Mat3d(m))) < 0.1) continue;
        scene.place(0, m);
        const auto accel = build(scene, BuildQuality::fast, 1);
        std::array<Vec3f, 3> world;
        for (size_t k = 0; k < 3; ++k) world[k] = Vec3f(Vec3d(m * Vec4d(Vec3d(tri[k]), 1)));
        for (int k = 0; k < 8; ++k) spawn(*accel, world, rng, counts);
    }
    EXPECT_GT(counts.rays, 3000u);
    EXPECT_EQ(counts.own, 0u);
    EXPECT_GT(counts.unprotected, counts.rays / 20);
}

}  // namespace
}  // namespace talbot::test
