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
constexpr int kSteps = 80;

struct Albedo {
    double e = 0;  // at Fresnel 1
    double b = 0;  // weighted by (1 - cos_d)^5
};

double slant(double alpha, double sin_theta, double cos_theta) {
    return std::sqrt(alpha * alpha * sin_theta * sin_theta + cos_theta * cos_theta);
}

// Cosines and weights of the azimuths in (0, pi), and nodes u with their weights.
struct Rule {
    std::vector<double> cos_phi, sin_phi, u, weight;

    Rule() {
        double sum = 0;
        for (int k = 0; k < kSteps; ++k) {
            const double v = (k + 0.5) / kSteps;
            cos_phi.push_back(std::cos(kPiD * v));
            sin_phi.push_back(std::sin(kPiD * v));
            u.push_back(0.5 * (1 - std::cos(kPiD * v)));
            weight.push_back(std::sin(kPiD * v));
            sum += weight.back();
        }
        for (double& w : weight) w /= sum * kSteps;
    }
};

Albedo integrate_reflection(double mu, double alpha, const Rule& rule) {
    const double sin_o = std::sqrt(1 - mu * mu);
    const double slant_o = slant(alpha, sin_o, mu);
    const double w_x = alpha * sin_o / slant_o;
    const double w_z = mu / slant_o;
    Albedo sum;
    for (std::size_t i = 0; i < kSteps; ++i) {
        const double t = rule.u[i] * (1 + w_z);
        const double r = std::sqrt(t * (2 - t));
        for (std::size_t j = 0; j < kSteps; ++j) {
            const double x = alpha * (r * rule.cos_phi[j] + w_x);
            const double y = alpha * r * rule.sin_phi[j];
            const double z = (1 - rule.u[i]) * (1 + w_z);
            const double inv = 1 / std::sqrt(x * x + y * y + z * z);
            const double cos_d = (sin_o * x + mu * z) * inv;
            const double z_i = 2 * cos_d * z * inv - mu;
            if (!(z_i > 0)) continue;
            const double slant_i = slant(alpha, std::sqrt(std::max(0.0, 1 - z_i * z_i)), z_i);
            const double w = rule.weight[i] * z_i * (mu + slant_o) / (z_i * slant_o + mu * slant_i);
            const double m = 1 - cos_d;
            sum.e += w;
            sum.b += w * m * m * m * m * m;
        }
    }
    return sum;
}

struct Node {
    double e = 1;
    double residual = 0;
};

double fifth_power(double x) {
    return x * x * x * x * x;
}

std::vector<Node> integrate_row(double alpha, const Rule& rule) {
    std::vector<Node> row(talbot::kAlbedoColumns);
    for (int i = 0; i < talbot::kAlbedoColumns; ++i) {
        const double mu = std::min(1.0, talbot::albedo_column_mu(i, alpha));
        const Albedo albedo = integrate_reflection(mu, alpha, rule);
        Node& node = row[static_cast<std::size_t>(i)];
        node.e = i == 0 ? 1 : albedo.e;  // nothing is lost at grazing
        node.residual = albedo.b - node.e * fifth_power(1 - mu);
    }
    return row;
}

// Means of a, b and a (1 - e) / e over the cosine-weighted hemisphere, of the row as it will be
// interpolated.
std::array<double, 3> mean_of_row(const std::vector<Node>& row, double alpha) {
    constexpr int kSubsteps = 16;
    std::array<double, 3> mean{};
    const double knee = talbot::kAlbedoKnee * alpha;
    const auto mu_at = [knee](double x) {
        return std::min(1.0, x * x * knee / (1 + knee - x * x));
    };
    for (int i = 0; i + 1 < talbot::kAlbedoColumns; ++i) {
        const Node& p = row[static_cast<std::size_t>(i)];
        const Node& q = row[static_cast<std::size_t>(i) + 1];
        for (int k = 0; k < kSubsteps; ++k) {
            const auto x = [i](double f) { return (i + f) / (talbot::kAlbedoColumns - 1); };
            const double f = (k + 0.5) / kSubsteps;
            const double low = mu_at(x(static_cast<double>(k) / kSubsteps));
            const double high = mu_at(x((k + 1.0) / kSubsteps));
            const double e = p.e + f * (q.e - p.e);
            const double b =
                p.residual + f * (q.residual - p.residual) + e * fifth_power(1 - mu_at(x(f)));
            const double weight = high * high - low * low;
            mean[0] += weight * (e - b);
            mean[1] += weight * b;
            mean[2] += weight * (e - b) * (1 - e) / e;
        }
    }
    return mean;
}

void write_numbers(std::ostream& out, std::initializer_list<double> numbers) {
    out << '{';
    for (const double x : numbers) out << std::scientific << std::setprecision(9) << x << "f, ";
    out << "},\n";
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
    const Rule rule;
    for (int j = 0; j < talbot::kAlbedoRows; ++j) {
        const double alpha = talbot::albedo_row_alpha(j);
        const std::vector<Node> row = integrate_row(alpha, rule);
        for (const Node& node : row) write_numbers(table, {node.e, node.residual});
        const std::array<double, 3> mean = mean_of_row(row, alpha);
        write_numbers(means, {mean[0], mean[1], mean[2]});
    }
    table.close();
    means.close();
    return table && means ? 0 : 1;
}
