// The scalar triangle test against exact arithmetic: its hit set is that of the float inputs, its t
// is right to a few ulp.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "app/hardcases/cases/exact_oracles.h"
#include "core/geometry/triangle.h"
#include "geometry_scenes.h"

namespace talbot::test {
namespace {

Vec3f integer_point(Rng& rng, int size) {
    const int x = rng.between(-size, size);
    const int y = rng.between(-size, size);
    return Vec3f(Vec3d(x, y, rng.between(-size, size)));
}

struct Mismatches {
    uint64_t own = 0;
    uint64_t control = 0;
    uint64_t hits = 0;
    uint64_t on_edges = 0;
};

// Rays through vertices, edges and faces of integer triangles, every case decided exactly.
Mismatches integer_mismatches(int size, uint64_t rays) {
    Rng rng(static_cast<uint64_t>(size));
    Mismatches counts;
    for (uint64_t i = 0; i < rays; ++i) {
        const std::array<Vec3f, 3> tri = {integer_point(rng, size), integer_point(rng, size),
                                          integer_point(rng, size)};
        Ray ray;
        ray.o = integer_point(rng, size);
        Vec3f target = tri[rng.below(3)];
        const uint32_t kind = rng.below(4);
        if (kind == 1) target += tri[rng.below(3)] - ray.o;  // through an edge's midpoint
        if (kind == 2) target = integer_point(rng, size);
        ray.d = target - ray.o;
        if (kind == 3) {
            ray.o = tri[0];
            ray.o[rng.between(0, 2)] -= static_cast<float>(rng.between(1, size));
            ray.d = tri[0] - ray.o;
        }
        if (ray.d == Vec3f(0)) continue;
        Wide numerator = 0;
        Wide denominator = 0;
        const bool expect = exact_triangle<Wide>(ray, tri, numerator, denominator);
        TriangleHit hit{};
        const bool found = own_triangle(ray, tri, hit);
        counts.own += found != expect;
        counts.hits += expect;
        const bool ahead = expect && (numerator > 0) == (denominator > 0) && numerator != 0;
        counts.control += moeller_trumbore(ray, tri) != ahead;
        if (found && expect) {
            const double t = static_cast<double>(numerator) / static_cast<double>(denominator);
            EXPECT_LE(std::abs(hit.t - t), 0x1.01p-24 * std::abs(t)) << i;
            EXPECT_TRUE(hit.u >= 0 && hit.v >= 0 && hit.u + hit.v <= 1.0f + 0x1p-23f);
            counts.on_edges += hit.u == 0 || hit.v == 0 || hit.u + hit.v == 1;
        }
    }
    return counts;
}

TEST(Triangle, HitSetIsExact) {
    for (const int size : {3, 40, 1000, 1 << 20}) {
        const Mismatches counts = integer_mismatches(size, 100000 * test_scale());
        EXPECT_EQ(counts.own, 0u) << size;
        EXPECT_GT(counts.hits, 20000u);
        EXPECT_GT(counts.on_edges, 4000u);
        if (size > 40) {
            EXPECT_GT(counts.control, 100u) << "the control must fail";
        }
    }
}

// G04: needles of aspect 10 to 1e8 under rays within half a degree of their plane.
TEST(Triangle, NeedlesUnderGrazingRays) {
    Rng rng(4);
    uint64_t hits = 0;
    uint64_t wrong_set = 0;
    uint64_t wrong_t = 0;
    uint64_t control_wrong = 0;
    for (uint64_t i = 0; i < 400000 * test_scale(); ++i) {
        const float aspect = std::pow(10.0f, rng.uniform(1, 8));
        const int axis = rng.between(0, 2);
        const auto point = [&](float along, float across, float up) {
            Vec3f p;
            p[axis] = along;
            p[(axis + 1) % 3] = across;
            p[(axis + 2) % 3] = up;
            return p;
        };
        const float width = 1 / aspect;
        const std::array<Vec3f, 3> tri = {point(rng.uniform(-1, 0), 0, 0),
                                          point(rng.uniform(0.5f, 1), rng.uniform(0, width), 0),
                                          point(rng.uniform(-1, 1), width, width * rng.uniform())};
        if (!is_hittable(tri[0], tri[1], tri[2])) continue;
        float b0 = rng.uniform();
        float b1 = rng.uniform();
        if (b0 + b1 > 1) {
            b0 = 1 - b0;
            b1 = 1 - b1;
        }
        const Vec3f target = b0 * tri[0] + b1 * tri[1] + (1 - b0 - b1) * tri[2];
        const float angle = rng.uniform(0, 0.5f * kPi / 180);
        const float turn = 2 * kPi * rng.uniform();
        const float distance = std::pow(10.0f, rng.uniform(-2, 2));
        Ray ray;
        ray.o = target + distance * point(std::cos(turn), std::sin(turn), std::sin(angle));
        ray.d = target - ray.o;
        if (ray.d == Vec3f(0)) continue;
        hardcases::Quad numerator = 0;
        hardcases::Quad denominator = 0;
        const bool expect = exact_triangle<hardcases::Quad>(ray, tri, numerator, denominator);
        TriangleHit hit{};
        const bool found = own_triangle(ray, tri, hit);
        wrong_set += found != expect;
        if (!found || !expect) continue;
        ++hits;
        const auto t = static_cast<double>(numerator / denominator);
        const double gate =
            32 * 0x1p-24 * (length(Vec3d(ray.o)) / length(Vec3d(ray.d)) + std::abs(t));
        wrong_t += !(std::abs(hit.t - t) <= gate);
        control_wrong += moeller_trumbore(ray, tri) != (t > 0);
    }
    EXPECT_GT(hits, 100000u);
    EXPECT_EQ(wrong_set, 0u);
    EXPECT_EQ(wrong_t, 0u);
    EXPECT_GT(control_wrong, 1000u);
}

TEST(Triangle, DegenerateOnesAreKnownExactly) {
    EXPECT_FALSE(is_hittable({0, 0, 0}, {0, 0, 0}, {1, 0, 0}));
    EXPECT_FALSE(is_hittable({0, 0, 0}, {1, 2, 3}, {2, 4, 6}));
    EXPECT_FALSE(is_hittable({0.1f, 0.1f, 0.1f}, {0.2f, 0.2f, 0.2f}, {0.7f, 0.7f, 0.7f}));
    EXPECT_TRUE(is_hittable({0, 0, 0}, {1, 2, 3}, {2, 4, std::nextafter(6.0f, 7.0f)}));
    EXPECT_FALSE(is_hittable({0, 0, NAN}, {1, 0, 0}, {0, 1, 0}));
    EXPECT_FALSE(is_hittable({0, 0, 0}, {INFINITY, 0, 0}, {0, 1, 0}));
    EXPECT_FALSE(is_hittable({0, 0, 0}, {3.4e38f, 0, 0}, {0, 1, 0}));
    EXPECT_TRUE(is_hittable({0, 0, 0}, {1, 0, 0}, {0, 0x1p-100f, 0}));
}

// Multiplying all lengths by a power of two changes no bit of t, u and v.
TEST(Triangle, PowerOfTwoScalingChangesNoBit) {
    Rng rng(9);
    for (int i = 0; i < 20000; ++i) {
        std::array<Vec3f, 3> tri = {rng.in_box(-1, 1), rng.in_box(-1, 1), rng.in_box(-1, 1)};
        Ray ray;
        ray.o = rng.in_box(-2, 2);
        ray.d = tri[0] + rng.uniform() * (tri[1] - tri[0]) - ray.o;
        TriangleHit hit{};
        const bool found = own_triangle(ray, tri, hit);
        const float scale = std::ldexp(1.0f, rng.between(-20, 20));
        for (Vec3f& p : tri) p *= scale;
        ray.o *= scale;
        ray.d *= scale;
        TriangleHit scaled{};
        ASSERT_EQ(own_triangle(ray, tri, scaled), found);
        if (found) {
            ASSERT_TRUE(same_bits(hit.t, scaled.t) && same_bits(hit.u, scaled.u) &&
                        same_bits(hit.v, scaled.v));
        }
    }
}

}  // namespace
}  // namespace talbot::test
