// What a path carries from vertex to vertex.
#pragma once

#include "core/integrate/medium_stack.h"
#include "core/math/ray_cone.h"
#include "core/math/vec.h"
#include "core/scattering/medium.h"

namespace talbot {

// What fills the space inside these volumes.
inline Medium medium_inside(const MediumStack& media, std::span<const Material> materials) {
    const uint32_t top = media.top(materials);
    return top == kVacuum ? Medium{} : medium_of(materials[top]);
}

// State of one path between two vertices.
struct PathState {
    Rgb beta{1};
    Rgb Li{0};
    float eta_scale = 1;  // undoes the radiance scaling of refraction for the roulette
    float bsdf_pdf = 0;   // density of the last scattering direction
    bool specular =
        true;  // the last event was the camera or a delta lobe: no other strategy finds its light
    bool specular_chain = true;     // nothing but delta events since the camera
    Vec3f from{0};                  // the last vertex
    Vec3f n_from{0};                // its normal as light sampling was given it
    PrimitiveId from_id{};          // and its surface, whose light sampling never counts
    float wavelength = 0;           // nanometres; 0 until a dispersive surface is met
    MediumStack media;              // volumes that the ray is inside of
    Medium medium;                  // of the one that fills the space
    bool in_medium = false;         // it takes away light
    uint32_t false_boundaries = 0;  // crossed ones that were no surfaces
    uint32_t medium_events = 0;     // times that the path scattered inside media
    RayCone cone;                   // at the ray's origin; in kernels with ray cones alone, the
                                    // others do not even clear it

    // Goes on inside other volumes than before.
    void enter(const MediumStack& now, std::span<const Material> materials) {
        media = now;
        medium = medium_inside(now, materials);
        in_medium = medium.scatters() || !is_black(medium.sigma_t);
    }
};

// Light leaves a thick body that absorbs nothing after n events about as n^-1.5: after the first of
// these many a path survives to event n with a chance as n^-0.5, which keeps both the time and the
// variance small; after the second it soon ends, so that none goes on for ever. What walks longer
// than that carry is found too seldom to be seen: 1 % of the light of a white glass body a thousand
// mean free paths thick (g 0.8).
inline constexpr uint32_t kLongWalk = 256;
inline constexpr uint32_t kEndlessWalk = 1u << 18;

}  // namespace talbot
