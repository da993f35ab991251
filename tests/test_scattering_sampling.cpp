// sample(), eval() and pdf of the whole BSDF agree (catalogue S08, S09): chi-square with cells that
// follow the lobe's width, density integrates to one, a returned record equals a fresh evaluation,
// the mean weight equals the integral of the value.
#include <gtest/gtest.h>

#include "tests/scattering_cases.h"
#include "tests/stats/chi2.h"
#include "tests/stats/random.h"
#include "tests/stats/ztest.h"

namespace talbot {
namespace {

using stats::Random;

// Coloured surfaces of every kind: all lobes differ from one another.
std::vector<ScatteringCase> coloured_surfaces(float alpha) {
    std::vector<ScatteringCase> cases = white_surfaces(alpha);
    for (ScatteringCase& c : cases) c.params.base_color = Rgb(0.8f, 0.5f, 0.2f);
    ScatteringCase tinted = cases[1];
    tinted.name = "tinted specular";
    tinted.params.specular_color = Rgb(3, 0.5f, 0.1f);
    tinted.params.specular = 0.7f;
    cases.push_back(tinted);
    tinted.name = "tinted glass";
    tinted.params.transmission = 1;
    tinted.params.thin = false;
    cases.push_back(tinted);
    for (ScatteringCase c : layered_surfaces(alpha)) {
        c.params.base_color = Rgb(0.8f, 0.5f, 0.2f);
        c.params.diffuse_transmission_color = Rgb(0.3f, 0.6f, 0.9f);
        c.params.sheen_color *= Rgb(0.2f, 0.5f, 1);
        cases.push_back(c);
    }
    return cases;
}

struct Fault {
    double scale = 1;       // of the expected density
    std::size_t shift = 0;  // of the histogram, in rings
};

struct Agreement {
    double p = 1;        // of chi-square
    double missing = 0;  // 1 - (integral of the density + delta + share of empty samples)
    double error = 0;    // standard error of `missing`
};

Agreement compare_with_density(const ScatteringCase& c, const View& v, int draws, uint64_t seed,
                               const Fault& fault = {}) {
    const FullBsdf bsdf = make_bsdf(c, v);
    const stats::SphereCells upper(lobe_axis(c, v, false), c.lobe_width(), 16, 8);
    const stats::SphereCells lower(lobe_axis(c, v, true), c.lobe_width(), 16, 8);
    const std::size_t n = upper.size();
    std::vector<double> observed(2 * n + 2, 0.0);  // then delta events and empty samples
    std::vector<double> expected(2 * n + 2, 0.0);
    Random random(seed);
    for (int i = 0; i < draws; ++i) {
        const float u_lobe = random();
        const auto s = bsdf.sample(u_lobe, random.pair());
        std::size_t cell = 2 * n + 1;
        if (s && s->delta) cell = 2 * n;
        if (s && !s->delta) {
            const stats::SphereCells& cells = s->transmitted ? lower : upper;
            const std::size_t shift = fault.shift * static_cast<std::size_t>(cells.sectors());
            cell = std::min(cells.cell_of(s->wi) + shift, n - 1) + (s->transmitted ? n : 0);
            EXPECT_EQ(s->transmitted, s->wi.z < 0);
        }
        ++observed[cell];
    }
    double total = 0;
    for (std::size_t i = 0; i < 2 * n; ++i) {
        const bool below = i >= n;
        if (below && !c.transmits()) break;
        expected[i] =
            (below ? lower : upper)
                .integrate(
                    i % n,
                    [&](const Vec3f& wi) { return (wi.z < 0) == below ? bsdf.eval(wi).pdf : 0.0f; },
                    1e-6);
        expected[i] *= fault.scale * draws;
        total += expected[i];
        // What the quadrature may have missed of a cell that hardly anything reaches.
        expected[i] = std::max(expected[i], 1e-6 * draws);
    }
    for (const BsdfSample& s : delta_events(bsdf)) expected[2 * n] += draws * double{s.pdf};
    total += expected[2 * n];
    expected.back() = std::max(draws - total, 0.0);
    Agreement result;
    const double empty = observed.back() / draws;
    result.missing = 1 - total / draws - empty;
    result.error = std::sqrt(empty * (1 - empty) / draws);
    if (observed.back() < 5 && expected.back() < 1e-3 * draws) {
        observed.pop_back();  // no sample is empty: the quadrature's own error is no evidence
        expected.pop_back();
    }
    result.p = stats::chi2_test(observed, expected, 1).p;
    return result;
}

struct Setting {
    ScatteringCase surface;
    View view;
};

std::vector<Setting> settings() {
    std::vector<Setting> list;
    const std::vector<View> views{{0.95f}, {0.4f}, {0.05f}, {0.6f, 0.5f, 0.7f}, {0.3f, 0.9f, 2.5f}};
    std::size_t k = 0;
    for (const float alpha : {0.0f, 1e-3f, 0.02f, 0.2f, 1.0f}) {
        for (const ScatteringCase& c : coloured_surfaces(alpha)) {
            // Too slender for the quadrature of the expectations.
            if (c.params.anisotropy > 0 && alpha < 0.01f) continue;
            list.push_back({c, views[k++ % views.size()]});
            if (alpha > 0) list.push_back({c, views[k++ % views.size()]});
        }
        ++k;
    }
    return list;
}

TEST(BsdfSampling, FollowsItsDensity) {
    const std::vector<Setting> list = settings();
    const double significance = stats::sidak(stats::kFalseAlarm, static_cast<int>(list.size()));
    uint64_t seed = 1;
    for (const Setting& s : list) {
        const Agreement a = compare_with_density(s.surface, s.view, 30000, ++seed);
        const std::string name =
            s.surface.name + " alpha " + std::to_string(s.surface.params.alpha) + s.view.text();
        EXPECT_GT(a.p, significance) << name;
        EXPECT_LE(std::abs(a.missing), 1e-3 + 4.5 * a.error) << name;
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
    for (const Setting& s : settings()) {
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
    const std::vector<Setting> list = settings();
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
