#include "core/scattering/dispersion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/math/distribution.h"

namespace talbot {
namespace {

constexpr double kFirst = 380;  // nanometres
constexpr double kLast = 720;
constexpr std::size_t kCells = 256;

// Fraunhofer lines in nanometres: F and C span the dispersion, d is where ior is given.
constexpr double kLineF = 486.1327;
constexpr double kLineD = 587.5618;
constexpr double kLineC = 656.2725;

// A Gaussian with a width for each side.
double lobe(double x, double height, double centre, double below, double above) {
    const double t = (x - centre) / (x < centre ? below : above);
    return height * std::exp(-0.5 * t * t);
}

Vec3d cie_xyz(double w) {
    return Vec3d(lobe(w, 1.056, 599.8, 37.9, 31.0) + lobe(w, 0.362, 442.0, 16.0, 26.7) +
                     lobe(w, -0.065, 501.1, 20.4, 26.2),
                 lobe(w, 0.821, 568.8, 46.9, 40.5) + lobe(w, 0.286, 530.9, 16.3, 31.1),
                 lobe(w, 1.217, 437.0, 11.8, 36.0) + lobe(w, 0.681, 459.0, 26.0, 13.8));
}

Vec3d seen_by_channels(double w) {
    const Vec3d c = cie_xyz(w);
    return Vec3d(std::max(3.2404542 * c.x - 1.5371385 * c.y - 0.4985314 * c.z, 0.0),
                 std::max(-0.9692660 * c.x + 1.8760108 * c.y + 0.0415560 * c.z, 0.0),
                 std::max(0.0556434 * c.x - 0.2040259 * c.y + 1.0572252 * c.z, 0.0));
}

struct Spectrum {
    DiscreteDistribution cells;
    std::array<Rgb, kCells> weight{};

    Spectrum() {
        std::array<Vec3d, kCells> seen{};
        Vec3d sum(0);
        for (std::size_t i = 0; i < kCells; ++i) {
            seen[i] = seen_by_channels(kFirst +
                                       (kLast - kFirst) * (static_cast<double>(i) + 0.5) / kCells);
            sum += seen[i];
        }
        std::vector<double> mean(kCells);
        for (std::size_t i = 0; i < kCells; ++i) {
            seen[i] /= sum;
            mean[i] = (seen[i].x + seen[i].y + seen[i].z) / 3;
            if (mean[i] > 0) weight[i] = Rgb(seen[i] / mean[i]);
        }
        cells = DiscreteDistribution(mean);
    }
};

}  // namespace

WavelengthSample sample_wavelength(float u) {
    static const Spectrum spectrum;
    const DiscreteDistribution::Pick pick = spectrum.cells.sample(u);
    const double at = (pick.index + static_cast<double>(pick.u)) / kCells;
    return {static_cast<float>(kFirst + (kLast - kFirst) * at), spectrum.weight[pick.index]};
}

float dispersed_ior(float ior, float dispersion, float nanometres) {
    constexpr double kSpan = 1 / (kLineF * kLineF) - 1 / (kLineC * kLineC);
    const double w = nanometres;
    const double bend = (1 / (w * w) - 1 / (kLineD * kLineD)) / kSpan;
    const double n = ior + (ior - 1.0) * dispersion / 20.0 * bend;
    return static_cast<float>(std::max(n, 1.0));
}

}  // namespace talbot
