// Quadrature over the microfacets that a direction sees, for the build-time generators. Integrals
// run over the unit square of visible-normal sampling, where the weight G2 / G1 has no peak at any
// alpha.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace talbot::tables {

inline double fifth_power(double x) {
    return x * x * x * x * x;
}

// Nodes of the unit square: half the turn in equal steps; the other coordinate, with u = (1 - cos
// pi v) / 2, in steps that start elsewhere on each column, so that jumps along curves average out.
struct Rule {
    struct Node {
        double cos_phi, sin_phi, u, weight;
    };
    std::vector<Node> nodes;

    explicit Rule(int n) {
        double sum = 0;
        for (int j = 0; j < n; ++j) {
            const double phi = std::numbers::pi * (j + 0.5) / n;
            const double turns = (j + 0.5) * (std::numbers::phi - 1);
            const double shift = turns - std::floor(turns);
            for (int i = 0; i < n; ++i) {
                const double v = std::numbers::pi * (i + shift) / n;
                nodes.push_back(
                    {std::cos(phi), std::sin(phi), 0.5 * (1 - std::cos(v)), std::sin(v)});
                sum += std::sin(v);
            }
        }
        for (Node& node : nodes) node.weight /= sum;
    }
};

struct Direction {
    double x, y, z;
};

// A view direction and the microfacets it sees.
struct Facets {
    Direction wo;
    double ax, ay, slant_o;

    // Isotropic: wo lies in the xz plane.
    Facets(double mu, double alpha)
        : Facets(Direction{std::sqrt(std::max(0.0, 1 - mu * mu)), 0, mu}, alpha, alpha) {}
    Facets(const Direction& w, double alpha_x, double alpha_y)
        : wo(w), ax(alpha_x), ay(alpha_y), slant_o(slant(w)) {}

    double slant(const Direction& w) const {
        return std::sqrt(ax * ax * w.x * w.x + ay * ay * w.y * w.y + w.z * w.z);
    }

    // visit(weight, cosine of the facet to the view, facet) for each facet; on one side of the xz
    // plane only if wo lies in it.
    template <typename Visit>
    void for_each(const Rule& rule, const Visit& visit) const {
        const Direction w{ax * wo.x / slant_o, ay * wo.y / slant_o, wo.z / slant_o};
        const int sides = wo.y == 0 ? 1 : 2;
        for (const Rule::Node& node : rule.nodes) {
            const double t = node.u * (1 + w.z);
            const double r = std::sqrt(t * (2 - t));
            for (int side = 0; side < sides; ++side) {
                const double sin_phi = side == 0 ? node.sin_phi : -node.sin_phi;
                const double x = ax * (r * node.cos_phi + w.x);
                const double y = ay * (r * sin_phi + w.y);
                const double z = (1 - node.u) * (1 + w.z);
                const double inv = 1 / std::sqrt(x * x + y * y + z * z);
                const Direction h{x * inv, y * inv, z * inv};
                visit(node.weight / sides,
                      std::clamp(wo.x * h.x + wo.y * h.y + wo.z * h.z, 0.0, 1.0), h);
            }
        }
    }

    // G2 / G1 for an outgoing direction by its |z| and slant, on either side.
    double shadowing(double z_i, double slant_i) const {
        return z_i * (wo.z + slant_o) / (z_i * slant_o + wo.z * slant_i);
    }
    // The same for equal alphas, where |z| says all.
    double shadowing(double z_i) const {
        const double sin2 = std::max(0.0, 1 - z_i * z_i);
        return shadowing(z_i, std::sqrt(ax * ax * sin2 + z_i * z_i));
    }
    Direction reflected(double cos_d, const Direction& h) const {
        return {2 * cos_d * h.x - wo.x, 2 * cos_d * h.y - wo.y, 2 * cos_d * h.z - wo.z};
    }
};

}  // namespace talbot::tables
