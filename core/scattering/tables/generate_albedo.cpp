// Build-time program: integrates the directional albedos of GGX in double and writes them as
// initialisers. Usage: generate_albedo DIRECTORY. Integrals run over the unit square of
// visible-normal sampling, where the weight G2 / G1 has no peak at any alpha: midpoint rule in the
// azimuth (periodic) and in v with u = (1 - cos pi v) / 2.
#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <initializer_list>
#include <iomanip>
#include <iostream>
#include <numbers>
#include <string>
#include <vector>

#include "core/scattering/albedo_grid.h"

namespace {

constexpr double kPiD = std::numbers::pi;
// Column from which the limit at grazing is taken.
constexpr double kFirstColumn = 0.02;

double slant(double alpha, double sin_theta, double cos_theta) {
    return std::sqrt(alpha * alpha * sin_theta * sin_theta + cos_theta * cos_theta);
}

double fifth_power(double x) {
    return x * x * x * x * x;
}

// Nodes of the unit square of visible-normal sampling: half the turn, by symmetry, in equal steps;
// the other coordinate in steps that start elsewhere on each column, so that jumps along curves
// average out.
struct Rule {
    struct Node {
        double cos_phi, sin_phi, u, weight;
    };
    std::vector<Node> nodes;

    explicit Rule(int n) {
        double sum = 0;
        for (int j = 0; j < n; ++j) {
            const double phi = kPiD * (j + 0.5) / n;
            const double turns = (j + 0.5) * (std::numbers::phi - 1);
            const double shift = turns - std::floor(turns);
            for (int i = 0; i < n; ++i) {
                const double v = kPiD * (i + shift) / n;
                nodes.push_back(
                    {std::cos(phi), std::sin(phi), 0.5 * (1 - std::cos(v)), std::sin(v)});
                sum += std::sin(v);
            }
        }
        for (Node& node : nodes) node.weight /= sum;
    }
};

// A view direction and the microfacets it sees.
struct Facets {
    double mu, alpha, slant_o;

    Facets(double cos_theta, double a)
        : mu(cos_theta), alpha(a), slant_o(slant(a, std::sqrt(1 - mu * mu), mu)) {}

    // visit(weight, cosine of the facet to the view, z of the facet) for each facet.
    template <typename Visit>
    void for_each(const Rule& rule, const Visit& visit) const {
        const double sin_o = std::sqrt(1 - mu * mu);
        const double w_x = alpha * sin_o / slant_o;
        const double w_z = mu / slant_o;
        for (const Rule::Node& node : rule.nodes) {
            const double t = node.u * (1 + w_z);
            const double r = std::sqrt(t * (2 - t));
            const double x = alpha * (r * node.cos_phi + w_x);
            const double y = alpha * r * node.sin_phi;
            const double z = (1 - node.u) * (1 + w_z);
            const double inv = 1 / std::sqrt(x * x + y * y + z * z);
            visit(node.weight, std::min((sin_o * x + mu * z) * inv, 1.0), z * inv);
        }
    }

    // G2 / G1 for an outgoing direction with cosine z_i > 0 on either side.
    double shadowing(double z_i) const {
        const double slant_i = slant(alpha, std::sqrt(std::max(0.0, 1 - z_i * z_i)), z_i);
        return z_i * (mu + slant_o) / (z_i * slant_o + mu * slant_i);
    }
};

struct Node {
    double e = 1;
    double residual = 0;
};

std::vector<Node> integrate_reflection(double alpha, const Rule& rule) {
    std::vector<Node> row(talbot::kReflectionGrid.columns);
    for (int i = 0; i < talbot::kReflectionGrid.columns; ++i) {
        const Facets facets(talbot::kReflectionGrid.column_mu(i, alpha), alpha);
        double e = 0;  // at Fresnel 1
        double b = 0;  // weighted by (1 - cos_d)^5
        facets.for_each(rule, [&](double weight, double cos_d, double h_z) {
            const double z_i = 2 * cos_d * h_z - facets.mu;
            if (!(z_i > 0)) return;
            const double w = weight * facets.shadowing(z_i);
            e += w;
            b += w * fifth_power(1 - cos_d);
        });
        Node& node = row[static_cast<std::size_t>(i)];
        node.e = i == 0 ? 1 : e;  // nothing is lost at grazing
        node.residual = b - node.e * fifth_power(1 - facets.mu);
    }
    return row;
}

// Means of a, b and a (1 - e) / e over the cosine-weighted hemisphere, of the row as it will be
// interpolated.
std::array<double, 3> mean_of_row(const std::vector<Node>& row, double alpha) {
    constexpr int kSubsteps = 16;
    std::array<double, 3> mean{};
    for (int i = 0; i + 1 < talbot::kReflectionGrid.columns; ++i) {
        const Node& p = row[static_cast<std::size_t>(i)];
        const Node& q = row[static_cast<std::size_t>(i) + 1];
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
    facets.for_each(rule, [&](double weight, double c, double h_z) {
        const double z_reflected = 2 * c * h_z - mu;
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
            const double z_refracted = (ct - c / n) * h_z + mu / n;
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
        const std::vector<Node> row = integrate_reflection(alpha, rule);
        for (const Node& node : row) write_numbers(table, {node.e, node.residual});
        const std::array<double, 3> mean = mean_of_row(row, alpha);
        write_numbers(means, {mean[0], mean[1], mean[2]});
    }
    for (const double albedo : glass_table()) write_numbers(glass, {albedo});
    table.close();
    means.close();
    glass.close();
    return table && means && glass ? 0 : 1;
}
