// G11, G12 and the spheres' part of G06: huge and tiny analytic spheres against binary128.
#include <gtest/gtest.h>

#include <cmath>

#include "app/hardcases/cases/exact_oracles.h"
#include "core/geometry/sphere.h"
#include "geometry_scenes.h"

namespace talbot::test {
namespace {

TEST(Spheres, GroundSphereFromJustAbove) {
    Rng rng(1);
    uint64_t wrong = 0;
    uint64_t control_wrong = 0;
    uint64_t hits = 0;
    for (uint64_t i = 0; i < 200000 * test_scale(); ++i) {
        const double radius = std::pow(10.0, rng.uniform(3, 7));
        const Vec3d center(0, -radius, 0);
        const float height = std::pow(10.0f, rng.uniform(-3, 0.5f));
        Ray ray;
        ray.o = Vec3f(rng.uniform(-1, 1), height, rng.uniform(-1, 1));
        const float phi = rng.uniform(0, 2 * kPi);
        const float angle = rng.uniform(1, 90) * kPi / 180;
        ray.d = Vec3f(std::cos(angle) * std::cos(phi), -std::sin(angle),
                      std::cos(angle) * std::sin(phi));
        const ExactSphere expected = exact_sphere(ray, center, radius);
        double t0 = 0;
        double t1 = 0;
        const bool found = sphere_roots(Vec3d(ray.o), Vec3d(ray.d), center, radius, t0, t1);
        const double gate = 8 * 0x1p-24 * std::max<double>(expected.t[0], height);
        hits += expected.hit && expected.t[0] > 0;
        wrong += found != expected.hit ||
                 (found && !(std::abs(static_cast<float>(t0) - expected.t[0]) <= gate));
        float naive[2] = {0, 0};
        control_wrong +=
            naive_sphere(ray, Vec3f(center), static_cast<float>(radius), naive) != expected.hit ||
            !(std::abs(naive[0] - expected.t[0]) <= gate);
    }
    EXPECT_GT(hits, 150000u);
    EXPECT_EQ(wrong, 0u);
    EXPECT_GT(control_wrong, 10000u);
}

TEST(Spheres, DistantSphere) {
    Rng rng(2);
    uint64_t wrong_hit = 0;
    uint64_t wrong_t = 0;
    uint64_t control_wrong = 0;
    for (uint64_t i = 0; i < 200000 * test_scale(); ++i) {
        const float radius = std::pow(10.0f, rng.uniform(-3, 3));
        const float distance = radius * std::pow(10.0f, rng.uniform(2, 7));
        const Vec3d center(rng.in_box(-1, 1) * radius);
        Ray ray;
        const Vec3f out = rng.direction();
        ray.o = Vec3f(center) + distance * out;
        // Uniform in the disc and a little beyond.
        const Vec3f side = normalize(cross(out, rng.direction()));
        const float r = 1.2f * radius * std::sqrt(rng.uniform());
        ray.d = Vec3f(center) + r * side - ray.o;
        const ExactSphere expected = exact_sphere(ray, center, radius);
        double t0 = 0;
        double t1 = 0;
        const bool found = sphere_roots(Vec3d(ray.o), Vec3d(ray.d), center, radius, t0, t1);
        if (std::abs(expected.inside) > 4 * 0x1p-24 * distance) wrong_hit += found != expected.hit;
        if (found && expected.hit) {
            wrong_t +=
                !(std::abs(static_cast<float>(t0) - expected.t[0]) <= 2 * 0x1p-24 * expected.t[0]);
            wrong_t +=
                !(std::abs(static_cast<float>(t1) - expected.t[1]) <= 2 * 0x1p-24 * expected.t[1]);
        }
        float naive[2] = {0, 0};
        control_wrong += naive_sphere(ray, Vec3f(center), radius, naive) != expected.hit;
    }
    EXPECT_EQ(wrong_hit, 0u);
    EXPECT_EQ(wrong_t, 0u);
    EXPECT_GT(control_wrong, 10000u);
}

// A point on the sphere as a renderer finds it: the hit projected radially, rounded to float.
Vec3f surface_point(const Vec3d& center, double radius, const Vec3d& n) {
    return Vec3f(center + radius * n);
}

TEST(Spheres, SpawnedRaysNeverMeetTheSurfaceAtTheirOrigin) {
    Rng rng(3);
    uint64_t self_hits = 0;
    uint64_t control_hits = 0;
    uint64_t wrong_inside = 0;
    for (uint64_t i = 0; i < 200000 * test_scale(); ++i) {
        SceneData scene;
        const double radius = std::pow(10.0, rng.uniform(-6, 6));
        const Vec3d center(rng.in_box(-1, 1) * std::pow(10.0f, rng.uniform(-6, 6)));
        const Vec3d n = normalize(Vec3d(rng.direction()));
        Ray ray;
        ray.o = surface_point(center, radius, n);
        // The direction's side is judged where the ray starts; half of the directions graze.
        const Vec3d normal = Vec3d(ray.o) - center;
        if (!(length(normal) > 0)) continue;
        const Vec3d up = normalize(normal);
        const Vec3d along = normalize(cross(up, Vec3d(rng.direction())));
        const double slope =
            rng.below(2) != 0 ? 0.001 * rng.uniform() : static_cast<double>(rng.uniform());
        const bool outward = rng.below(2) != 0;
        ray.d = Vec3f(along + (outward ? slope : -slope) * up);
        const double side = dot(normal, Vec3d(ray.d));
        float t[2];
        const int count = sphere_hits(ray, true, false, center, radius, t);
        if (side >= 0) {
            self_hits += count != 0;
        } else if (count == 1 && slope > 0.01) {
            // The chord, as if the origin were on the sphere.
            const double chord = -2 * side / dot(Vec3d(ray.d), Vec3d(ray.d));
            const double slack = 0.01 * chord + 8 * 0x1p-24 * length(Vec3d(ray.o)) / slope;
            wrong_inside += !(std::abs(t[0] - chord) <= slack);
        }
        float naive[2] = {0, 0};
        if (side > 0 && naive_sphere(ray, Vec3f(center), static_cast<float>(radius), naive)) {
            control_hits += naive[0] > 0 || naive[1] > 0;
        }
    }
    EXPECT_EQ(self_hits, 0u);
    EXPECT_EQ(wrong_inside, 0u);
    EXPECT_GT(control_hits, 10000u);
}

TEST(Spheres, ShadowRaysEndOnTheSampledSphere) {
    Rng rng(4);
    SceneData scene;
    scene.spheres.push_back({Vec3d(0, 3, 0), 0.5, false});
    const auto accel = build(scene);
    uint64_t blocked = 0;
    uint64_t control = 0;
    uint64_t far_side_open = 0;
    for (int i = 0; i < 100000; ++i) {
        Ray ray;
        ray.o = rng.in_box(-1, 1);
        const Vec3d toward = normalize(Vec3d(ray.o) - Vec3d(0, 3, 0));
        Vec3d n = normalize(Vec3d(rng.direction()));
        const bool near_side = dot(n, toward) > 0.55;
        const bool far_side = dot(n, toward) < 0;
        const Vec3f p = surface_point(Vec3d(0, 3, 0), 0.5, n);
        ray.d = p - ray.o;
        ray.t_max = 1;
        Ray bare = ray;
        ray.skip_to = {kSphereInstance, 0};
        if (near_side) {
            blocked += accel->occluded(ray);
            control += accel->occluded(bare);
        }
        if (far_side) far_side_open += !accel->occluded(ray);
    }
    EXPECT_EQ(blocked, 0u);
    EXPECT_EQ(far_side_open, 0u);
    EXPECT_GT(control, 1000u);
}

TEST(Spheres, OriginsInsideAndZeroRadius) {
    SceneData scene;
    scene.spheres.push_back({Vec3d(0), 2, false});
    scene.spheres.push_back({Vec3d(0, 0, 1), 0, false});
    const auto accel = build(scene);
    Ray ray;
    ray.d = Vec3f(0, 1, 0);
    Hit hit;
    ASSERT_TRUE(accel->closest(ray, hit));
    EXPECT_EQ(hit.t, 2.0f);
    EXPECT_TRUE(hit.is_sphere());
    ray.t_max = 2;
    EXPECT_FALSE(accel->occluded(ray));
    ray.t_max = std::nextafter(2.0f, 3.0f);
    EXPECT_TRUE(accel->occluded(ray));
}

// Where a root in double takes a ray for a tangent, the sphere's box is met as well: at its poles,
// which lie on the box, and within any limit.
TEST(Spheres, TangentsAtThePolesAreFoundAsByBruteForce) {
    Rng rng(7);
    uint64_t hits = 0;
    uint64_t misses = 0;  // with no limit, of the same rays
    uint64_t wrong = 0;
    for (int k = 0; k < 6; ++k) {
        const int axis = k % 3;
        SceneData scene;
        Vec3d center(0);
        center[axis] = k < 3 ? 2.5 : -0.3;
        scene.spheres.push_back({center, std::abs(center[axis]), false});
        scene.spheres.push_back({Vec3d(20), 1, false});  // one alone has no box
        const auto oracle = build_brute_force(scene.input());
        const auto accel = build(scene);
        HitComparison found{*accel, *oracle};
        const auto tiny = [&rng](float least, float most) {
            const float x = std::exp2(rng.uniform(least, most));
            return rng.uniform(-1, 1) < 0 ? -x : x;
        };
        for (int i = 0; i < 40000; ++i) {
            Ray ray;
            for (int j = 0; j < 3; ++j) {
                ray.o[j] = j == axis ? tiny(-70, -45) : tiny(-50, -20);
                ray.d[j] = j == axis ? tiny(-70, -45) : tiny(-40, -20);
            }
            Hit expected;
            Hit hit;
            const bool expect = found.see(ray, expected);
            LeafPlace place;
            found.wrong += expect && !accel->find_leaf(ray, expected, place);
            hits += expect;
            misses += !expect;
            if (expect) {
                ray.t_max = std::nextafter(expected.t, kInfinity);
                found.see(ray, hit);
            }
        }
        wrong += found.wrong;
    }
    EXPECT_EQ(wrong, 0u);
    EXPECT_GT(hits, 10000u);
    EXPECT_GT(misses, 1000u);
}

// Boxes are built where denormals count as zero; rays may be traced where they do not.
TEST(Spheres, OfDenormalSizeAreFoundAsByBruteForce) {
    SceneData scene;
    Rng rng(6);
    for (int i = 0; i < 40; ++i) {
        const double radius = std::exp2(rng.uniform(-140, -120));
        scene.spheres.push_back({radius * Vec3d(rng.direction()), radius, false});
    }
    const auto oracle = build_brute_force(scene.input());
    const auto accel = build(scene);
    HitComparison found{*accel, *oracle};
    for (int i = 0; i < 20000; ++i) {
        Ray ray;
        ray.o =
            Vec3f(std::exp2(static_cast<double>(rng.uniform(-140, -110))) * Vec3d(rng.direction()));
        ray.d = rng.direction();
        Hit expected;
        found.see(ray, expected);
    }
    EXPECT_EQ(found.wrong, 0u);
    EXPECT_GT(found.hits, 1000u);
}

}  // namespace
}  // namespace talbot::test
