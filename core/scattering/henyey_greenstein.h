// The phase function of Henyey and Greenstein 1941: how a particle turns light. g in (-1, 1) is the
// mean cosine between the directions of travel before and after. Written with a = |g| and t = 1 -
// cos, which loses no digits for any g: the textbook form divides a difference by g and cancels
// near both ends.
#pragma once

#include <cmath>

#include "core/math/frame.h"
#include "core/math/robust.h"
#include "core/math/warp.h"

namespace talbot {

class HenyeyGreenstein {
  public:
    explicit HenyeyGreenstein(float g) : a_(std::abs(g)), backward_(g < 0) {}

    // Density per solid angle of turning unit `d` into unit `wi`, both directions of travel. It is
    // the value, too: a phase function is normalised.
    float pdf(const Vec3f& d, const Vec3f& wi) const {
        const Vec3f between = backward_ ? d + wi : d - wi;
        const float t = 0.5f * dot(between, between);
        const float b = 1 - a_;
        const float s = b * b + 2 * a_ * t;
        return b * (1 + a_) / (4 * kPi * s * std::sqrt(s));
    }

    // A direction of travel after `d`; u in [0, 1)^2.
    Vec3f sample(const Vec3f& d, const Vec2f& u) const {
        const float b = 1 - a_;
        const float divisor = b + 2 * a_ * u.x;
        const float share = b / divisor;
        // Cosine and sine of the turn from 1 - cos.
        const float t = 2 * share * share * (1 - u.x) * (1 + a_ * u.x);
        float sine = 0;
        float cosine = 0;
        sin_cos_turn(u.y, sine, cosine);
        const float r = std::sqrt(t * (2 - t));
        const Frame frame = Frame::from_normal(backward_ ? -d : d);
        return frame.to_world(Vec3f(r * cosine, r * sine, 1 - t));
    }

  private:
    float a_;
    bool backward_;
};

}  // namespace talbot
