// G02 and G03: the box test never rejects a box whose content is hit, whatever the signs and zeros
// of the direction. Controls: the textbook slab test, and the same test without padding.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "app/hardcases/cases/exact_oracles.h"
#include "geometry_scenes.h"

namespace talbot::test {
namespace {

struct Rejections {
    uint64_t fused = 0;
    uint64_t twice_rounded = 0;
    uint64_t control = 0;
    uint64_t hits = 0;
};

void count(const Ray& ray, const Bounds& box, Rejections& rejections) {
    if (!exact_box(ray, box)) return;
    ++rejections.hits;
    rejections.fused += !own_box(ray, box, true);
    rejections.twice_rounded += !own_box(ray, box, false);
    rejections.control += !textbook_box(ray, box);
}

TEST(Slabs, ZeroAndNegativeZeroDirections) {
    Rng rng(1);
    Rejections rejections;
    constexpr float kPatterns[4] = {1, -1, 0.0f, -0.0f};
    for (uint64_t i = 0; i < 1500 * test_scale(); ++i) {
        const Bounds box = random_box(rng, true);
        for (int pattern = 0; pattern < 64; ++pattern) {
            Ray ray;
            ray.d = Vec3f(kPatterns[pattern & 3], kPatterns[(pattern >> 2) & 3],
                          kPatterns[pattern >> 4]);
            if (ray.d == Vec3f(0)) continue;
            ray.d *= rng.uniform(0.1f, 3);
            for (int k = 0; k < 3; ++k) {
                const uint32_t where = rng.below(6);
                const float face = where % 2 == 0 ? box.lower[k] : box.upper[k];
                ray.o[k] = where < 2 ? face
                           : where < 4
                               ? std::nextafter(face, rng.below(2) != 0 ? kInfinity : -kInfinity)
                               : rng.uniform(-3, 3);
            }
            count(ray, box, rejections);
        }
    }
    EXPECT_GT(rejections.hits, 10000u);
    EXPECT_EQ(rejections.fused, 0u);
    EXPECT_EQ(rejections.twice_rounded, 0u);
    EXPECT_GT(rejections.control, rejections.hits / 20);
}

TEST(Slabs, RaysThroughBoxEdges) {
    Rng rng(2);
    Rejections rejections;
    for (uint64_t i = 0; i < 500000 * test_scale(); ++i) {
        const Bounds box = random_box(rng, true);
        Vec3f p;
        const int free_axis = rng.between(0, 2);
        for (int k = 0; k < 3; ++k) p[k] = rng.below(2) != 0 ? box.lower[k] : box.upper[k];
        p[free_axis] =
            box.lower[free_axis] + rng.uniform() * (box.upper[free_axis] - box.lower[free_axis]);
        Ray ray;
        ray.o = rng.in_box(-3, 3) * std::pow(10.0f, rng.uniform(-1, 3));
        ray.d = p - ray.o;
        if (rng.below(4) == 0) ray.d[rng.between(0, 2)] *= std::pow(2.0f, -rng.uniform(0, 140));
        if (!(max_component(glm::abs(ray.d)) > 0)) continue;
        count(ray, box, rejections);
    }
    EXPECT_GT(rejections.hits, 100000u);
    EXPECT_EQ(rejections.fused, 0u);
    EXPECT_EQ(rejections.twice_rounded, 0u);
    EXPECT_GT(rejections.control, rejections.hits / 100);
}

TEST(Slabs, HardlyAnyFalseHits) {
    Rng rng(3);
    uint64_t false_hits = 0;
    const uint64_t rays = 500000 * test_scale();
    for (uint64_t i = 0; i < rays; ++i) {
        const Bounds box = random_box(rng, false);
        Ray ray;
        ray.o = rng.in_box(-3, 3);
        ray.d = rng.direction();
        false_hits += own_box(ray, box, true) && !exact_box(ray, box);
    }
    EXPECT_LT(static_cast<double>(false_hits), 1e-5 * static_cast<double>(rays) + 1);
}

// Through the whole structure: axis-parallel rays in the planes of boxes, against brute force.
TEST(Slabs, AxisAlignedSceneEqualsBruteForce) {
    Rng rng(4);
    MeshData mesh;
    for (int i = 0; i < 20; ++i) {
        const Vec3f lo(Vec3d(rng.between(-4, 4), rng.between(-4, 4), rng.between(-4, 4)));
        mesh.add_box(lo,
                     lo + Vec3f(Vec3d(rng.between(0, 2), rng.between(1, 2), rng.between(1, 2))));
    }
    const SceneData scene = scene_of(mesh);
    const auto accel = build(scene);
    const auto oracle = build_brute_force(scene.input());
    constexpr float kPatterns[4] = {1, -1, 0.0f, -0.0f};
    uint64_t wrong = 0;
    uint64_t hits = 0;
    for (uint64_t i = 0; i < 150000 * test_scale(); ++i) {
        Ray ray;
        ray.d = Vec3f(kPatterns[rng.below(4)], kPatterns[rng.below(4)], kPatterns[rng.below(4)]);
        if (ray.d == Vec3f(0)) continue;
        for (int k = 0; k < 3; ++k) {
            ray.o[k] = static_cast<float>(rng.between(-10, 10)) / 2;
            if (rng.below(4) == 0) ray.o[k] = std::nextafter(ray.o[k], kInfinity);
        }
        Hit hit;
        Hit expected;
        const bool expect = oracle->closest(ray, expected);
        const bool found = accel->closest(ray, hit);
        wrong += found != expect || !same_hit(hit, expected) || accel->occluded(ray) != expect;
        hits += expect;
    }
    EXPECT_EQ(wrong, 0u);
    EXPECT_GT(hits, 10000u);
}

}  // namespace
}  // namespace talbot::test
