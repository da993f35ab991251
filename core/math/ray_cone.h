// The cone of a path about its ray: how wide a pixel, or the share of directions that one scattered
// direction stands for, is at a distance (Akenine-Moeller et al. 2019, "Texture Level of Detail
// Strategies for Real-Time Ray Tracing", Ray Tracing Gems, chapter 20).
#pragma once

#include <cmath>

#include "core/math/vec.h"

namespace talbot {

// BIAS: a path stands for what one of four samples a pixel covers, half of it by side. A whole
// pixel would blur twice what the samples' own places average already: at 16 samples the floor is
// then twice the noise that it saves.
inline constexpr float kConeShare = 0.5f;

// Sides of squares: `width` is of the area that the cone covers, across its ray, at the ray's
// origin; `spread`, in radians, is of its solid angle.
struct RayCone {
    float width;
    float spread;

    // On to distance t along the ray.
    void advance(float t) { width += spread * t; }

    // Goes on into a direction that was drawn with density pdf: of n samples each stands for a
    // solid angle of 1 / (n pdf), which makes a diffuse bounce wide and a narrow lobe narrow,
    // whatever the material calls its roughness.
    void scatter(float pdf) { spread += kConeShare / std::sqrt(pdf); }

    RayCone narrowed(float share) const { return {share * width, share * spread}; }
};

}  // namespace talbot
