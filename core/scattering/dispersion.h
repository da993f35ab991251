// Dispersion by one hero wavelength: at the first dispersive surface a path draws a wavelength in
// proportion to what the three channels see of it, takes its colour as a weight, and keeps it.
#pragma once

#include "core/math/vec.h"

namespace talbot {

struct WavelengthSample {
    float nanometres = 0;
    Rgb weight{1};  // mean over u is 1 in each channel
};

// u in [0, 1). Channels see the CIE 1931 curves (fits of Wyman, Sloan and Shirley 2013) in linear
// sRGB, their negative parts cut off.
WavelengthSample sample_wavelength(float u);

// Index at a wavelength by Cauchy's two terms: ior at the d line, dispersion = 20 / Abbe number;
// never below 1 (KHR_materials_dispersion).
float dispersed_ior(float ior, float dispersion, float nanometres);

}  // namespace talbot
