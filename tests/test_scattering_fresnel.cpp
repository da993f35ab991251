// Fresnel reflectance and refraction: matched indices, the critical angle, huge indices (catalogue
// S04).
#include <gtest/gtest.h>

#include "core/scattering/bsdf.h"
#include "core/scattering/fresnel.h"
#include "oracles/stats/random.h"

namespace talbot {
namespace {

using Real = long double;

Real reference_fresnel(float cos_i, float eta) {
    const Real c = cos_i;
    const Real n = eta;
    const Real cos2_t = 1 - (1 - c * c) / (n * n);
    if (cos2_t <= 0) return 1;
    const Real ct = std::sqrt(cos2_t);
    const Real s = (c - n * ct) / (c + n * ct);
    const Real p = (n * c - ct) / (n * c + ct);
    return (s * s + p * p) / 2;
}

const std::vector<float> kEtas{1 / 2.5f, 1 / 1.0001f, 1 - 0x1p-23f, 1,   1 + 0x1p-23f,
                               1.0001f,  1.5f,        2.5f,         1e3f};

// Cosines over [0, 1], and log-dense about the critical angle where there is one.
std::vector<float> cosines(float eta) {
    std::vector<float> list;
    for (int i = 0; i <= 4000; ++i) list.push_back(static_cast<float>(i) / 4000);
    if (eta < 1) {
        const double critical = std::sqrt(1 - double{eta} * eta);
        for (int k = 0; k <= 60; ++k) {
            const double step = std::pow(10.0, -9 + 0.1 * k);
            for (const double c : {critical - step, critical + step}) {
                if (c >= 0 && c <= 1) list.push_back(static_cast<float>(c));
            }
        }
        list.push_back(static_cast<float>(critical));
    }
    return list;
}

TEST(Fresnel, MatchesExtendedPrecision) {
    double worst = 0;
    double naive_worst = 0;
    for (const float eta : kEtas) {
        for (const float c : cosines(eta)) {
            const DielectricFresnel f = fresnel_dielectric(c, eta);
            EXPECT_GE(f.reflectance, 0);
            EXPECT_LE(f.reflectance, 1);
            if (is_index_matched(eta)) {
                EXPECT_EQ(f.reflectance, 0);
                EXPECT_EQ(f.cos_t, c);
                continue;
            }
            worst = std::max(
                worst, static_cast<double>(std::abs(f.reflectance - reference_fresnel(c, eta))));
            // Control: the refracted cosine in float.
            const float ct = safe_sqrt(1 - (1 - c * c) / (eta * eta));
            const float s = (c - eta * ct) / (c + eta * ct);
            const float p = (eta * c - ct) / (eta * c + ct);
            const double naive = 0.5 * (double{s} * s + double{p} * p);
            naive_worst = std::max(
                naive_worst, std::abs(naive - static_cast<double>(reference_fresnel(c, eta))));
        }
    }
    EXPECT_LE(worst, 1e-6);
    EXPECT_GT(naive_worst, 1e-5) << "control";
}

TEST(Fresnel, RefractionObeysSnellAndKeepsLength) {
    stats::Random random(3);
    double worst_length = 0;
    double worst_snell = 0;
    for (int i = 0; i < 200000; ++i) {
        const float eta = kEtas[static_cast<std::size_t>(i) % kEtas.size()];
        const float mu = random();
        const float phi = static_cast<float>(random.between(0, 6.28));
        const float s = std::sqrt(1 - mu * mu);
        const Vec3f wo(s * std::cos(phi), s * std::sin(phi), mu);
        const DielectricFresnel f = fresnel_dielectric(mu, eta);
        if (f.cos_t == 0) continue;
        const Vec3f wt = refract_through(wo, Vec3f(0, 0, 1), mu, f.cos_t, eta);
        worst_length = std::max(worst_length, std::abs(length(Vec3d(wt)) - 1));
        const double sine = std::sqrt(double{wt.x} * wt.x + double{wt.y} * wt.y);
        worst_snell = std::max(worst_snell, std::abs(sine * eta - s));
        EXPECT_LT(wt.z, 0);
    }
    EXPECT_LT(worst_length, 1e-6);
    EXPECT_LT(worst_snell, 1e-4);  // 1e3 times the rounding of a component at eta = 1e3
}

TEST(Fresnel, GrowsTowardsGrazingForCommonGlass) {
    for (const float eta : {1.0001f, 1.33f, 1.5f}) {
        float previous = 0;
        for (int i = 4000; i >= 0; --i) {
            const float f = fresnel_dielectric(static_cast<float>(i) / 4000, eta).reflectance;
            EXPECT_GE(f, previous) << eta << ' ' << i;
            previous = f;
        }
        EXPECT_EQ(previous, 1);
    }
}

TEST(Fresnel, SpecialIndices) {
    EXPECT_EQ(normal_reflectance(0), 1);
    EXPECT_EQ(normal_reflectance(1), 0);
    EXPECT_NEAR(normal_reflectance(1.5f), 0.04f, 1e-7f);
    EXPECT_EQ(schlick_weight(1), 0);
    EXPECT_EQ(schlick_weight(0), 1);
}

constexpr EffectSet kFullTier = EffectSet::all();

TEST(Fresnel, MatchedIndexIsInvisible) {
    stats::Random random(9);
    for (const float ior : {1.0f, 1 + 0x1p-23f, 1 - 0x1p-24f}) {
        for (const float alpha : {0.0f, 0.1f, 1.0f}) {
            for (int i = 0; i < 2000; ++i) {
                ShadingParams p;
                p.transmission = 1;
                p.thin = false;
                p.ior = ior;
                p.alpha = alpha;
                const Frame frame = Frame::from_normal(sample_uniform_sphere(random.pair()));
                Vec3f wo = sample_uniform_sphere(random.pair());
                if (dot(wo, frame.n) < 0) wo = -wo;
                const Bsdf<kFullTier> bsdf(p, frame, frame.n, wo, i % 2 == 0);
                EXPECT_FALSE(bsdf.has_smooth_lobe());
                const auto s = bsdf.sample(random(), random.pair());
                ASSERT_TRUE(s);
                EXPECT_EQ(s->wi, -wo);
                EXPECT_EQ(s->weight, Rgb(1));
                EXPECT_EQ(s->eta == 1 || ior != 1, true);
                EXPECT_TRUE(s->delta && s->transmitted);
            }
        }
    }
}

TEST(Fresnel, SmoothGlassSplitsExactly) {
    for (const bool outside : {true, false}) {
        for (int i = 1; i <= 200; ++i) {
            const float mu = static_cast<float>(i) / 200;
            ShadingParams p;
            p.transmission = 1;
            p.thin = false;
            p.alpha = 0;
            const Vec3f wo(std::sqrt(1 - mu * mu), 0, mu);
            const Frame frame;
            const Bsdf<kFullTier> bsdf(p, frame, frame.n, wo, outside);
            const auto reflected = bsdf.sample(0, {0, 0});
            const auto transmitted = bsdf.sample(kOneMinusEpsilon, {0, 0});
            ASSERT_TRUE(reflected && transmitted);
            const float eta = outside ? 1.5f : 1 / 1.5f;
            const double f = static_cast<double>(reference_fresnel(mu, eta));
            EXPECT_NEAR(reflected->weight.x * reflected->pdf, f, 1e-6);
            EXPECT_EQ(reflected->wi, Vec3f(-wo.x, -wo.y, wo.z));
            if (!transmitted->transmitted) continue;  // total internal reflection
            EXPECT_NEAR(transmitted->weight.x * transmitted->pdf * eta * eta, 1 - f, 1e-6);
            EXPECT_EQ(transmitted->eta, eta);
        }
    }
}

}  // namespace
}  // namespace talbot
