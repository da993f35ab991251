// Integral of GGX's density of visible normals, and its samples against that density.
#pragma once

#include <numbers>

#include "core/scattering/ggx.h"
#include "oracles/stats/chi2.h"
#include "oracles/stats/random.h"
#include "oracles/stats/sphere_cells.h"

namespace talbot {

// Integral of pdf(h), taken over slopes alpha r with r^2 = (1 - s^2) / s^2, where D cos has no
// peak; 1 for the density of visible normals.
template <typename Pdf>
double visible_normals_integral(const Ggx& ggx, const Pdf& pdf, int radial = 1500) {
    constexpr int kTurn = 256;
    double sum = 0;
    for (int i = 0; i < radial; ++i) {
        const double s = (i + 0.5) / radial;
        const double r = std::sqrt(1 - s * s) / s;
        for (int j = 0; j < kTurn; ++j) {
            const double phi = 2 * std::numbers::pi * (j + 0.5) / kTurn;
            const Vec3d m =
                normalize(Vec3d(ggx.ax * r * std::cos(phi), ggx.ay * r * std::sin(phi), 1));
            // d(solid angle) = ds dphi 2 s / (D cos 2 pi).
            const double q = (r * r + 1) * m.z * m.z;
            const double d = 1 / (std::numbers::pi * ggx.ax * ggx.ay * q * q);
            sum += static_cast<double>(pdf(Vec3f(m))) * s / (d * m.z * std::numbers::pi);
        }
    }
    return sum * 2 * std::numbers::pi / (static_cast<double>(radial) * kTurn);
}

// Chi-square of sampled normals against the density; `shift` displaces the rings of the histogram,
// `scale` the density.
inline double visible_normals_p(const Ggx& ggx, const Vec3f& wo, std::size_t shift, double scale,
                                uint64_t seed, int draws = 100000) {
    const stats::SphereCells cells(Vec3d(0, 0, 1), std::min(ggx.ax, ggx.ay));
    std::vector<double> observed(cells.size() + 1, 0.0);
    std::vector<double> expected(cells.size() + 1, 0.0);
    stats::Random random(seed);
    for (int i = 0; i < draws; ++i) {
        const std::size_t cell = cells.cell_of(ggx.sample_visible_normal(wo, random.pair()));
        ++observed[std::min(cell + shift * static_cast<std::size_t>(cells.sectors()),
                            cells.size() - 1)];
    }
    // The density jumps at the horizon, where half vectors towards a grazing wo are most likely: a
    // million draws see what six halvings leave of it.
    constexpr int kHalvings = 12;
    double rest = draws;
    for (std::size_t i = 0; i < cells.size(); ++i) {
        expected[i] =
            scale * draws *
            cells.integrate(
                i, [&](const Vec3f& h) { return h.z > 0 ? ggx.pdf_visible_normal(wo, h) : 0.0f; },
                1e-6, kHalvings);
        rest -= expected[i];
    }
    expected.back() = std::max(rest, 0.0);  // nothing, if the density is right
    return stats::chi2_test(observed, expected).p;
}

}  // namespace talbot
