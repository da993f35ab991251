// A homogeneous medium inside a closed volume: light is absorbed, and scattered where the material
// says so (KHR_materials_volume, KHR_materials_volume_scatter). Coefficients are per metre.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/math/robust.h"
#include "core/scene/material.h"

namespace talbot {

struct Medium {
    Rgb sigma_t{0};
    Rgb albedo{0};  // share of sigma_t that scatters
    float g = 0;

    bool scatters() const { return !is_black(albedo); }
};

// Attenuation per metre that gives white light the material's attenuation colour after its
// attenuation distance; infinite where the colour is 0.
inline Rgb attenuation(const Material& material) {
    Rgb sigma(0);
    if (!is_finite(material.attenuation_distance) || !(material.attenuation_distance > 0))
        return sigma;
    for (int c = 0; c < 3; ++c) {
        const float color = clamp01(material.attenuation_color[c]);
        sigma[c] = color > 0 ? -std::log(color) / material.attenuation_distance : kInfinity;
    }
    return sigma;
}

// Share of an interaction that scatters, so that a thick body returns the material's multi-scatter
// colour (van de Hulst 1980 in the form of OpenPBR 1.1, section "Subsurface").
inline Rgb single_scatter_albedo(const Material& material) {
    Rgb albedo(0);
    for (int c = 0; c < 3; ++c) {
        const double m = clamp01(material.multiscatter_color[c]);
        if (!(m > 0)) continue;
        const double s = 4.09712 + 4.20863 * m - std::sqrt(9.59217 + 41.6808 * m + 17.7126 * m * m);
        const double g = material.scatter_anisotropy;
        albedo[c] = clamp01(static_cast<float>((1 - s * s) / (1 - g * s * s)));
    }
    return albedo;
}

// The densest medium whose free paths are drawn: exp(-32) and darker attenuation colours are alike.
inline constexpr float kDensestScattering = 32;

inline Medium medium_of(const Material& material) {
    Medium m;
    m.sigma_t = attenuation(material);
    if (!material.scatters()) return m;
    m.albedo = single_scatter_albedo(material);
    m.g = material.scatter_anisotropy;
    for (int c = 0; c < 3; ++c)
        m.sigma_t[c] = std::min(m.sigma_t[c], kDensestScattering / material.attenuation_distance);
    return m;
}

// Beer-Lambert transmittance over a distance >= 0, which may be infinite; a channel that nothing
// attenuates keeps 1 exactly. What rounding took from the optical depth is put back, else it would
// cost that many roundings.
inline Rgb transmittance(const Rgb& sigma, float distance) {
    constexpr double kOpaque = 128;  // what passes is less than any float
    Rgb t(1);
    for (int c = 0; c < 3; ++c) {
        if (!(sigma[c] > 0) || !(distance > 0)) continue;
        const double depth = static_cast<double>(sigma[c]) * distance;
        const auto rounded = static_cast<float>(depth);
        t[c] =
            depth < kOpaque ? std::exp(-rounded) * (1 - static_cast<float>(depth - rounded)) : 0.0f;
    }
    return t;
}

struct MediumSample {
    bool scattered = false;  // else the path reaches t_max
    float t = 0;
    Rgb weight{1};  // of beta: value over density
};

// Where a path of throughput beta next scatters before t_max. One channel, drawn in proportion to
// beta, gives the free path; the densities of all channels are combined (Wilkie et al. 2014,
// balance heuristic). u in [0, 1)^2: free path and channel.
inline MediumSample sample_medium(const Medium& medium, const Rgb& beta, float t_max,
                                  const Vec2f& u) {
    MediumSample result;
    const float sum = beta.x + beta.y + beta.z;
    if (!(sum > 0)) return result;
    const Rgb p = beta / sum;
    const int channel = u.y < p.x ? 0 : (u.y < p.x + p.y || !(p.z > 0) ? 1 : 2);
    const float sigma = medium.sigma_t[channel];
    const float t = sigma > 0 ? -std::log1p(-u.x) / sigma : kInfinity;
    result.scattered = t < t_max;
    result.t = result.scattered ? t : t_max;
    const Rgb tr = transmittance(medium.sigma_t, result.t);
    const Rgb density = result.scattered ? medium.sigma_t * tr : tr;
    const float pdf = dot(p, density);
    if (!(pdf > 0)) {
        result.weight = Rgb(0);
        return result;
    }
    result.weight = (result.scattered ? medium.albedo * density : density) / pdf;
    return result;
}

}  // namespace talbot
