// The scale from dark blue over green to yellow in which scalars are shown; the twin of scale_color
// in shaders/display.frag. Display-encoded.
#pragma once

#include "core/math/vec.h"

namespace talbot {

// t in 0..1.
inline Rgb scale_color(float t) {
    const Rgb c0(0.2777273f, 0.0054073f, 0.3340998f);
    const Rgb c1(0.1050930f, 1.4046135f, 1.3845902f);
    const Rgb c2(-0.3308618f, 0.2148476f, 0.0950952f);
    const Rgb c3(-4.6342305f, -5.7991010f, -19.3324410f);
    const Rgb c4(6.2282699f, 14.1799334f, 56.6905526f);
    const Rgb c5(4.7763850f, -13.7451454f, -65.3530326f);
    const Rgb c6(-5.4354559f, 4.6458526f, 26.3124352f);
    const Rgb c = c0 + t * (c1 + t * (c2 + t * (c3 + t * (c4 + t * (c5 + t * c6)))));
    return glm::clamp(c, Rgb(0), Rgb(1));
}

}  // namespace talbot
