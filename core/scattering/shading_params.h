// What a BSDF is made of and what it answers with.
#pragma once

#include "core/math/vec.h"

namespace talbot {

// A material's factors at one point, after textures. alpha = roughness^2 of glTF. Directions are
// unit, in world space, on wo's side.
struct ShadingParams {
    Rgb base_color{1};
    float metallic = 0;
    float alpha = 1;     // below kDeltaAlpha the surface is a perfect mirror or smooth interface
    float specular = 1;  // KHR_materials_specular factor
    Rgb specular_color{1};
    float ior = 1.5f;  // of the material; 0 = Fresnel 1 everywhere
    float transmission = 0;
    bool thin = true;  // thin wall: no refraction

    float diffuse_transmission = 0;
    Rgb diffuse_transmission_color{1};

    float clearcoat = 0;
    float clearcoat_alpha = 0;
    Vec3f clearcoat_normal{0, 0, 1};  // read where clearcoat > 0

    Rgb sheen_color{0};
    float sheen_alpha = 0;

    float anisotropy = 0;           // strength
    Vec3f anisotropy_direction{0};  // in which highlights stretch; read where anisotropy > 0

    float iridescence = 0;
    float iridescence_ior = 1.3f;
    float iridescence_thickness = 400;  // nanometres
};

// Whether light from behind the surface can count. Metal lets none through.
inline bool is_lit_through(const ShadingParams& p) {
    return (p.transmission > 0 || p.diffuse_transmission > 0) && p.metallic < 1;
}

struct BsdfSample {
    Vec3f wi{0, 0, 1};
    // f |cos| / pdf (for delta: the lobe's reflectance over its selection probability)
    Rgb weight{0};
    float pdf = 0;  // per solid angle; selection probability for delta
    bool delta = false;
    bool transmitted = false;  // wi is on the other side of the geometric surface
    float eta = 1;             // index on wi's side over that on wo's side; 1 unless refracted
};

struct BsdfEval {
    Rgb f_cos{0};   // f times |cos theta_i| of the shading normal
    float pdf = 0;  // of sample() giving wi
};

// One lobe's share of the above.
struct LobeValue {
    Rgb f_cos{0};
    float pdf = 0;
};

inline float mean_component(const Rgb& c) {
    return (c.x + c.y + c.z) * (1.0f / 3);
}

}  // namespace talbot
