// Build-time program: integrates the directional albedos of GGX in double and writes them as
// initialisers. Usage: generate_albedo DIRECTORY.
#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <initializer_list>
#include <iomanip>
#include <iostream>
#include <string>
#include <vector>

#include "core/scattering/albedo_grid.h"
#include "core/scattering/tables/facets.h"

namespace {

using namespace talbot::tables;

// Column from which the limit at grazing is taken.
constexpr double kFirstColumn = 0.02;

// Albedo at Fresnel 1, and what Schlick's weight adds to it: b - e (1 - mu)^5.
struct Entry {
    double e = 1;
    double residual = 0;
};

std::vector<Entry> integrate_reflection(double alpha, const Rule& rule) {
    std::vector<Entry> row(talbot::kReflectionGrid.columns);
    for (int i = 0; i < talbot::kReflectionGrid.columns; ++i) {
        const Facets facets(talbot::kReflectionGrid.column_mu(i, alpha), alpha);
        double e = 0;  // at Fresnel 1
        double b = 0;  // weighted by (1 - cos_d)^5
        facets.for_each(rule, [&](double weight, double cos_d, const Direction& h) {
            const double z_i = 2 * cos_d * h.z - facets.wo.z;
            if (!(z_i > 0)) return;
            const double w = weight * facets.shadowing(z_i);
            e += w;
            b += w * fifth_power(1 - cos_d);
        });
        Entry& node = row[static_cast<std::size_t>(i)];
        node.e = i == 0 ? 1 : e;  // nothing is lost at grazing
        node.residual = b - node.e * fifth_power(1 - facets.wo.z);
    }
    return row;
}

// Means of a, b and a (1 - e) / e over the cosine-weighted hemisphere, of the row as it will be
// interpolated.
std::array<double, 3> mean_of_row(const std::vector<Entry>& row, double alpha) {
    constexpr int kSubsteps = 16;
    std::array<double, 3> mean{};
    for (int i = 0; i + 1 < talbot::kReflectionGrid.columns; ++i) {
        const Entry& p = row[static_cast<std::size_t>(i)];
        const Entry& q = row[static_cast<std::size_t>(i) + 1];
        const auto mu_at = [&](double f) {
            return talbot::kReflectionGrid.column_mu(i + f, alpha);
        };
        for (int k = 0; k < kSubsteps; ++k) {
            const double f = (k + 0.5) / kSubsteps;
            const double low = mu_at(static_cast<double>(k) / kSubsteps);
            const double high = mu_at((k + 1.0) / kSubsteps);
            const double e = p.e + f * (q.e - p.e);
            const double b =
                p.residual + f * (q.residual - p.residual) + e * fifth_power(1 - mu_at(f));
            const double weight = high * high - low * low;
            mean[0] += weight * (e - b);
            mean[1] += weight * b;
            mean[2] += weight * (e - b) * (1 - e) / e;
        }
    }
    return mean;
}

// Albedo of a dielectric interface at every slice: eta is the far side's index over the near
// side's.
void integrate_glass(double mu, double alpha, const Rule& rule, const std::vector<double>& etas,
                     std::vector<double>& albedos) {
    const Facets facets(mu, alpha);
    albedos.assign(etas.size(), 0.0);
    facets.for_each(rule, [&](double weight, double c, const Direction& h) {
        const double z_reflected = 2 * c * h.z - mu;
        const double reflected = z_reflected > 0 ? weight * facets.shadowing(z_reflected) : 0;
        for (std::size_t k = 0; k < etas.size(); ++k) {
            const double n = etas[k];
            const double cos2_t = 1 - (1 - c * c) / (n * n);
            if (!(cos2_t > 0)) {
                albedos[k] += reflected;
                continue;
            }
            const double ct = std::sqrt(cos2_t);
            const double s = (c - n * ct) / (c + n * ct);
            const double p = (n * c - ct) / (n * c + ct);
            const double fresnel = 0.5 * (s * s + p * p);
            const double z_refracted = (ct - c / n) * h.z + mu / n;
            const double transmitted = z_refracted > 0 ? weight * facets.shadowing(z_refracted) : 0;
            albedos[k] += transmitted + fresnel * (reflected - transmitted);
        }
    });
}

// All of the glass table, in its order.
std::vector<double> glass_table() {
    using namespace talbot;
    const Rule rule(48);
    std::vector<double> etas;
    for (int k = 0; k < kGlassSlices; ++k) etas.push_back(glass_slice_ior(k));
    for (int k = 0; k < kGlassSlices; ++k) etas.push_back(1 / glass_slice_ior(k));
    const std::size_t plane = static_cast<std::size_t>(kGlassGrid.rows * kGlassGrid.columns);
    std::vector<double> table(etas.size() * plane);
    std::vector<double> albedos;
    for (int j = 0; j < kGlassGrid.rows; ++j) {
        const double alpha = kGlassGrid.row_alpha(j);
        for (int i = 0; i < kGlassGrid.columns; ++i) {
            // At grazing the limit is taken from close by: 0 / 0 there for a matched index.
            const double mu =
                i == 0 ? kGlassGrid.column_mu(kFirstColumn, alpha) : kGlassGrid.column_mu(i, alpha);
            integrate_glass(mu, alpha, rule, etas, albedos);
            const auto offset = static_cast<std::size_t>(j * kGlassGrid.columns + i);
            for (std::size_t k = 0; k < etas.size(); ++k) table[k * plane + offset] = albedos[k];
        }
    }
    return table;
}

void write_numbers(std::ostream& out, std::initializer_list<double> numbers) {
    for (const double x : numbers) out << std::scientific << std::setprecision(9) << x << "f,";
    out << '\n';
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 2) {
        std::cerr << "usage: generate_albedo DIRECTORY\n";
        return 2;
    }
    const std::string directory = argv[1];
    std::ofstream table(directory + "/albedo_table.inc");
    std::ofstream means(directory + "/mean_albedo_table.inc");
    std::ofstream glass(directory + "/glass_albedo_table.inc");
    const Rule rule(72);
    for (int j = 0; j < talbot::kReflectionGrid.rows; ++j) {
        const double alpha = talbot::kReflectionGrid.row_alpha(j);
        const std::vector<Entry> row = integrate_reflection(alpha, rule);
        for (const Entry& node : row) write_numbers(table, {node.e, node.residual});
        const std::array<double, 3> mean = mean_of_row(row, alpha);
        write_numbers(means, {mean[0], mean[1], mean[2]});
    }
    for (const double albedo : glass_table()) write_numbers(glass, {albedo});
    table.close();
    means.close();
    glass.close();
    return table && means && glass ? 0 : 1;
}
