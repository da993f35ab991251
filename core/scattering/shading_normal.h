// Shading normals that disagree with the surface: bending until the mirror direction leaves the
// surface, and the fold that puts a direction on the side of the geometric surface where it
// belongs.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/math/robust.h"
#include "core/math/vec.h"

namespace talbot {

// Cosine to the geometric normal that a mirror direction keeps when its shading normal has to be
// bent.
inline constexpr float kMinMirrorCosine = 0.01f;

// n_shading, turned towards n_geometric by the least angle that brings the mirror direction of wo
// to a cosine of at least min(kMinMirrorCosine, dot(wo, n_geometric)) with n_geometric; returned
// unchanged where it already holds. wo must not be below the geometric surface. The result also has
// wo on its positive side.
//
// Derivation: in the plane of both normals let n_geometric be z and theta the tilt of the normal.
// With (o_x, o_z) the part of wo in that plane, of length rho and at angle phi from z, the mirror
// direction's cosine is rho cos(2 theta - phi). It reaches the bound tau at 2 theta = phi +
// acos(tau / rho), so that twice the largest tilt has a sine and cosine without trigonometry.
inline Vec3f bend_shading_normal(const Vec3f& n_shading, const Vec3f& n_geometric,
                                 const Vec3f& wo) {
    const float o_z = std::max(dot(wo, n_geometric), 0.0f);
    const float tau = std::min(kMinMirrorCosine, o_z);
    const float n_z = dot(n_shading, n_geometric);
    const float mirror_z = 2 * dot(n_shading, wo) * n_z - o_z;
    if (n_z > 0 && mirror_z >= tau) return n_shading;

    const Vec3f x = safe_normalize(n_shading - n_z * n_geometric, Vec3f(0));
    const float o_x = dot(wo, x);
    // In double: the half-angle formulas lose half of the digits where the tilt is small.
    const double rho2 = static_cast<double>(o_x) * o_x + static_cast<double>(o_z) * o_z;
    if (!(rho2 > 0)) return n_geometric;
    const double side = std::sqrt(std::max(rho2 - static_cast<double>(tau) * tau, 0.0));
    // Cosine of phi + acos(tau / rho); the half-angle formulas give the tilt.
    const double cos_twice = std::clamp((o_z * double{tau} - o_x * side) / rho2, -1.0, 1.0);
    const auto sin_tilt = static_cast<float>(std::sqrt(0.5 * (1 - cos_twice)));
    const auto cos_tilt = static_cast<float>(std::sqrt(0.5 * (1 + cos_twice)));
    return safe_normalize(sin_tilt * x + cos_tilt * n_geometric, n_geometric);
}

// w mirrored at the geometric surface.
inline Vec3f fold_at_surface(const Vec3f& w, const Vec3f& n_geometric) {
    return w - 2 * dot(w, n_geometric) * n_geometric;
}

}  // namespace talbot
