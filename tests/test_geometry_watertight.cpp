// G01: no ray slips between neighbours, on any instruction set that the machine has. Gate: 0
// misses; control: Moeller-Trumbore.
#include <gtest/gtest.h>
#include <hwy/highway.h>

#include <cmath>
#include <vector>

#include "geometry_scenes.h"

namespace talbot::test {
namespace {

bool control_hits(const MeshData& mesh, const Ray& ray) {
    for (size_t i = 0; i < mesh.triangles(); ++i) {
        if (moeller_trumbore(ray, mesh.triangle(i))) return true;
    }
    return false;
}

struct Misses {
    uint64_t own = 0;
    uint64_t control = 0;
};

Misses fan_misses(float stretch, const Vec3f& at, uint64_t rays_per_fan, Rng& rng) {
    Misses misses;
    for (uint32_t n = 3; n <= 64; ++n) {
        const MeshData mesh = triangle_fan(n, stretch, at, rng);
        const auto accel = build(scene_of(mesh), BuildQuality::high, 1);
        for (uint64_t i = 0; i < rays_per_fan; ++i) {
            Ray ray;
            // Seen from a side from which no spoke is hidden behind the rim's outline.
            ray.o =
                at + Vec3f(rng.uniform(-0.2f, 0.2f), rng.uniform(-0.2f, 0.2f), rng.uniform(3, 30));
            const Vec3f rim = mesh.positions[1 + rng.below(n)];
            const float s = rng.below(2) != 0 ? 0.0f : 0.9f * rng.uniform();
            ray.d = mesh.positions[0] + s * (rim - mesh.positions[0]) - ray.o;
            Hit hit;
            misses.own += !accel->closest(ray, hit) || !accel->occluded(ray);
            misses.control += !control_hits(mesh, ray);
        }
    }
    return misses;
}

// Rays from inside a closed mesh at its vertices, edge points and face points.
uint64_t leaks(const MeshData& mesh, const Accel& accel, const Vec3f& inside, float jitter,
               uint64_t rays, Rng& rng) {
    uint64_t misses = 0;
    for (uint64_t i = 0; i < rays; ++i) {
        const auto tri = mesh.triangle(rng.below(static_cast<uint32_t>(mesh.triangles())));
        const uint32_t kind = rng.below(3);
        Vec3f target = tri[0];
        if (kind > 0) target += rng.uniform() * (tri[1] - tri[0]);
        if (kind > 1) target += rng.uniform() * (tri[2] - target);
        Ray ray;
        ray.o = inside + rng.in_box(-jitter, jitter);
        ray.d = target - ray.o;
        Hit hit;
        misses += !accel.closest(ray, hit) || !accel.occluded(ray);
    }
    return misses;
}

uint64_t grid_leaks(const Vec3f& offset, uint64_t rays, Rng& rng) {
    constexpr int kSize = 12;
    const MeshData mesh = grid_cube(kSize).moved(offset);
    const auto accel = build(scene_of(mesh));
    uint64_t misses = 0;
    for (uint64_t i = 0; i < rays; ++i) {
        Ray ray;
        ray.o = offset;
        for (int k = 0; k < 3; ++k)
            ray.o[k] += static_cast<float>(rng.between(2, 2 * kSize - 2)) / 2;
        ray.d = Vec3f(rng.below(2) != 0 ? 0.0f : -0.0f);
        ray.d[rng.between(0, 2)] = rng.below(2) != 0 ? 1.0f : -1.0f;
        if (rng.below(4) == 0) ray.d[rng.between(0, 2)] += rng.below(2) != 0 ? 1.0f : -1.0f;
        if (ray.d == Vec3f(0)) continue;
        Hit hit;
        misses += !accel->closest(ray, hit) || !accel->occluded(ray);
    }
    return misses;
}

class Watertight : public testing::TestWithParam<int64_t> {
  protected:
    void SetUp() override { hwy::SetSupportedTargetsForTest(GetParam()); }
    void TearDown() override { hwy::SetSupportedTargetsForTest(0); }
};

TEST_P(Watertight, Fans) {
    Rng rng(1);
    uint64_t control = 0;
    for (const float at : {0.0f, 1000.0f, 1e6f}) {
        const Misses misses = fan_misses(1, Vec3f(at, -at, at), 150 * test_scale(), rng);
        EXPECT_EQ(misses.own, 0u) << at;
        control += misses.control;
    }
    EXPECT_GT(control, 100u);
}

TEST_P(Watertight, NeedleFans) {
    Rng rng(2);
    uint64_t control = 0;
    for (const float stretch : {1e3f, 1e5f, 1e7f}) {
        const Misses misses = fan_misses(stretch, Vec3f(0), 120 * test_scale(), rng);
        EXPECT_EQ(misses.own, 0u) << stretch;
        control += misses.control;
    }
    EXPECT_GT(control, 100u);
}

TEST_P(Watertight, DisplacedSphereFromInside) {
    Rng rng(3);
    const MeshData unit = displaced_sphere(82, 0.15f);
    for (const Vec3f& at : {Vec3f(0), Vec3f(148376, 1234, -223423), Vec3f(1e6f)}) {
        for (const float radius : {1.0f, 100.0f}) {
            // A unit sphere at 1e6 is a few hundred lattice points, not a sphere.
            if (radius == 1.0f && at.x > 1e5f) continue;
            MeshData mesh = unit;
            for (Vec3f& p : mesh.positions) p = at + radius * p;
            const auto accel = build(scene_of(mesh));
            EXPECT_EQ(leaks(mesh, *accel, at, 0.3f * radius, 30000 * test_scale(), rng), 0u)
                << at.x << " " << radius;
        }
    }
}

TEST_P(Watertight, IntegerGridAlongAxes) {
    Rng rng(4);
    EXPECT_EQ(grid_leaks(Vec3f(0), 50000 * test_scale(), rng), 0u);
    EXPECT_EQ(grid_leaks(Vec3f(-6), 50000 * test_scale(), rng), 0u);
    EXPECT_EQ(grid_leaks(Vec3f(1000, -3000, 70000), 50000 * test_scale(), rng), 0u);
}

// Tiny triangles far from the ray's origin: the case where slabs padded for their own rounding only
// lose triangles that the float shear moved by more.
TEST_P(Watertight, DenseGridFarAway) {
    Rng rng(5);
    MeshData mesh;
    constexpr int kSize = 60;
    std::vector<Vec3f> p;
    for (int i = 0; i <= kSize; ++i) {
        for (int j = 0; j <= kSize; ++j) {
            mesh.add_vertex(Vec3f(0.001f * static_cast<float>(i), 0.001f * static_cast<float>(j),
                                  rng.uniform(0, 0.0001f)));
        }
    }
    for (uint32_t i = 0; i < kSize; ++i) {
        for (uint32_t j = 0; j < kSize; ++j) {
            const uint32_t a = i * (kSize + 1) + j;
            mesh.add_triangle(a, a + kSize + 1, a + kSize + 2);
            mesh.add_triangle(a, a + kSize + 2, a + 1);
        }
    }
    const auto accel = build(scene_of(mesh));
    uint64_t misses = 0;
    for (uint64_t i = 0; i < 100000 * test_scale(); ++i) {
        const auto u = static_cast<uint32_t>(rng.between(1, kSize - 1));
        const auto v = static_cast<uint32_t>(rng.between(1, kSize - 1));
        Ray ray;
        ray.o = Vec3f(0.03f, 0.03f, 0) +
                rng.uniform(1, 10000) * normalize(rng.in_box(-1, 1) + Vec3f(0, 0, 2.5f));
        ray.d = mesh.positions[u * (kSize + 1) + v] - ray.o;
        Hit hit;
        // The aim itself is off by the rounding of d: stay on the sheet.
        const float slack = 4 * 0x1p-24f * length(ray.d);
        if (slack > 0.0005f) continue;
        misses += !accel->closest(ray, hit);
    }
    EXPECT_EQ(misses, 0u);
}

INSTANTIATE_TEST_SUITE_P(Targets, Watertight,
                         testing::ValuesIn(hwy::SupportedAndGeneratedTargets()),
                         [](const testing::TestParamInfo<int64_t>& param) {
                             return std::string(hwy::TargetName(param.param));
                         });

}  // namespace
}  // namespace talbot::test
