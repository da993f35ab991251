// glTF's transmission: a dielectric interface, or a thin wall that does not refract. Local frame, z
// along the shading normal on wo's side; eta is the index on the far side over that on wo's side.
//
// Values are of radiance: light refracted into wo is scaled by 1 / eta^2 (Veach 1997, section 5.2),
// so that entering and leaving a closed body cancels. Rough interfaces are those of Walter et al.
// 2007 with visible normals. base_color tints what is transmitted at each crossing.
// KHR_materials_specular rescales the reflectance between its values at normal and at grazing
// incidence; total internal reflection stays total. Tiers with the extensions also know anisotropy
// and thin films; a film is met from outside only, and what it reflects in its largest channel is
// missing from all channels of what is transmitted.
#pragma once

#include <algorithm>
#include <type_traits>

#include "core/scattering/albedo_tables.h"
#include "core/scattering/extension_tables.h"
#include "core/scattering/fresnel.h"
#include "core/scattering/ggx.h"
#include "core/scattering/shading_params.h"
#include "core/scene/effects.h"

namespace talbot {

template <EffectSet kTier>
class GlassLayer {
    static constexpr bool kAnisotropic = kTier.has(Effect::anisotropy);
    static constexpr bool kFilm = kTier.has(Effect::iridescence);

  public:
    GlassLayer() = default;

    // outside: wo is on the outside of a closed volume. weight scales every value. wo has z >= 0.
    GlassLayer(const ShadingParams& m, bool thin, float specular, const Rgb& specular_color,
               bool outside, float weight, const Vec3f& wo)
        : wo_(wo), tint_(m.base_color), weight_(weight), thin_(thin) {
        full_fresnel_ = m.ior == 0;
        const float ior = full_fresnel_ ? 1.0f : m.ior;
        eta_ = outside || thin ? ior : 1 / ior;
        // The tables know indices from 1 on: a thinner inside is met as from within a denser one.
        const float dense = ior < 1 ? 1 / ior : ior;
        const bool from_thin = outside == !(ior < 1);
        plain_ = specular == 1 && specular_color == Rgb(1);
        if (!plain_) {
            f0_ = normal_reflectance(m.ior);
            normal_ = glm::min(f0_ * specular_color, Rgb(1)) * specular;
            grazing_ = specular;
        }
        straight_ = thin_ || is_index_matched(eta_);
        bool anisotropic = false;
        if constexpr (kAnisotropic) anisotropic = m.anisotropy > 0;
        if constexpr (kFilm) {
            has_film_ = m.iridescence > 0 && outside;
            if (has_film_) [[unlikely]]
                make_film(m, specular, specular_color);
        }
        delta_ = (m.alpha < kDeltaAlpha && !anisotropic) ||
                 (is_index_matched(eta_) && !full_fresnel_ && !has_film());
        if (delta_) return;
        // What a single scattering loses leaves in proportion to what it does not.
        if (anisotropic) [[unlikely]] {
            const float across = std::max(m.alpha, kDeltaAlpha);
            const float along = anisotropic_alpha(across, m.anisotropy);
            ggx_ = Ggx(along, across);
            slant_o_ = ggx_.slant(wo);
            const AnisotropicAlbedo albedo(across, m.anisotropy);
            weight_ /= straight_ ? albedo(wo).e()
                                 : glass_albedo(wo.z, albedo.round_alpha(wo), dense, from_thin);
        } else {
            ggx_ = Ggx(m.alpha);
            slant_o_ = ggx_.slant(wo);
            weight_ /= straight_ ? AlbedoRow(m.alpha)(wo.z).e()
                                 : glass_albedo(wo.z, m.alpha, dense, from_thin);
        }
    }

    // Reflected and transmitted share at a facet that wo sees at cosine cos_d, and the probability
    // of reflection.
    struct Split {
        Rgb reflected{0};
        Rgb transmitted{0};
        float p_reflect = 1;
        float cos_t = 0;
        bool carries = true;
    };

    Split split(float cos_d) const {
        Split s;
        float total = 1;
        if (full_fresnel_) {
            s.cos_t = cos_d;
        } else {
            const DielectricFresnel fresnel = fresnel_dielectric(cos_d, eta_);
            total = fresnel.reflectance;
            s.cos_t = fresnel.cos_t;
        }
        s.reflected = Rgb(total);
        const bool total_internal = !full_fresnel_ && s.cos_t == 0 && eta_ < 1;
        if (!plain_ && !total_internal) {
            const float t = f0_ < 1 ? std::max(total - f0_, 0.0f) / (1 - f0_) : 0.0f;
            s.reflected = normal_ + t * (Rgb(grazing_) - normal_);
        }
        if constexpr (kFilm) {
            if (has_film_) [[unlikely]]
                s.reflected += iridescence_ * (film_.at(cos_d) - s.reflected);
        }
        s.transmitted = std::max(1 - max_component(s.reflected), 0.0f) * tint_;
        const float reflected = mean_component(s.reflected);
        const float sum = reflected + mean_component(s.transmitted);
        s.carries = sum > 0;
        if (s.carries) s.p_reflect = reflected / sum;
        return s;
    }

