// sample(), eval() and pdf of a whole BSDF against each other: chi-square with cells that follow
// the lobe's width, and the density's integral.
#pragma once

#include "oracles/scattering_cases.h"
#include "oracles/stats/chi2.h"
#include "oracles/stats/random.h"

namespace talbot {

// Coloured surfaces of every kind: all lobes differ from one another.
inline std::vector<ScatteringCase> coloured_surfaces(float alpha) {
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
    int wrong_side = 0;  // samples not on the side that they say
};

inline Agreement compare_with_density(const ScatteringCase& c, const View& v, int draws,
                                      uint64_t seed, const Fault& fault = {}) {
    const FullBsdf bsdf = make_bsdf(c, v);
    const stats::SphereCells upper(lobe_axis(c, v, false), c.lobe_width(), 16, 8);
    const stats::SphereCells lower(lobe_axis(c, v, true), c.lobe_width(), 16, 8);
    const std::size_t n = upper.size();
    std::vector<double> observed(2 * n + 2, 0.0);  // then delta events and empty samples
    std::vector<double> expected(2 * n + 2, 0.0);
    stats::Random random(seed);
    Agreement result;
    for (int i = 0; i < draws; ++i) {
        const float u_lobe = random();
        const auto s = bsdf.sample(u_lobe, random.pair());
        std::size_t cell = 2 * n + 1;
        if (s && s->delta) cell = 2 * n;
        if (s && !s->delta) {
            const stats::SphereCells& cells = s->transmitted ? lower : upper;
            const std::size_t shift = fault.shift * static_cast<std::size_t>(cells.sectors());
            cell = std::min(cells.cell_of(s->wi) + shift, n - 1) + (s->transmitted ? n : 0);
            if (s->transmitted != (s->wi.z < 0)) ++result.wrong_side;
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

inline std::vector<Setting> scattering_settings() {
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

}  // namespace talbot
