// glTF's opaque surface: GGX reflection over a diffuse base, mixed with metal. Local frame, z along
// the shading normal.
//
// Specular: Schlick's Fresnel, single scattering plus the multiple scattering of Turquin 2019
// ("Practical multiple scattering compensation"): dielectric and metal each scaled by 1 + F0 (1 -
// e) / e, then mixed, so that white surfaces return exactly what they receive. The scale looks at
// wo alone: f is not reciprocal where alpha is large. Diffuse: Lambert times (1 - S(mu_o)) (1 -
// S(mu_i)) / (1 - mean S), S the dielectric's directional albedo in its largest channel (Kulla and
// Conty 2017), reciprocal and exact in energy.
#pragma once

#include <algorithm>

#include "core/scattering/albedo_tables.h"
#include "core/scattering/fresnel.h"
#include "core/scattering/ggx.h"

namespace talbot {

struct LobeValue {
    Rgb f_cos{0};
    float pdf = 0;
};

inline float mean_component(const Rgb& c) {
    return (c.x + c.y + c.z) * (1.0f / 3);
}

struct OpaqueParams {
    Rgb base_color{1};
    float metallic = 0;
    float alpha = 1;
    float specular = 1;
    Rgb specular_color{1};
    float ior = 1.5f;
};

// Mean cosine of (1 - mu)^5 mu dmu / sqrt(1 - mu^2), about: where Schlick's Fresnel keeps light
// from entering.
inline constexpr float kGrazingMean = 1.0f / 7;

class OpaqueLayer {
  public:
    OpaqueLayer() = default;

    // weight scales every value. wo has z >= 0.
    OpaqueLayer(const OpaqueParams& m, float weight, const Vec3f& wo) : wo_(wo) {
        const Rgb dielectric =
            glm::min(normal_reflectance(m.ior) * m.specular_color, Rgb(1)) * m.specular;
        const float not_metal = 1 - m.metallic;
        f0_ = max_component(dielectric);
        f90_ = m.specular;
        delta_ = m.alpha < kDeltaAlpha;

        Rgb specular_albedo;
        float s_o = 0;  // S(mu_o)
        if (delta_) {
            const Rgb normal = not_metal * dielectric + m.metallic * m.base_color;
            const Rgb grazing(not_metal * m.specular + m.metallic);
            normal_ = weight * (normal + schlick_weight(wo.z) * (grazing - normal));
            specular_albedo = normal_;
            s_o = f0_ + (f90_ - f0_) * schlick_weight(wo.z);
            mean_s_ = f0_ + (f90_ - f0_) * (1.0f / 21);  // 2 int (1 - mu)^5 mu dmu = 1 / 21
        } else {
            ggx_ = Ggx(m.alpha);
            slant_o_ = ggx_.slant(wo);
            row_ = AlbedoRow(m.alpha);
            const SchlickAlbedo albedo = row_(wo.z);
            const float lost = albedo.lost();
            const Rgb dielectric_scale = (weight * not_metal) * (Rgb(1) + lost * dielectric);
            const Rgb metal_scale = (weight * m.metallic) * (Rgb(1) + lost * m.base_color);
            normal_ = dielectric_scale * dielectric + metal_scale * m.base_color;
            grazing_ = dielectric_scale * m.specular + metal_scale;
            specular_albedo = albedo.a * normal_ + albedo.b * grazing_;
            s_o = compensated(albedo);
            mean_s_ = row_.mean_compensated(f0_, f90_);
        }

        const float specular_share = mean_component(specular_albedo);
        float diffuse_share = 0;
        if (not_metal > 0) {
            const Rgb diffuse_albedo =
                (weight * not_metal * std::max(1 - s_o, 0.0f)) * m.base_color;
            diffuse_ = mean_s_ < 1 ? diffuse_albedo * (kInvPi / (1 - mean_s_)) : Rgb(0);
            diffuse_share = mean_component(diffuse_albedo);
        }
        albedo_ = specular_share + diffuse_share;
        p_specular_ = diffuse_share > 0 ? specular_share / albedo_ : 1.0f;
    }

