// Sampling maps of math/warp.h against their densities, at the ends of [0, 1), and the orthonormal
// basis (catalogue S12, S14).
#include <gtest/gtest.h>

#include <functional>

#include "core/math/frame.h"
#include "core/math/warp.h"
#include "oracles/stats/chi2.h"
#include "oracles/stats/random.h"

namespace talbot {
namespace {

using stats::Random;

constexpr int kDraws = 200000;
constexpr int kChi2Tests = 12;
const double kSignificance = stats::sidak(stats::kFalseAlarm, kChi2Tests);

// Counts of sample(u) mapped to the unit square by cell(), whose image must be uniform there.
double uniformity(const std::function<Vec2d(const Vec2f&)>& cell, uint64_t seed) {
    constexpr int kSide = 24;
    std::vector<double> counts(kSide * kSide, 0.0);
    Random random(seed);
    for (int i = 0; i < kDraws; ++i) {
        const Vec2d p = cell(random.pair());
        const auto at = [](double x) {
            return std::clamp(static_cast<int>(x * kSide), 0, kSide - 1);
        };
        ++counts[static_cast<std::size_t>(at(p.y) * kSide + at(p.x))];
    }
    const std::vector<double> expected(counts.size(), double{kDraws} / (kSide * kSide));
    return stats::chi2_test(counts, expected, 1).p;
}

double turn(double y, double x) {
    return std::atan2(y, x) / (2 * std::numbers::pi) + 0.5;
}

// Cumulative distributions that follow from each density send its samples to uniform ones.
Vec2d disk_cell(const Vec2f& p) {
    return {p.x * p.x + p.y * p.y, turn(p.y, p.x)};
}
Vec2d cosine_cell(const Vec3f& w) {
    return {double{w.x} * w.x + double{w.y} * w.y, turn(w.y, w.x)};
}
Vec2d hemisphere_cell(const Vec3f& w) {
    return {w.z, turn(w.y, w.x)};
}
Vec2d sphere_cell(const Vec3f& w) {
    return {0.5 + 0.5 * w.z, turn(w.y, w.x)};
}

TEST(Warp, SamplesFollowTheirDensities) {
    EXPECT_GT(uniformity([](const Vec2f& u) { return disk_cell(sample_concentric_disk(u)); }, 1),
              kSignificance);
    EXPECT_GT(
        uniformity([](const Vec2f& u) { return cosine_cell(sample_cosine_hemisphere(u)); }, 2),
        kSignificance);
    EXPECT_GT(
        uniformity([](const Vec2f& u) { return hemisphere_cell(sample_uniform_hemisphere(u)); }, 3),
        kSignificance);
    EXPECT_GT(uniformity([](const Vec2f& u) { return sphere_cell(sample_uniform_sphere(u)); }, 4),
              kSignificance);
    EXPECT_GT(uniformity(
                  [](const Vec2f& u) {
                      const Vec3f b = sample_uniform_triangle(u);
                      const double s = 1 - double{b.z};
                      return Vec2d(s * s, b.x / std::max(s, 1e-30));
                  },
                  6),
              kSignificance);
    for (const float cap : {2.0f, 0.3f, 1e-4f, 1e-9f}) {
        EXPECT_GT(uniformity(
                      [cap](const Vec2f& u) {
                          const Vec3f w = sample_uniform_cone(u, cap);
                          const double s2 = double{w.x} * w.x + double{w.y} * w.y;
                          const double root = std::sqrt(std::max(0.0, 1 - s2));
                          const double one_minus_z = w.z >= 0 ? s2 / (1 + root) : 1 + root;
                          return Vec2d(one_minus_z / cap, turn(w.y, w.x));
                      },
                      7),
                  kSignificance)
            << cap;
    }
}

TEST(Warp, ControlsFail) {
    const auto untransformed = [](const Vec2f& u) {
        const Vec3f b = sample_uniform_triangle(u);
        return Vec2d(1 - b.z, b.x / std::max(1 - b.z, 1e-30f));
    };
    EXPECT_LT(uniformity(untransformed, 5), 1e-9);
    // A cosine lobe taken for a uniform hemisphere, and one whose azimuth is off by a factor 1.02.
    EXPECT_LT(
        uniformity([](const Vec2f& u) { return hemisphere_cell(sample_cosine_hemisphere(u)); }, 8),
        1e-9);
    EXPECT_LT(uniformity(
                  [](const Vec2f& u) {
                      return cosine_cell(sample_cosine_hemisphere({0.98f * u.x, u.y}));
                  },
                  9),
              1e-9);
}

TEST(Warp, DensitiesIntegrateToOne) {
    constexpr int kSteps = 2000;
    double cosine = 0;
    for (int i = 0; i < kSteps; ++i) {
        cosine += 2 * std::numbers::pi / kSteps *
                  pdf_cosine_hemisphere((static_cast<float>(i) + 0.5f) / kSteps);
    }
    EXPECT_NEAR(cosine, 1, 1e-6);
    EXPECT_EQ(pdf_cosine_hemisphere(-0.5f), 0);
    EXPECT_NEAR(pdf_uniform_hemisphere() * 2 * kPi, 1, 1e-6);
    EXPECT_NEAR(pdf_uniform_sphere() * 4 * kPi, 1, 1e-6);
    EXPECT_NEAR(pdf_concentric_disk_area() * kPi, 1, 1e-6);
    EXPECT_NEAR(pdf_uniform_cone(0.25f) * 2 * kPi * 0.25f, 1, 1e-6);
    EXPECT_NEAR(pdf_uniform_triangle_area(4.0f) * 4, 1, 1e-6);
}

TEST(Warp, SineAndCosineOfATurn) {
    double worst = 0;
    for (int i = 0; i <= 1 << 20; ++i) {
        const float u = static_cast<float>(i) / (1 << 20);
        float s = 0;
        float c = 0;
        sin_cos_turn(u, s, c);
        const double angle = 2 * std::numbers::pi * u;
        worst = std::max({worst, std::abs(s - std::sin(angle)), std::abs(c - std::cos(angle))});
    }
    EXPECT_LT(worst, 1.5e-7);
}

// The last 512 floats below 1, and zero: S14.
std::vector<float> extreme_numbers() {
    std::vector<float> us{0, std::numeric_limits<float>::denorm_min(),
                          std::numeric_limits<float>::min(), 0x1p-24f};
    float u = 1;
    for (int i = 0; i < 512; ++i) us.push_back(u = std::nextafter(u, 0.0f));
    for (int k = 1; k < 24; ++k) us.push_back(std::ldexp(1.0f, -k));
    return us;
}

int defects(const Vec3f& w) {
    if (!is_finite(w)) return 1;
    const double length = std::sqrt(dot(Vec3d(w), Vec3d(w)));
    return std::abs(length - 1) > 4 * 0x1p-24 ? 1 : 0;
}

TEST(Warp, EndsOfTheUnitIntervalAreSafe) {
    int bad = 0;
    int zero_density = 0;
    int outside = 0;
    for (const float x : extreme_numbers()) {
        for (const float y : extreme_numbers()) {
            const Vec2f u(x, y);
            const Vec3f w = sample_cosine_hemisphere(u);
            bad += defects(w) + defects(sample_uniform_hemisphere(u)) +
                   defects(sample_uniform_sphere(u)) + defects(sample_uniform_cone(u, 1e-6f));
            zero_density += pdf_cosine_hemisphere(w.z) > 0 ? 0 : 1;
            const Vec3f b = sample_uniform_triangle(u);
            outside += b.x >= 0 && b.y >= 0 && b.z >= 0 && is_finite(b) ? 0 : 1;
            const Vec2f d = sample_concentric_disk(u);
            outside += dot(d, d) <= 1 + 4 * 0x1p-23f ? 0 : 1;
        }
    }
    EXPECT_EQ(bad, 0);
    EXPECT_EQ(zero_density, 0);
    EXPECT_EQ(outside, 0);
}

TEST(Warp, ControlUnguardedRootLosesItsDensity) {
    int zero_density = 0;
    for (const float x : extreme_numbers()) {
        for (const float y : extreme_numbers()) {
            const Vec2f d = sample_concentric_disk({x, y});
            const float z = std::sqrt(std::max(0.0f, 1 - dot(d, d)));
            zero_density += pdf_cosine_hemisphere(z) > 0 ? 0 : 1;
        }
    }
    EXPECT_GT(zero_density, 0);
}

// Defects of a basis maker over normals log-dense near every axis, signed zeros included: S12.
double worst_basis(const std::function<void(const Vec3f&, Vec3f&, Vec3f&)>& make) {
    Random random(21);
    double worst = 0;
    const auto judge = [&](const Vec3f& n) {
        Vec3f t;
        Vec3f b;
        make(n, t, b);
        const Vec3d nd(n), td(t), bd(b);
        if (!(dot(cross(td, bd), nd) > 0.999)) worst = 1e9;
        for (const double e :
             {dot(nd, td), dot(nd, bd), dot(td, bd), length(td) - 1, length(bd) - 1}) {
            worst = is_finite(e) ? std::max(worst, std::abs(e)) : 1e9;
        }
    };
    for (int i = 0; i < 1000000; ++i) {
        Vec3d v(random.between(-1, 1), random.between(-1, 1), random.between(-1, 1));
        if (i % 2 == 0) {
            const int axis = i / 2 % 3;
            for (int k = 0; k < 3; ++k)
                v[k] *= k == axis ? 1 : std::pow(10.0, random.between(-12, 0));
        }
        const double l = length(v);
        if (l > 1e-20) judge(Vec3f(v / l));
    }
    for (int axis = 0; axis < 3; ++axis) {
        for (int signs = 0; signs < 8; ++signs) {
            Vec3f n(0);
            n[axis] = 1;
            for (int k = 0; k < 3; ++k) n[k] = (signs >> k & 1) != 0 ? -n[k] : n[k];
            judge(n);
        }
    }
    return worst;
}

TEST(Basis, IsOrthonormalEverywhere) {
    EXPECT_LE(worst_basis(orthonormal_basis), 4 * 0x1p-24);
}

TEST(Basis, ControlWithASingularPoleFails) {
    EXPECT_GT(worst_basis([](const Vec3f& n, Vec3f& t, Vec3f& b) {
                  const float a = 1 / (1 + n.z);
                  const float c = -n.x * n.y * a;
                  t = Vec3f(1 - n.x * n.x * a, c, -n.x);
                  b = Vec3f(c, 1 - n.y * n.y * a, -n.y);
              }),
              1e-3);
}

}  // namespace
}  // namespace talbot
