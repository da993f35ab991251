// Build-time program: integrates the directional albedos of anisotropic GGX, of GGX under hat
// functions of the cosine, and of sheen in double, and writes them as initialisers. Usage:
// generate_extension_albedo DIRECTORY.
#include <array>
#include <fstream>
#include <iomanip>
#include <iostream>
#include <string>

#include "core/scattering/charlie.h"
#include "core/scattering/extension_grids.h"
#include "core/scattering/tables/facets.h"

namespace {

using namespace talbot;
using tables::Direction;
using tables::Facets;
using tables::Rule;

constexpr int kFilmNodes = 13;

std::ostream& number(std::ostream& out, double x) {
    return out << std::scientific << std::setprecision(9) << x << "f,";
}

// Albedos at Fresnel values (1, 1) and with Schlick's weight: a = e - b.
struct SchlickPair {
    double a = 0;
    double b = 0;
};

SchlickPair ggx_albedo(const Direction& wo, double ax, double ay, const Rule& rule) {
    if (wo.z == 0) return {0, 1};  // nothing is lost at grazing
    const Facets facets(wo, ax, ay);
    SchlickPair sum;
    facets.for_each(rule, [&](double weight, double cos_d, const Direction& h) {
        const Direction wi = facets.reflected(cos_d, h);
        if (!(wi.z > 0)) return;
        const double w = weight * facets.shadowing(wi.z, facets.slant(wi));
        const double b = w * tables::fifth_power(1 - cos_d);
        sum.a += w - b;
        sum.b += b;
    });
    return sum;
}

void write_anisotropic(std::ostream& table, std::ostream& means) {
    using Grid = AnisotropicGrid;
    const Rule rule(40);
    constexpr int kTurns = 12;  // of the mean, beside the nodes
    for (int row = 0; row < Grid::kRows; ++row) {
        for (int k = 0; k < Grid::kStrengths; ++k) {
            const double ay = Grid::kRowGrid.row_alpha(row);
            const double ax =
                anisotropic_alpha(ay, static_cast<double>(k) / (Grid::kStrengths - 1));
            // Less the round distribution's.
            const auto entry_at = [&](double azimuth, int column, double round) {
                const double mu = Grid::column_mu(column);
                const double s = std::sqrt(1 - mu * mu);
                const SchlickPair p =
                    ggx_albedo({s * std::cos(azimuth), s * std::sin(azimuth), mu}, ax, ay, rule);
                const SchlickPair q = ggx_albedo({s, 0, mu}, round, round, rule);
                return SchlickPair{p.a - q.a, p.b - q.b};
            };
            for (int turn = 0; turn < Grid::kAzimuths; ++turn) {
                const double cosine = static_cast<double>(turn) / (Grid::kAzimuths - 1);
                for (int column = 0; column < Grid::kColumns; ++column) {
                    const SchlickPair e =
                        entry_at(std::acos(cosine), column, alpha_at_azimuth(ax, ay, cosine));
                    number(number(table, e.a), e.b) << '\n';
                }
            }
            for (int column = 0; column < Grid::kColumns; ++column) {
                SchlickPair mean;
                for (int turn = 0; turn < kTurns; ++turn) {
                    const SchlickPair e = entry_at(std::numbers::pi * (turn + 0.5) / (2 * kTurns),
                                                   column, alpha_around(ax, ay));
                    mean.a += e.a / kTurns;
                    mean.b += e.b / kTurns;
                }
                number(number(means, mean.a), mean.b) << '\n';
            }
        }
    }
}

void write_film(std::ostream& out) {
    const Rule rule(56);
    for (int row = 0; row < kFilmGrid.rows; ++row) {
        const double alpha = kFilmGrid.row_alpha(row);
        for (int column = 0; column < kFilmGrid.columns; ++column) {
            const Facets facets(kFilmGrid.column_mu(column, alpha), alpha);
            std::array<double, kFilmNodes> hats{};
            facets.for_each(rule, [&](double weight, double cos_d, const Direction& h) {
                const double z = 2 * cos_d * h.z - facets.wo.z;
                if (!(z > 0)) return;
                const double w = weight * facets.shadowing(z);
                const double x = cos_d * (kFilmNodes - 1);
                const int i = std::min(static_cast<int>(x), kFilmNodes - 2);
                hats[static_cast<std::size_t>(i)] += w * (1 - (x - i));
                hats[static_cast<std::size_t>(i) + 1] += w * (x - i);
            });
            if (column == 0) {
                hats.fill(0);
                hats[0] = 1;  // grazing light is reflected at cosine 0, and nothing is lost
            }
            for (const double x : hats) number(out, x);
            out << '\n';
        }
    }
}

// By quadrature over wi, finer towards grazing, where the distribution has its peak.
double sheen_albedo(double mu, double alpha) {
    constexpr int kZ = 160;
    constexpr int kPhi = 160;
    mu = std::max(mu, 1.0 / 4096);
    const CharlieShadowing<double> shadowing(alpha);
    const double lambda_o = shadowing.lambda(mu);
    const double sin_o = std::sqrt(1 - mu * mu);
    double sum = 0;
    for (int i = 0; i < kZ; ++i) {
        const double s = (i + 0.5) / kZ;
        const double z = s * s;
        const double sin_i = std::sqrt(1 - z * z);
        const double g = 1 / (1 + lambda_o + shadowing.lambda(z));
        double around = 0;
        for (int j = 0; j < kPhi; ++j) {
            // Finer towards the forward direction.
            const double t = (j + 0.5) / kPhi;
            const double phi = std::numbers::pi * t * t;
            const double x = sin_o + sin_i * std::cos(phi);
            const double y = sin_i * std::sin(phi);
            const double side2 = x * x + y * y;
            const double h2 = side2 + (mu + z) * (mu + z);
            around += charlie_d(side2 / h2, alpha) * 2 * std::numbers::pi * 2 * t / kPhi;
        }
        sum += around * g / (4 * mu) * 2 * s / kZ;
    }
    return sum;
}

void write_sheen(std::ostream& out) {
    for (int row = 0; row < SheenGrid::kRows; ++row) {
        for (int column = 0; column < SheenGrid::kColumns; ++column) {
            number(out, sheen_albedo(SheenGrid::column_mu(column), SheenGrid::row_alpha(row)))
                << '\n';
        }
    }
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 2) {
        std::cerr << "usage: generate_extension_albedo DIRECTORY\n";
        return 2;
    }
    const std::string directory = argv[1];
    std::ofstream anisotropic(directory + "/anisotropic_table.inc");
    std::ofstream means(directory + "/anisotropic_mean_table.inc");
    std::ofstream film(directory + "/film_table.inc");
    std::ofstream sheen(directory + "/sheen_table.inc");
    write_anisotropic(anisotropic, means);
    write_film(film);
    write_sheen(sheen);
    for (std::ofstream* file : {&anisotropic, &means, &film, &sheen}) {
        file->close();
        if (!*file) return 1;
    }
    return 0;
}
