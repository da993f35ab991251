// sample(), eval() and pdf of the whole BSDF agree (catalogue S08, S09): chi-square with cells that
// follow the lobe's width, density integrates to one, a returned record equals a fresh evaluation,
// the mean weight equals the integral of the value.
#include <gtest/gtest.h>

#include "oracles/bsdf_agreement.h"
#include "oracles/stats/ztest.h"

namespace talbot {
namespace {

using stats::Random;

TEST(BsdfSampling, FollowsItsDensity) {
    const std::vector<Setting> list = scattering_settings();
    const double significance = stats::sidak(stats::kFalseAlarm, static_cast<int>(list.size()));
    uint64_t seed = 1;
    for (const Setting& s : list) {
        const Agreement a = compare_with_density(s.surface, s.view, 30000, ++seed);
        const std::string name =
            s.surface.name + " alpha " + std::to_string(s.surface.params.alpha) + s.view.text();
        EXPECT_GT(a.p, significance) << name;
        EXPECT_LE(std::abs(a.missing), 1e-3 + 4.5 * a.error) << name;
        EXPECT_EQ(a.wrong_side, 0) << name;
    }
}

TEST(BsdfSampling, ControlsFail) {
    const std::vector<ScatteringCase> surfaces = coloured_surfaces(0.02f);
    for (const std::size_t kind : {std::size_t{1}, std::size_t{5}, std::size_t{7}}) {
        const View view{0.8f};
        EXPECT_LT(compare_with_density(surfaces[kind], view, 30000, 11, {1, 1}).p, 1e-9)
            << "shifted by one ring";
        const Agreement scaled = compare_with_density(surfaces[kind], view, 30000, 12, {1.02, 0});
        EXPECT_GT(std::abs(scaled.missing), 1e-3 + 4.5 * scaled.error) << "density scaled";
        const double p = compare_with_density(surfaces[kind], view, 400000, 13, {1.02, 0}).p;
        EXPECT_LT(p, 1e-6) << "density scaled";
    }
}

TEST(BsdfSampling, RecordsEqualFreshEvaluations) {
    Random random(4);
    int checked = 0;
    double worst = 0;
    for (const Setting& s : scattering_settings()) {
        const FullBsdf bsdf = make_bsdf(s.surface, s.view);
        for (int i = 0; i < 4000; ++i) {
            const auto r = bsdf.sample(random(), random.pair());
            if (!r) continue;
            ASSERT_TRUE(is_finite(r->wi) && is_finite(r->weight) && is_finite(r->pdf))
                << s.surface.name;
            ASSERT_NEAR(length(Vec3d(r->wi)), 1, 2e-6) << s.surface.name;
            ASSERT_GE(min_component(r->weight), 0);
            const BsdfEval fresh = make_bsdf(s.surface, s.view).eval(r->wi);
            if (r->delta) continue;
            worst = std::max(worst, std::abs(double{r->pdf} / fresh.pdf - 1));
            for (int k = 0; k < 3; ++k) {
                const double product = double{r->weight[k]} * r->pdf;
                if (fresh.f_cos[k] > 0)
                    worst = std::max(worst, std::abs(product / fresh.f_cos[k] - 1));
            }
            ++checked;
        }
    }
    EXPECT_GT(checked, 100000);
    EXPECT_LT(worst, 1e-6);
}

TEST(BsdfSampling, MeanWeightIsTheIntegralOfTheValue) {
    const std::vector<Setting> list = scattering_settings();
    const double significance = stats::sidak(stats::kFalseAlarm, static_cast<int>(list.size()));
    Random random(6);
    for (const Setting& s : list) {
        const FullBsdf bsdf = make_bsdf(s.surface, s.view);
        const double eta2 = double{s.surface.eta()} * s.surface.eta();
        stats::Moments m;
        for (int i = 0; i < 20000; ++i) {
            const float u_lobe = random();
            const auto r = bsdf.sample(u_lobe, random.pair());
            m.add(r ? static_cast<double>(mean_component(r->weight)) * (r->transmitted ? eta2 : 1.0)
                    : 0.0);
        }
        const double expected = albedo(s.surface, s.view);
        const double error = std::sqrt(m.standard_error() * m.standard_error() + 1e-10);
        if (std::abs(m.mean() - expected) < 2e-4) continue;  // the quadrature's own error
        EXPECT_GT(stats::z_test(m.mean(), expected, error), significance)
            << s.surface.name << " alpha " << s.surface.params.alpha << s.view.text() << ": "
            << m.mean() << " against " << expected;
    }
}

TEST(BsdfSampling, NothingBreaksAtTheEndsOfTheUnitInterval) {
    const std::vector<float> ends{0,
                                  std::numeric_limits<float>::denorm_min(),
                                  0x1p-24f,
                                  0.5f,
                                  1 - 0x1p-23f,
                                  kOneMinusEpsilon};
    for (const float alpha : {0.0f, 1e-8f, 1e-5f, 5e-4f, 1e-3f, 1e-2f, 0.3f, 1.0f}) {
        for (const ScatteringCase& c : coloured_surfaces(alpha)) {
            for (const View view :
                 {View{1}, View{0.5f}, View{1e-4f}, View{1e-7f}, View{0}, View{0.01f, 1.2f, 3}}) {
                const FullBsdf bsdf = make_bsdf(c, view);
                for (const float u_lobe : ends) {
                    for (const float x : ends) {
                        for (const float y : ends) {
                            const auto s = bsdf.sample(u_lobe, {x, y});
                            if (!s) continue;
                            ASSERT_TRUE(is_finite(s->wi) && is_finite(s->weight) &&
                                        is_finite(s->pdf))
                                << c.name << alpha << view.text();
                            ASSERT_GT(s->pdf, 0);
                            const BsdfEval e = bsdf.eval(s->wi);
                            ASSERT_TRUE(is_finite(e.f_cos) && is_finite(e.pdf))
                                << c.name << alpha << view.text();
                        }
                    }
                }
            }
        }
    }
}

}  // namespace
}  // namespace talbot
