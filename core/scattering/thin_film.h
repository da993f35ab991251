// Reflectance of a thin film on a surface, in linear sRGB (KHR_materials_iridescence). An Airy
// series of two orders whose spectral integrals are those of Gaussian fits to the CIE 1931 curves
// (Belcour and Barla 2017, sections 4 and supplemental), with Schlick's Fresnel at both interfaces
// as the extension asks. The layer works on values at fixed cosines, interpolated linearly, so that
// albedos by table are those of the values that it evaluates.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "core/scattering/fresnel.h"

namespace talbot {

// ior of the film and its thickness in nanometres; base_f0 the reflectance below it at normal
// incidence, seen from outside without the film. cos_theta in [0, 1], outside index 1. Result in
// [0, 1] per channel.
Rgb film_reflectance(float cos_theta, float ior, float thickness, const Rgb& base_f0);

inline constexpr int kFilmNodes = 13;  // at cosines 0, 1/12, ... 1

// A reflectance by cosine, piecewise linear between the nodes.
struct FilmNodes {
    std::array<Rgb, kFilmNodes> f;  // set by whoever uses them: a dozen vectors to clear cost time

    static float cosine(int node) { return static_cast<float>(node) / (kFilmNodes - 1); }

    Rgb at(float cos_theta) const {
        const float x = cos_theta * (kFilmNodes - 1);
        const int i = std::clamp(static_cast<int>(x), 0, kFilmNodes - 2);
        const float s = x - static_cast<float>(i);
        const auto k = static_cast<std::size_t>(i);
        return f[k] + s * (f[k + 1] - f[k]);
    }
};

}  // namespace talbot
