// The layered glTF surface as one BSDF: an opaque part (GGX reflection over a diffuse base, or metal) mixed with a glass part
// (reflection and refraction at a dielectric interface). Directions point away from the surface, unit length, in world space.
// Templated over the effect tier: parts that the tier lacks are not compiled in, and give the same numbers where they would
// have weight zero.
#pragma once

#include <optional>

#include "core/math/frame.h"
#include "core/math/vec.h"
#include "core/scene/effects.h"

namespace talbot {

// A material's factors at one point, after textures. alpha = roughness^2 of glTF.
struct ShadingParams {
    Rgb base_color{1};
    float metallic = 0;
    float alpha = 1;             // below kDeltaAlpha the surface is a perfect mirror or smooth interface
    float specular = 1;          // KHR_materials_specular factor
    Rgb specular_color{1};
    float ior = 1.5f;            // of the material; 0 = Fresnel 1 everywhere
    float transmission = 0;
    bool thin = true;            // thin wall: no refraction
};

struct BsdfSample {
    Vec3f wi{0, 0, 1};
    Rgb weight{0};            // f |cos| / pdf (for delta: the lobe's reflectance over its selection probability)
    float pdf = 0;            // per solid angle; selection probability for delta
    bool delta = false;
    bool transmitted = false;  // wi is on the other side of the geometric surface
    float eta = 1;            // refractive index on wi's side over that on wo's side; 1 unless refracted
};

struct BsdfEval {
    Rgb f_cos{0};   // f times |cos theta_i| of the shading normal
    float pdf = 0;  // of sample() giving wi
};

template <EffectSet kTier>
class Bsdf {
  public:
    // frame.n is the shading normal on wo's side, n_geometric the unit geometric normal on wo's side. outside: wo is on the
    // outside of a closed volume (always true for thin walls and opaque surfaces).
    Bsdf(const ShadingParams& params, const Frame& frame, const Vec3f& n_geometric, const Vec3f& wo, bool outside);

    // Whether eval() can be non-zero for any direction: false for purely specular surfaces.
    bool has_smooth_lobe() const;

    // Value and density for a direction; both 0 for delta lobes and for directions that the lobes cannot reach.
    BsdfEval eval(const Vec3f& wi) const;

    // u_lobe selects the lobe, u the direction, each in [0, 1). Empty when the sample carries nothing.
    std::optional<BsdfSample> sample(float u_lobe, const Vec2f& u) const;
};

}  // namespace talbot