    // Estimated albedo, mean of the channels, with the weight.
    float albedo() const {
        const Split s = split(wo_.z);
        return weight_ * (mean_component(s.reflected) + mean_component(s.transmitted));
    }
    bool is_delta() const { return delta_; }
    // Transmitted light goes straight on.
    bool is_straight() const { return straight_; }
    float eta() const { return eta_; }
    float weight() const { return weight_; }

    // Radiance scale of transmitted light.
    float transmitted_scale() const { return straight_ ? 1.0f : 1 / (eta_ * eta_); }

    // Refracted wo at the flat interface.
    Vec3f refracted(float cos_t) const {
        return refract_through(wo_, Vec3f(0, 0, 1), wo_.z, cos_t, eta_);
    }

    // Rough interface: value and density of the layer for wi on either side, z != 0.
    LobeValue eval(const Vec3f& wi) const {
        if (delta_) return {};
        if (wi.z > 0) return eval_mirrored(wi, true);
        if (straight_) return eval_mirrored(Vec3f(wi.x, wi.y, -wi.z), false);
        return eval_refracted(wi);
    }

    // Rough interface: wi on either side. Length 0 when the sample carries nothing.
    Vec3f sample(float u_lobe, const Vec2f& u) const {
        const Vec3f h = ggx_.sample_visible_normal(wo_, slant_o_, u);
        const float cos_d = dot(wo_, h);
        if (!(cos_d > 0)) return Vec3f(0);
        const Split s = split(std::min(cos_d, 1.0f));
        const bool reflects = u_lobe < s.p_reflect;
        Vec3f wi = reflect_about(wo_, h, cos_d);
        if (!reflects) {
            if (straight_) {
                wi.z = -wi.z;
            } else {
                wi = refract_through(wo_, h, cos_d, s.cos_t, eta_);
            }
        }
        return (wi.z > 0) == reflects && wi.z != 0 && s.carries ? wi : Vec3f(0);
    }

  private:
    struct Absent {};

    bool has_film() const {
        if constexpr (kFilm) return has_film_;
        return false;
    }
    void make_film(const ShadingParams& m, float specular, const Rgb& specular_color) {
        if constexpr (kFilm) {
            const Rgb f0 = glm::min(normal_reflectance(m.ior) * specular_color, Rgb(1)) * specular;
            for (std::size_t k = 0; k < film_.f.size(); ++k) {
                film_.f[k] = film_reflectance(FilmNodes::cosine(static_cast<int>(k)),
                                              m.iridescence_ior, m.iridescence_thickness, f0);
            }
            iridescence_ = m.iridescence;
        }
    }

    // wi with z > 0, as reflected or as the mirror image of a transmitted direction.
    LobeValue eval_mirrored(const Vec3f& wi, bool reflected) const {
        const GgxReflection r = ggx_.eval_reflection(wo_, slant_o_, wi);
        const Split s = split(r.cos_d);
        if (!s.carries) return {};
        const float p = reflected ? s.p_reflect : 1 - s.p_reflect;
        return {(weight_ * r.value_cos) * (reflected ? s.reflected : s.transmitted), p * r.pdf};
    }

    LobeValue eval_refracted(const Vec3f& wi) const {
        Vec3f h = wo_ + eta_ * wi;
        const float h2 = dot(h, h);
        if (!(h2 > 0)) return {};
        h *= (h.z < 0 ? -1 : 1) / std::sqrt(h2);
        const float cos_o = dot(wo_, h);
        const float cos_i = dot(wi, h);
        if (!(cos_o > 0) || !(cos_i < 0)) return {};
        const Split s = split(std::min(cos_o, 1.0f));
        if (!s.carries) return {};
        // Walter et al. 2007, equations 17 and 21.
        const float across = cos_o + eta_ * cos_i;
        const float jacobian = -cos_i / (across * across);  // times eta^2 in the density only
        const float d = ggx_.d(h);
        const float z_i = -wi.z;
        const float g = Ggx::g2_over_2_cos2(wo_.z, slant_o_, z_i, ggx_.slant(wi));
        LobeValue r;
        r.f_cos = (weight_ * 2 * d * g * z_i * cos_o * jacobian) * s.transmitted;
        r.pdf = (1 - s.p_reflect) * 2 * d * cos_o / (wo_.z + slant_o_) * jacobian * (eta_ * eta_);
        return r;
    }

    Vec3f wo_{0, 0, 1};
    Rgb tint_{1};
    Rgb normal_{0};  // KHR_materials_specular's reflectance at normal incidence
    Ggx ggx_;
    float slant_o_ = 1;
    float weight_ = 1;
    float eta_ = 1;
    float f0_ = 0;
    float grazing_ = 1;
    bool plain_ = true;
    bool full_fresnel_ = false;  // index 0: Fresnel 1 everywhere, before the specular factor
    bool thin_ = true;
    bool straight_ = true;
    bool delta_ = true;
    [[no_unique_address]] std::conditional_t<kFilm, FilmNodes, Absent> film_;
    float iridescence_ = 0;
    bool has_film_ = false;
};

}  // namespace talbot
