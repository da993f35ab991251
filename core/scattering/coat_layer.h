// glTF's clear coat: a colourless dielectric layer of index 1.5 on top of everything, with its own
// roughness and normal. GGX with Schlick's Fresnel and the multiple scattering of Turquin 2019.
// What lies below is scaled by 1 - factor C(wo), C the coat's directional albedo, so that energy is
// conserved; like the extension's own mix this looks at wo alone and is not reciprocal. Local
// frame, z along the coat's normal.
#pragma once

#include <algorithm>

#include "core/scattering/albedo_tables.h"
#include "core/scattering/ggx.h"
#include "core/scattering/shading_params.h"

namespace talbot {

inline constexpr float kCoatF0 = 0.04f;  // of index 1.5

class CoatLayer {
  public:
    CoatLayer() = default;
    // wo has z >= 0.
    CoatLayer(float factor, float alpha, const Vec3f& wo) : wo_(wo), delta_(alpha < kDeltaAlpha) {
        if (delta_) {
            normal_ = factor * (kCoatF0 + (1 - kCoatF0) * schlick_weight(wo.z));
            albedo_ = normal_;
            return;
        }
        ggx_ = Ggx(alpha);
        slant_o_ = ggx_.slant(wo);
        const SchlickAlbedo a = AlbedoRow(alpha)(wo.z);
        const float scale = factor * (1 + kCoatF0 * a.lost());
        normal_ = scale * kCoatF0;
        grazing_ = scale;
        albedo_ = a.a * normal_ + a.b * grazing_;
    }

    float albedo() const { return albedo_; }
    bool is_mirror() const { return delta_; }
    // Of the mirror; is_mirror() only.
    float mirror_reflectance() const { return normal_; }

    // wi with z > 0; nothing for a mirror.
    LobeValue eval(const Vec3f& wi) const {
        if (delta_) return {};
        const GgxReflection r = ggx_.eval_reflection(wo_, slant_o_, wi);
        const float fresnel = normal_ + schlick_weight(r.cos_d) * (grazing_ - normal_);
        return {Rgb(r.value_cos * fresnel), r.pdf};
    }
    // May have z <= 0, which carries nothing.
    Vec3f sample(const Vec2f& u) const {
        if (delta_) return Vec3f(-wo_.x, -wo_.y, wo_.z);
        const Vec3f h = ggx_.sample_visible_normal(wo_, slant_o_, u);
        return reflect_about(wo_, h, dot(wo_, h));
    }

  private:
    Vec3f wo_{0, 0, 1};
    Ggx ggx_;
    float slant_o_ = 1;
    float normal_ = 0;   // compensated Fresnel at normal incidence; for a mirror the reflectance
    float grazing_ = 0;  // the same at grazing incidence
    float albedo_ = 0;
    bool delta_ = true;
};

}  // namespace talbot
