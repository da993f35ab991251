// Limits of the surface model: alpha towards a mirror (catalogue S02), factors at their ends, index
// 0.
#include <gtest/gtest.h>

#include "oracles/scattering_cases.h"
#include "oracles/stats/random.h"

namespace talbot {
namespace {

// Light returned of a smooth sky that brightens towards one direction.
double lit_by_sky(const ScatteringCase& c, const View& v) {
    const Vec3f towards = normalize(Vec3f(-0.5f, 0.4f, 0.6f));
    const auto sky = [&](const Vec3f& wi) { return 1 + 0.5 * dot(wi, towards); };
    double sum = integrate_sphere(
        c, v, [&](const Vec3f& wi, const BsdfEval& e) { return e.f_cos.y * sky(wi); });
    for (const BsdfSample& s : delta_events(make_bsdf(c, v)))
        sum += double{s.weight.y} * s.pdf * sky(s.wi);
    return sum;
}

TEST(Limits, SmallAlphaJoinsTheMirror) {
    for (std::size_t kind = 0; kind < white_surfaces(0).size(); ++kind) {
        for (const float mu : {1.0f, 0.5f, 0.2f}) {
            const ScatteringCase mirror = white_surfaces(0)[kind];
            const double limit = lit_by_sky(mirror, {mu});
            for (const float alpha : {1e-8f, 1e-5f, 9e-4f}) {
                EXPECT_EQ(lit_by_sky(white_surfaces(alpha)[kind], {mu}), limit)
                    << mirror.name << ' ' << alpha;
            }
            for (const float alpha : {1e-3f, 2e-3f, 5e-3f, 1e-2f}) {
                const double value = lit_by_sky(white_surfaces(alpha)[kind], {mu});
                EXPECT_NEAR(value, limit, (2 * alpha + 2e-4) * limit)
                    << mirror.name << " alpha " << alpha << " mu " << mu;
            }
        }
    }
}

TEST(Limits, RangeOfAlphaIsFinite) {
    stats::Random random(1);
    for (int i = 0; i < 200000; ++i) {
        const float alpha =
            i % 7 == 0 ? 0.0f : static_cast<float>(std::pow(10.0, random.between(-10, 0)));
        const std::vector<ScatteringCase> cases = white_surfaces(alpha);
        const ScatteringCase& c = cases[static_cast<std::size_t>(i) % cases.size()];
        const View v{static_cast<float>(std::pow(10.0, random.between(-7, 0)))};
        const FullBsdf bsdf = make_bsdf(c, v);
        const float u_lobe = random();
        const auto s = bsdf.sample(u_lobe, random.pair());
        if (s) {
            ASSERT_TRUE(is_finite(s->weight) && is_finite(s->pdf) && is_finite(s->wi))
                << c.name << ' ' << alpha;
        }
        const BsdfEval e = bsdf.eval(sample_uniform_sphere(random.pair()));
        ASSERT_TRUE(is_finite(e.f_cos) && is_finite(e.pdf)) << c.name << ' ' << alpha;
    }
}

ShadingParams smooth_plastic() {
    ShadingParams p;
    p.alpha = 0;
    return p;
}

TEST(Limits, MirrorFollowsSchlick) {
    for (const float mu : {1.0f, 0.7f, 0.2f, 0.01f}) {
        const View v{mu};
        ShadingParams p = smooth_plastic();
        p.base_color = Rgb(0.9f, 0.5f, 0.1f);
        const double schlick = 0.04 + 0.96 * std::pow(1.0 - double{mu}, 5);
        const auto plastic = delta_events(make_bsdf({"plastic", p, true}, v));
        ASSERT_EQ(plastic.size(), 1u);
        EXPECT_NEAR(plastic[0].weight.x * plastic[0].pdf, schlick, 1e-6);
        EXPECT_EQ(plastic[0].wi, Vec3f(-v.wo().x, 0, v.wo().z));
        p.metallic = 1;
        const auto metal = delta_events(make_bsdf({"metal", p, true}, v));
        ASSERT_EQ(metal.size(), 1u);
        EXPECT_EQ(metal[0].pdf, 1);
        for (int k = 0; k < 3; ++k) {
            const double f =
                p.base_color[k] + (1 - p.base_color[k]) * std::pow(1.0 - double{mu}, 5);
            EXPECT_NEAR(metal[0].weight[k], f, 1e-6);
        }
    }
}

TEST(Limits, DiffuseUnderAMirrorIsAnalytic) {
    // (1 - S_o) (1 - S_i) / (1 - mean S) base / pi with Schlick's S.
    const View v{0.6f};
    const FullBsdf bsdf = make_bsdf({"plastic", smooth_plastic(), true}, v);
    const auto escaping = [](double mu) { return 1 - (0.04 + 0.96 * std::pow(1 - mu, 5)); };
    const double mean = 1 - (0.04 + 0.96 / 21);
    for (const float mu : {1.0f, 0.5f, 0.1f}) {
        const Vec3f wi(0, std::sqrt(1 - mu * mu), mu);
        const double expected = escaping(0.6f) * escaping(mu) / mean * mu / std::numbers::pi;
        EXPECT_NEAR(bsdf.eval(wi).f_cos.x, expected, 1e-6);
        const Vec3f other = v.wo();
        const FullBsdf reversed({smooth_plastic()}, Frame{}, Vec3f(0, 0, 1), wi, true);
        EXPECT_NEAR(reversed.eval(other).f_cos.x / other.z, expected / mu, 1e-6) << "reciprocity";
    }
}

TEST(Limits, LambertIsExact) {
    ShadingParams p;
    p.specular = 0;
    p.base_color = Rgb(0.25f, 0.5f, 1);
    const FullBsdf bsdf = make_bsdf({"lambert", p, true}, {0.3f});
    const Vec3f wi = normalize(Vec3f(0.3f, -0.4f, 0.8f));
    const BsdfEval e = bsdf.eval(wi);
    EXPECT_EQ(e.pdf, wi.z * kInvPi);
    EXPECT_EQ(e.f_cos, e.pdf * p.base_color);
    EXPECT_EQ(bsdf.eval(-wi).pdf, 0);
}

TEST(Limits, ThinWallGoesStraightOn) {
    ShadingParams p;
    p.transmission = 1;
    p.alpha = 0;
    p.base_color = Rgb(0.5f, 1, 1);
    const View v{0.4f};
    const auto events = delta_events(make_bsdf({"thin", p, true}, v));
    ASSERT_EQ(events.size(), 2u);
    EXPECT_EQ(events[1].wi, -v.wo());
    EXPECT_EQ(events[1].eta, 1);
    EXPECT_TRUE(events[1].transmitted);
    const float f = fresnel_dielectric(0.4f, 1.5f).reflectance;
    EXPECT_NEAR(events[1].weight.x * events[1].pdf, 0.5f * (1 - f), 1e-6);
    EXPECT_NEAR(events[0].weight.y * events[0].pdf, f, 1e-6);
}

TEST(Limits, SpecularFactorScalesGlassButNotTotalReflection) {
    ShadingParams p;
    p.transmission = 1;
    p.thin = false;
    p.alpha = 0;
    p.specular = 0;
    const auto clear = delta_events(make_bsdf({"glass", p, true}, {0.5f}));
    ASSERT_EQ(clear.size(), 1u);
    EXPECT_TRUE(clear[0].transmitted);
    const auto trapped = delta_events(make_bsdf({"glass", p, false}, {0.5f}));
    ASSERT_EQ(trapped.size(), 1u);
    EXPECT_FALSE(trapped[0].transmitted);
    EXPECT_EQ(trapped[0].weight, Rgb(1));
}

TEST(Limits, SpecularColourIsClampedBeforeTheFactor) {
    ShadingParams p = smooth_plastic();
    p.specular = 0.5f;
    p.specular_color = Rgb(100, 1, 0);
    const auto events = delta_events(make_bsdf({"tinted", p, true}, {1}));
    ASSERT_EQ(events.size(), 1u);
    const Rgb f0 = events[0].weight * events[0].pdf;
    EXPECT_NEAR(f0.x, 0.5f, 1e-6);
    EXPECT_NEAR(f0.y, 0.02f, 1e-6);
    EXPECT_NEAR(f0.z, 0, 1e-6);
}

TEST(Limits, RoughReflectionOfGlassAndSpecularOfPlasticShareTheirLobe) {
    // Metal of reflectance 1, uncompensated shape: f D V with F = 1 up to the compensation, the
    // same at every wi.
    ShadingParams p;
    p.metallic = 1;
    p.alpha = 0.3f;
    const View v{0.6f};
    const FullBsdf metal = make_bsdf({"metal", p, true}, v);
    const Ggx ggx(0.3f);
    stats::Random random(3);
    double scale = 0;
    for (int i = 0; i < 100; ++i) {
        const Vec3f wi = sample_cosine_hemisphere(random.pair());
        const Vec3f h = normalize(wi + v.wo());
        const double single = double{ggx.d(h)} * ggx.g2(v.wo(), wi) / (4 * double{v.wo().z});
        const double ratio = metal.eval(wi).f_cos.x / single;
        if (i == 0) scale = ratio;
        EXPECT_NEAR(ratio, scale, 1e-4);
    }
    EXPECT_NEAR(scale, 1 / AlbedoRow(0.3f)(0.6f).e(), 1e-4);
}

}  // namespace
}  // namespace talbot
