// The GGX (Trowbridge-Reitz) microfacet distribution in its stable form, with height-correlated
// Smith shadowing and visible-normal sampling. Local frame: z along the shading normal, wo on its
// positive side, unit vectors. Letters: D, G1, G2, Lambda as in Heitz 2014, "Understanding the
// masking-shadowing function".
#pragma once

#include <algorithm>
#include <limits>

#include "core/math/robust.h"
#include "core/math/vec.h"
#include "core/math/warp.h"

namespace talbot {

// D V cos and density of a reflected direction; cos_d is the cosine between either direction and
// the half vector.
struct GgxReflection {
    float value_cos = 0;  // D G2 / (4 cos_o cos_i) cos_i
    float pdf = 0;        // per solid angle of wi, wo's visible normals being sampled
    float cos_d = 0;
};

struct Ggx {
    float ax = 1;
    float ay = 1;
    float inv_ax = 1;
    float inv_ay = 1;

    Ggx() = default;
    explicit Ggx(float alpha) : Ggx(alpha, alpha) {}
    Ggx(float alpha_x, float alpha_y)
        : ax(alpha_x), ay(alpha_y), inv_ax(1 / alpha_x), inv_ay(1 / alpha_y) {}

    // Density of normals per solid angle, h on the positive side. Only positive terms: no
    // cancellation at any alpha.
    float d(const Vec3f& h) const {
        const float q = stretched_square(h);
        return kInvPi * inv_ax * inv_ay / (q * q);
    }

    // |diag(1/ax, 1/ay, 1) h|^2.
    float stretched_square(const Vec3f& h) const {
        const float x = h.x * inv_ax;
        const float y = h.y * inv_ay;
        return x * x + y * y + h.z * h.z;
    }

    // |diag(ax, ay, 1) w|: Lambda(w) = (slant(w) / |w.z| - 1) / 2.
    float slant(const Vec3f& w) const {
        const float x = ax * w.x;
        const float y = ay * w.y;
        return std::sqrt(x * x + y * y + w.z * w.z);
    }

    float g1(const Vec3f& w) const {
        const float z = std::abs(w.z);
        return 2 * z / (z + slant(w));
    }

    // Height-correlated masking and shadowing over 2 cos_o cos_i: finite at grazing (Heitz 2014,
    // equation 99).
    static float g2_over_2_cos2(float z_o, float slant_o, float z_i, float slant_i) {
        return 1 / (z_i * slant_o + z_o * slant_i);
    }
    float g2(const Vec3f& wo, const Vec3f& wi) const {
        const float z_o = std::abs(wo.z);
        const float z_i = std::abs(wi.z);
        return 2 * z_o * z_i * g2_over_2_cos2(z_o, slant(wo), z_i, slant(wi));
    }

    // A normal that wo sees, by a uniform cap of the sphere (Dupuy and Benyoub 2023).
    Vec3f sample_visible_normal(const Vec3f& wo, float slant_o, const Vec2f& u) const {
        const float inv = 1 / slant_o;
        const Vec3f w(ax * wo.x * inv, ay * wo.y * inv, wo.z * inv);
        float s = 0;
        float c = 0;
        sin_cos_turn(u.x, s, c);
        const float t = u.y * (1 + w.z);  // 1 - z of the cap's point
        const float r = std::sqrt(t * (2 - t));
        const Vec3f h(ax * (r * c + w.x), ay * (r * s + w.y), (1 - u.y) * (1 + w.z));
        return h * (1 / std::sqrt(dot(h, h)));
    }
    Vec3f sample_visible_normal(const Vec3f& wo, const Vec2f& u) const {
        return sample_visible_normal(wo, slant(wo), u);
    }

    // Its density per solid angle of h.
    float pdf_visible_normal(const Vec3f& wo, float slant_o, const Vec3f& h) const {
        const float cos_d = dot(wo, h);
        if (!(cos_d > 0) || !(h.z > 0)) return 0;
        return 2 * d(h) * cos_d / (wo.z + slant_o);
    }
    float pdf_visible_normal(const Vec3f& wo, const Vec3f& h) const {
        return pdf_visible_normal(wo, slant(wo), h);
    }

    // Reflection from wo to wi, both with z > 0, without Fresnel.
    GgxReflection eval_reflection(const Vec3f& wo, float slant_o, const Vec3f& wi) const {
        const Vec3f h = wo + wi;  // not normalised: its length is 2 cos_d
        const float h2 = dot(h, h);
        if (!(h2 >= std::numeric_limits<float>::min())) return {};
        const float ratio = h2 / stretched_square(h);
        const float half_d = 0.5f * kInvPi * inv_ax * inv_ay * (ratio * ratio);
        GgxReflection r;
        r.value_cos = half_d * wi.z * g2_over_2_cos2(wo.z, slant_o, wi.z, slant(wi));
        r.pdf = half_d / (wo.z + slant_o);
        r.cos_d = std::min(0.5f * std::sqrt(h2), 1.0f);
        return r;
    }
};

}  // namespace talbot
