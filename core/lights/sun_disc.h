// A directional light seen as a disc of uniform radiance. Directions are unit vectors.
#pragma once

#include "core/math/vec.h"
#include "core/scene/punctual_light.h"

namespace talbot {

struct SunDisc {
    Vec3f to{0, 1, 0};         // the middle
    double one_minus_cos = 0;  // of the angular radius
    Rgb radiance{0};
    float pdf = 0;  // of light sampling, with the choice of the light

    // Whether the disc is seen along d.
    bool holds(const Vec3f& d) const {
        const Vec3d off(Vec3d(d) - Vec3d(to));
        return 0.5 * dot(off, off) <= one_minus_cos;
    }
};

// The disc that gives a surface facing it the light's illuminance, E = pi L sin^2; without `pdf`.
SunDisc make_sun_disc(const PunctualLight& light);

// Density of sample_sun_disc, uniform over the disc's solid angle.
float pdf_sun_disc(const SunDisc& sun);
Vec3f sample_sun_disc(const SunDisc& sun, const Vec2f& u);

}  // namespace talbot
