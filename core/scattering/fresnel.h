// Fresnel reflectance: exact for dielectrics (unpolarised) and Schlick's approximation; refraction.
// eta is the refractive index on the transmitted side over that on the incident side. Radicands are
// formed in double: in float the refracted cosine loses half its digits near the critical angle.
#pragma once

#include <cmath>

#include "core/math/robust.h"
#include "core/math/vec.h"

namespace talbot {

// (1 - cos)^5, cos in [0, 1].
inline float schlick_weight(float cos_theta) {
    const float m = 1 - cos_theta;
    const float m2 = m * m;
    return m2 * m2 * m;
}

// Reflectance of a smooth interface at normal incidence; 1 for an index of 0.
inline float normal_reflectance(float eta) {
    const float r = (eta - 1) / (eta + 1);
    return r * r;
}

inline bool is_index_matched(float eta) {
    return std::abs(eta - 1) < kIndexMatched;
}

struct DielectricFresnel {
    float reflectance = 1;  // 1 under total internal reflection
    float cos_t = 0;        // of the refracted direction, 0 under total internal reflection
};

// Exact unpolarised reflectance for cos_i in [0, 1], eta > 0. A matched index gives reflectance 0
// at every angle.
inline DielectricFresnel fresnel_dielectric(float cos_i, float eta) {
    if (is_index_matched(eta)) return {0, cos_i};
    const double c = cos_i;
    const double n = eta;
    const double cos2_t = 1 - (1 - c * c) / (n * n);
    if (!(cos2_t > 0)) return {};
    const double ct = std::sqrt(cos2_t);
    const double perpendicular = (c - n * ct) / (c + n * ct);
    const double parallel = (n * c - ct) / (n * c + ct);
    return {static_cast<float>(0.5 * (perpendicular * perpendicular + parallel * parallel)),
            static_cast<float>(ct)};
}

// wo mirrored about h.
inline Vec3f reflect_about(const Vec3f& wo, const Vec3f& h, float cos_o) {
    return 2 * cos_o * h - wo;
}

// wo refracted through the facet h, given both cosines to it.
inline Vec3f refract_through(const Vec3f& wo, const Vec3f& h, float cos_o, float cos_t, float eta) {
    const float inv_eta = 1 / eta;
    return (cos_o * inv_eta - cos_t) * h - inv_eta * wo;
}

}  // namespace talbot
