// GGX: the distribution near specular (catalogue S01), visible normals at grazing (S03), sampling
// against density (S08).
#include <gtest/gtest.h>

#include "oracles/visible_normals.h"

namespace talbot {
namespace {

using stats::Random;

// D in extended precision from the same float inputs.
long double reference_d(float ax, float ay, const Vec3f& h) {
    const long double x = static_cast<long double>(h.x) / ax;
    const long double y = static_cast<long double>(h.y) / ay;
    const long double q = x * x + y * y + static_cast<long double>(h.z) * h.z;
    return 1 / (std::numbers::pi_v<long double> * ax * ay * q * q);
}

// The textbook's isotropic form, which cancels.
float naive_d(float alpha, const Vec3f& h) {
    const float a2 = alpha * alpha;
    const float t = h.z * h.z * (a2 - 1) + 1;
    return a2 / (kPi * t * t);
}

struct Accuracy {
    double worst = 0;
    int not_finite = 0;

    void add(float x, long double reference) {
        if (!is_finite(x)) {
            ++not_finite;
            return;
        }
        worst = std::max(worst, static_cast<double>(std::abs(x - reference) / reference));
    }
};

TEST(Ggx, DistributionIsExactNearSpecular) {
    Accuracy ours;
    Accuracy naive;
    Random random(1);
    for (int i = 0; i < 400000; ++i) {
        const double alpha = std::pow(10.0, random.between(-4, 0));
        const double anisotropy = i % 2 == 0 ? 1 : std::pow(10.0, random.between(-3, 3));
        const auto clamp = [](double a) { return static_cast<float>(std::clamp(a, 1e-4, 1.0)); };
        const float ax = clamp(alpha * std::sqrt(anisotropy));
        const float ay = clamp(alpha / std::sqrt(anisotropy));
        const double theta = std::min(random.between(0, 40) * std::min(ax, ay), 1.57);
        const double phi = random.between(0, 2 * std::numbers::pi);
        const Vec3f h(static_cast<float>(std::sin(theta) * std::cos(phi)),
                      static_cast<float>(std::sin(theta) * std::sin(phi)),
                      static_cast<float>(std::cos(theta)));
        ours.add(Ggx(ax, ay).d(h), reference_d(ax, ay, h));
        if (ax == ay) naive.add(naive_d(ax, h), reference_d(ax, ay, h));
    }
    EXPECT_LE(ours.worst, 2e-6);
    EXPECT_EQ(ours.not_finite, 0);
    EXPECT_TRUE(naive.worst > 0.05 || naive.not_finite > 0) << "control";
}

double integral_of(const Ggx& ggx, const Vec3f& wo, float density_scale) {
    return visible_normals_integral(
        ggx, [&](const Vec3f& h) { return density_scale * ggx.pdf_visible_normal(wo, h); });
}

TEST(Ggx, VisibleNormalsIntegrateToOne) {
    for (const float alpha : {1e-4f, 1e-3f, 0.03f, 0.3f, 1.0f}) {
        for (const float mu : {1.0f, 0.5f, 0.1f, 1e-3f, 1e-5f, 1e-7f}) {
            const Vec3f wo(std::sqrt(1 - mu * mu), 0, mu);
            EXPECT_NEAR(integral_of(Ggx(alpha), wo, 1), 1, 1e-4) << alpha << ' ' << mu;
        }
    }
    EXPECT_NEAR(integral_of(Ggx(0.05f, 0.8f), normalize(Vec3f(0.7f, 0.3f, 0.1f)), 1), 1, 1e-4);
    EXPECT_GT(integral_of(Ggx(0.1f), Vec3f(0, 0, 1), 1.02f), 1 + 1e-4) << "control";
}

TEST(Ggx, SampledAndRecomputedDensitiesAgree) {
    Random random(5);
    int not_finite = 0;
    int below = 0;
    for (const float alpha : {1e-4f, 1e-3f, 1e-2f, 0.1f, 1.0f}) {
        for (const float mu : {1.0f, 0.3f, 1e-2f, 1e-4f, 1e-7f}) {
            const Ggx ggx(alpha);
            const Vec3f wo(std::sqrt(1 - mu * mu), 0, mu);
            const float slant = ggx.slant(wo);
            double worst = 0;
            for (int i = 0; i < 4000; ++i) {
                const Vec3f h = ggx.sample_visible_normal(wo, random.pair());
                if (!is_finite(h) || !(h.z > 0)) ++not_finite;
                const float cos_d = dot(wo, h);
                const Vec3f wi = 2 * cos_d * h - wo;
                if (!(wi.z > 0)) {
                    ++below;
                    continue;
                }
                const double sampled =
                    static_cast<double>(ggx.pdf_visible_normal(wo, h)) / (4 * cos_d);
                const GgxReflection r = ggx.eval_reflection(wo, slant, wi);
                if (!is_finite(r.pdf) || !is_finite(r.value_cos)) ++not_finite;
                worst = std::max(worst, std::abs(r.pdf / sampled - 1));
            }
            EXPECT_LE(worst, std::max(1e-4, 16 * 0x1p-24 / (double{alpha} * mu)))
                << alpha << ' ' << mu;
        }
    }
    EXPECT_EQ(not_finite, 0);
    EXPECT_GT(below, 0);
}

TEST(Ggx, VisibleNormalsFollowTheirDensity) {
    constexpr int kTests = 20;
    const double significance = stats::sidak(stats::kFalseAlarm, kTests);
    uint64_t seed = 100;
    for (const float alpha : {1e-3f, 1e-2f, 0.1f, 0.5f, 1.0f}) {
        for (const float mu : {1.0f, 0.5f, 0.05f}) {
            const Vec3f wo(std::sqrt(1 - mu * mu), 0, mu);
            EXPECT_GT(visible_normals_p(Ggx(alpha), wo, 0, 1, ++seed), significance)
                << alpha << ' ' << mu;
        }
    }
    EXPECT_GT(
        visible_normals_p(Ggx(0.02f, 0.4f), normalize(Vec3f(0.6f, -0.5f, 0.3f)), 0, 1, ++seed),
        significance);
    EXPECT_LT(visible_normals_p(Ggx(0.01f), Vec3f(0, 0, 1), 0, 1.02, ++seed, 1000000), significance)
        << "control: scaled";
    EXPECT_LT(visible_normals_p(Ggx(0.01f), Vec3f(0, 0, 1), 1, 1, ++seed), significance)
        << "control: shifted";
}

TEST(Ggx, MaskingMatchesItsDefinition) {
    // G1 from the integral over slopes and G2 from Lambda, in double.
    const auto lambda = [](double a, const Vec3f& w) {
        const double tan2 = (1 - double{w.z} * w.z) / (double{w.z} * w.z);
        return 0.5 * (std::sqrt(1 + a * a * tan2) - 1);
    };
    Random random(8);
    for (int i = 0; i < 2000; ++i) {
        const float alpha = static_cast<float>(random.between(0.01, 1));
        const Ggx ggx(alpha);
        const Vec3f wo = sample_cosine_hemisphere(random.pair());
        const Vec3f wi = sample_cosine_hemisphere(random.pair());
        EXPECT_NEAR(ggx.g1(wo), 1 / (1 + lambda(alpha, wo)), 2e-6);
        EXPECT_NEAR(ggx.g2(wo, wi), 1 / (1 + lambda(alpha, wo) + lambda(alpha, wi)), 2e-6);
    }
}

}  // namespace
}  // namespace talbot
