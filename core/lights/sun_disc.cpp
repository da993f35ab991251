#include "core/lights/sun_disc.h"

#include <cmath>
#include <numbers>

#include "core/math/frame.h"
#include "core/math/robust.h"

namespace talbot {

SunDisc make_sun_disc(const PunctualLight& light) {
    SunDisc sun;
    sun.to = -light.direction;
    const double half_sine = std::sin(0.25 * static_cast<double>(light.angular_diameter));
    const double t = 2 * half_sine * half_sine;
    sun.one_minus_cos = t;
    const double sin2 = t * (2 - t);
    sun.radiance = light.color * static_cast<float>(static_cast<double>(light.intensity) /
                                                    (std::numbers::pi * sin2));
    return sun;
}

float pdf_sun_disc(const SunDisc& sun) {
    return static_cast<float>(1 / (2 * std::numbers::pi * sun.one_minus_cos));
}

Vec3f sample_sun_disc(const SunDisc& sun, const Vec2f& u) {
    const double t = sun.one_minus_cos * static_cast<double>(u.x);
    const double sine = std::sqrt(t * (2 - t));
    const double phi = 2 * std::numbers::pi * static_cast<double>(u.y);
    const Frame frame = Frame::from_normal(sun.to);
    return Vec3f(normalize(sine * std::cos(phi) * Vec3d(frame.t) +
                           sine * std::sin(phi) * Vec3d(frame.b) + (1 - t) * Vec3d(sun.to)));
}

}  // namespace talbot