    // Estimated albedo, mean of the channels, with the weight.
    float albedo() const { return albedo_; }
    float specular_probability() const { return p_specular_; }

    // What the diffuse lobe is multiplied by when it is tilted against the surface, for the part
    // that the surface hides; cos_tilt in (0, 1]. The lobe is taken as a cosine less a part that
    // the specular layer keeps near the horizon, of which nearly half is hidden.
    float diffuse_tilt_scale(float cos_tilt) const {
        const float visible = 0.5f * (1 + cos_tilt);
        const float everywhere = delta_ ? f0_ : compensated(row_(1));
        const float grazing = std::max(mean_s_ - everywhere, 0.0f);
        if (!(mean_s_ < 1) || !(grazing > 0)) return 1 / visible;
        // Share of the azimuths that are visible at the cosine kGrazingMean: 1/2 + asin(x) / pi.
        const float x = std::min(
            kGrazingMean * cos_tilt / std::sqrt(std::max(1 - cos_tilt * cos_tilt, kFloatEpsilon)),
            1.0f);
        const float x2 = x * x;
        const float x4 = x2 * x2;
        const float around = 0.5f + x * (kInvPi + (0.5f - kInvPi) * x4 * x4);
        const float share = ((1 - mean_s_ + grazing) * visible - grazing * around) / (1 - mean_s_);
        return 1 / std::min(share, 1.0f);
    }
    bool is_mirror() const { return delta_; }
    bool has_smooth_lobe() const { return !delta_ || p_specular_ < 1; }

    // Reflectance of the mirror; is_mirror() only.
    const Rgb& mirror_reflectance() const { return normal_; }

    // The specular lobe for wi with z > 0; density of the lobe alone. 0 for a mirror.
    LobeValue eval_specular(const Vec3f& wi) const {
        if (delta_) return {};
        const GgxReflection r = ggx_.eval_reflection(wo_, slant_o_, wi);
        const Rgb fresnel = normal_ + schlick_weight(r.cos_d) * (grazing_ - normal_);
        return {r.value_cos * fresnel, r.pdf};
    }

    // The diffuse lobe for a cosine > 0 to the normal; density of the lobe alone.
    LobeValue eval_diffuse(float cos_i) const {
        if (p_specular_ == 1) return {};
        const float escaping = std::max(1 - dielectric_albedo(cos_i), 0.0f);
        return {(escaping * cos_i) * diffuse_, cos_i * kInvPi};
    }

    // wi of the specular lobe, not a mirror; may have z <= 0, which carries nothing.
    Vec3f sample_specular(const Vec2f& u) const {
        const Vec3f h = ggx_.sample_visible_normal(wo_, slant_o_, u);
        return reflect_about(wo_, h, dot(wo_, h));
    }

  private:
    // S: the dielectric specular lobe's directional albedo in its largest channel.
    float dielectric_albedo(float mu) const {
        if (delta_) return f0_ + (f90_ - f0_) * schlick_weight(mu);
        return compensated(row_(mu));
    }
    float compensated(const SchlickAlbedo& albedo) const {
        return (f0_ * albedo.a + f90_ * albedo.b) * (1 + f0_ * albedo.lost());
    }

    Vec3f wo_{0, 0, 1};
    Ggx ggx_;
    AlbedoRow row_;
    Rgb normal_{0};  // compensated Fresnel at normal incidence; for a mirror the reflectance itself
    Rgb grazing_{0};  // the same at grazing incidence
    Rgb diffuse_{0};
    float slant_o_ = 1;
    float f0_ = 0;
    float f90_ = 1;
    float mean_s_ = 0;  // S over the cosine-weighted hemisphere
    float albedo_ = 0;
    float p_specular_ = 0;
    bool delta_ = false;
};

}  // namespace talbot
