// A partition of the sphere for chi-square tests and quadrature: polar cells about an axis, their
// polar edges log-spaced so that lobes of any width fill many cells. Integrals adapt inside each
// cell.
#pragma once

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/math/robust.h"
#include "core/math/vec.h"

namespace talbot::stats {

class SphereCells {
  public:
    // Rings about the unit axis: the innermost up to `width` / 16 radians, the others growing in
    // proportion up to pi. A width of 0 means that nothing crowds round the axis.
    SphereCells(const Vec3d& axis, double width, int rings = 20, int sectors = 12)
        : axis_(axis), sectors_(sectors) {
        const double first = (width > 0 ? std::min(width, 1.0) : 1.0) / 16;
        edges_.push_back(0);
        for (int k = 0; k < rings; ++k) {
            edges_.push_back(
                first * std::pow(std::numbers::pi / first, static_cast<double>(k) / (rings - 1)));
        }
        edges_.back() = std::numbers::pi;
        const double sign = std::copysign(1.0, axis.z);
        const double a = -1 / (sign + axis.z);
        const double c = axis.x * axis.y * a;
        t_ = Vec3d(1 + sign * axis.x * axis.x * a, sign * c, -sign * axis.x);
        b_ = Vec3d(c, sign + axis.y * axis.y * a, -axis.y);
    }

    std::size_t size() const { return (edges_.size() - 1) * static_cast<std::size_t>(sectors_); }
    int sectors() const { return sectors_; }

    std::size_t cell_of(const Vec3f& direction) const {
        const Vec3d w(direction);
        const double x = dot(w, t_);
        const double y = dot(w, b_);
        const double theta = std::atan2(std::sqrt(x * x + y * y), dot(w, axis_));
        std::size_t ring = 0;
        while (ring + 2 < edges_.size() && theta >= edges_[ring + 1]) ++ring;
        const double turn = (std::atan2(y, x) / std::numbers::pi + 1) * 0.5;
        const int sector = std::min(static_cast<int>(turn * sectors_), sectors_ - 1);
        return ring * static_cast<std::size_t>(sectors_) + static_cast<std::size_t>(sector);
    }

    // Integral of f(direction) over one cell, to about `tolerance` wherever f has no more than
    // jumps along curves. Cells that the plane z = 0 cuts are refined in any case: a sliver on one
    // side of it could lie between all nodes. A jump is followed through max_depth halvings.
    template <typename F>
    double integrate(std::size_t cell, const F& f, double tolerance, int max_depth = 6) const {
        const std::size_t ring = cell / static_cast<std::size_t>(sectors_);
        const auto sector = static_cast<double>(cell % static_cast<std::size_t>(sectors_));
        const double step = 2 * std::numbers::pi / sectors_;
        const Patch patch{edges_[ring], edges_[ring + 1], -std::numbers::pi + sector * step,
                          -std::numbers::pi + (sector + 1) * step};
        return refine(patch, gauss(patch, f), f, tolerance, crosses_horizon(patch) ? 3 : 0, 0,
                      max_depth);
    }

    // Integral over the whole sphere. mirrored: f has the same values on both sides of the xz
    // plane, and the axis lies in it.
    template <typename F>
    double integrate(const F& f, double tolerance, bool mirrored = false) const {
        double sum = 0;
        for (std::size_t i = 0; i < size(); ++i) {
            const bool twin =
                static_cast<int>(i % static_cast<std::size_t>(sectors_)) >= sectors_ / 2;
            if (!mirrored || !twin) sum += integrate(i, f, tolerance);
        }
        return mirrored ? 2 * sum : sum;
    }

  private:
    struct Patch {
        double theta0, theta1, phi0, phi1;
    };

    Vec3d direction(double theta, double phi) const {
        return std::sin(theta) * (std::cos(phi) * t_ + std::sin(phi) * b_) +
               std::cos(theta) * axis_;
    }

    bool crosses_horizon(const Patch& p) const {
        constexpr int kSteps = 8;
        bool above = false;
        bool below = false;
        for (int i = 0; i <= kSteps; ++i) {
            const double s = static_cast<double>(i) / kSteps;
            const double theta = p.theta0 + s * (p.theta1 - p.theta0);
            const double phi = p.phi0 + s * (p.phi1 - p.phi0);
            for (const double z : {direction(theta, p.phi0).z, direction(theta, p.phi1).z,
                                   direction(p.theta0, phi).z, direction(p.theta1, phi).z}) {
                (z < 0 ? below : above) = true;
            }
        }
        return above && below;
    }

    template <typename F>
    double gauss(const Patch& p, const F& f) const {
        constexpr std::array<double, 4> kNode{-0.8611363115940526, -0.3399810435848563,
                                              0.3399810435848563, 0.8611363115940526};
        constexpr std::array<double, 4> kWeight{0.3478548451374538, 0.6521451548625461,
                                                0.6521451548625461, 0.3478548451374538};
        const double half_theta = 0.5 * (p.theta1 - p.theta0);
        const double half_phi = 0.5 * (p.phi1 - p.phi0);
        double sum = 0;
        for (std::size_t i = 0; i < 4; ++i) {
            const double theta = p.theta0 + half_theta * (1 + kNode[i]);
            const double s = std::sin(theta);
            const double c = std::cos(theta);
            for (std::size_t j = 0; j < 4; ++j) {
                const double phi = p.phi0 + half_phi * (1 + kNode[j]);
                const Vec3d w = s * (std::cos(phi) * t_ + std::sin(phi) * b_) + c * axis_;
                sum += kWeight[i] * kWeight[j] * s * static_cast<double>(f(Vec3f(w)));
            }
        }
        return sum * half_theta * half_phi;
    }

    template <typename F>
    double refine(const Patch& p, double coarse, const F& f, double tolerance, int least, int depth,
                  int max_depth) const {
        const double theta = 0.5 * (p.theta0 + p.theta1);
        const double phi = 0.5 * (p.phi0 + p.phi1);
        const std::array<Patch, 4> parts{
            Patch{p.theta0, theta, p.phi0, phi}, Patch{p.theta0, theta, phi, p.phi1},
            Patch{theta, p.theta1, p.phi0, phi}, Patch{theta, p.theta1, phi, p.phi1}};
        std::array<double, 4> fine{};
        double sum = 0;
        for (std::size_t k = 0; k < 4; ++k) sum += fine[k] = gauss(parts[k], f);
        if (depth >= max_depth || (depth >= least && std::abs(sum - coarse) <= tolerance))
            return sum;
        double refined = 0;
        for (std::size_t k = 0; k < 4; ++k)
            refined += refine(parts[k], fine[k], f, 0.5 * tolerance, least, depth + 1, max_depth);
        return refined;
    }

    Vec3d axis_;
    Vec3d t_{1, 0, 0};
    Vec3d b_{0, 1, 0};
    int sectors_;
    std::vector<double> edges_;
};

}  // namespace talbot::stats
