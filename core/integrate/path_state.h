// State of one path, what a sample of it gives, and the hooks of those who watch.
#pragma once

#include "core/integrate/medium_stack.h"
#include "core/integrate/tiers.h"
#include "core/math/ray_cone.h"
#include "core/scattering/medium.h"

namespace talbot {

struct PathSample {
    Rgb Li{0};
    bool covered = false;  // the camera path met a surface
    uint32_t rays = 0;
};

// Steps that a replay writes down; a kernel's recorder does nothing and costs nothing. One that
// tampers changes values on their way, to prove that what is wrong with a sample is noticed.
struct NoRecorder {
    static constexpr bool kActive = false;
    static constexpr bool kTampers = false;
};

// Values of a path that a tampering recorder is shown.
enum class PathValue : uint8_t {
    environment,
    environment_pdf,
    emission,
    emission_pdf,
    transmittance,
    base_color,
    light,
    light_pdf,
    bsdf_value,
    bsdf_pdf,
    bsdf_weight,
    bsdf_sample_pdf,
};

template <typename Recorder, typename T>
void show_value(Recorder& recorder, PathValue what, T& value) {
    if constexpr (Recorder::kTampers) recorder.tamper(what, value);
}

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
    float wavelength = 0;           // nanometres; 0 until a dispersive surface is met
    MediumStack media;              // volumes that the ray is inside of
    Medium medium;                  // of the one that fills the space
    uint32_t false_boundaries = 0;  // crossed ones that were no surfaces
    uint32_t medium_events = 0;     // times that the path scattered inside media
    RayCone cone;                   // of `ray` at its origin; in kernels with ray cones alone, the
                                    // others do not even clear it

    // Goes on inside other volumes than before.
    void enter(const MediumStack& now, std::span<const Material> materials) {
        media = now;
        medium = medium_inside(now, materials);
    }
};

}  // namespace talbot
