#include "core/scattering/thin_film.h"

#include <numbers>

namespace talbot {
namespace {

// Gaussian fits of the colour matching functions in phase space (Belcour and Barla 2017, table 1):
// height, centre and variance, SI units; x has a second lobe. kSum normalises equal energy.
struct Gaussian {
    double height, centre, variance;
};
constexpr Gaussian kX1{5.4856e-13, 1.6810e+06, 4.3278e+09};
constexpr Gaussian kX2{9.7470e-14, 2.2399e+06, 4.5282e+09};
constexpr Gaussian kY{4.4201e-13, 1.7953e+06, 9.3046e+09};
constexpr Gaussian kZ{5.2481e-13, 2.2084e+06, 6.6121e+09};
constexpr double kSum = 1.0685e-7;
constexpr double kNanometresPerMetre = 1e9;

// Below this thickness, in nanometres, the film's index goes over into that of air.
constexpr float kFadeThickness = 0.03f;

double fringe(const Gaussian& g, double phase, double shift) {
    return g.height * std::sqrt(2 * std::numbers::pi * g.variance) *
           std::cos(g.centre * phase + shift) * std::exp(-g.variance * phase * phase) / kSum;
}

// Linear sRGB of cos(2 pi path / wavelength + shift) over the spectrum; shift by channel.
Rgb sensitivity(double path_nm, const Rgb& shift) {
    const double phase = 2 * std::numbers::pi * path_nm / kNanometresPerMetre;
    const double x = fringe(kX1, phase, shift.x) + fringe(kX2, phase, shift.x);
    const double y = fringe(kY, phase, shift.y);
    const double z = fringe(kZ, phase, shift.z);
    return Rgb(Vec3d(3.2404542 * x - 1.5371385 * y - 0.4985314 * z,
                     -0.9692660 * x + 1.8760108 * y + 0.0415560 * z,
                     0.0556434 * x - 0.2040259 * y + 1.0572252 * z));
}

float reflectance_between(float n1, float n2) {
    const float r = (n2 - n1) / (n2 + n1);
    return r * r;
}

float schlick(float f0, float cos_theta) {
    return f0 + (1 - f0) * schlick_weight(cos_theta);
}

}  // namespace

Rgb film_reflectance(float cos_theta, float ior, float thickness, const Rgb& base_f0) {
    const float fade = clamp01(thickness / kFadeThickness);
    const float film = 1 + (ior - 1) * (fade * fade * (3 - 2 * fade));
    const float sin2_film = (1 - cos_theta * cos_theta) / (film * film);
    if (!(sin2_film < 1)) return Rgb(1);
    const float cos_film = std::sqrt(1 - sin2_film);

    // Outer interface: reflected outside, transmitted in and out again.
    const float r12 = schlick(reflectance_between(1, film), cos_theta);
    const float t121 = 1 - r12;
    const float phase21 = film < 1 ? 0.0f : kPi;

    Rgb r23(0);
    Rgb shift(0);
    for (int c = 0; c < 3; ++c) {
        // The base's index from its reflectance against air, then against the film.
        const float root = std::sqrt(std::clamp(base_f0[c], 0.0f, kLargestFilmBase));
        const float base = (1 + root) / (1 - root);
        r23[c] = schlick(reflectance_between(film, base), cos_film);
        shift[c] = phase21 + (base < film ? kPi : 0.0f);
    }
    const Rgb r123 = glm::min(r12 * r23, Rgb(kLargestFilmBase));
    const Rgb round_trip = (t121 * t121) * r23 / (Rgb(1) - r123);
    Rgb sum = Rgb(r12) + round_trip;
    Rgb amplitude = round_trip - Rgb(t121);
    const double path = 2.0 * film * thickness * cos_film;
    for (int order = 1; order <= 2; ++order) {
        amplitude *= Rgb(std::sqrt(r123.x), std::sqrt(r123.y), std::sqrt(r123.z));
        sum += amplitude * 2.0f * sensitivity(order * path, static_cast<float>(order) * shift);
    }
    return glm::clamp(sum, Rgb(0), Rgb(1));
}

}  // namespace talbot
