// glTF's opaque surface: GGX reflection over a diffuse base, mixed with metal. Local frame, z along
// the shading normal, x along the direction of anisotropy if there is one.
//
// Specular: Schlick's Fresnel, single scattering plus the multiple scattering of Turquin 2019
// ("Practical multiple scattering compensation"): dielectric and metal each scaled by 1 + F0 (1 -
// e) / e, then mixed, so that white surfaces return exactly what they receive. The scale looks at
// wo alone: f is not reciprocal where alpha is large. Diffuse: Lambert times (1 - S(mu_o)) (1 -
// S(mu_i)) / (1 - mean S), S the dielectric's directional albedo in its largest channel (Kulla and
// Conty 2017), reciprocal and exact in energy. Part of the diffuse light may leave on the other
// side (KHR_materials_diffuse_transmission).
//
// Tiers with the extensions also know anisotropy and thin films; of a film's coloured reflectance
// the base loses the largest channel, so that the other channels are darker by the difference.
#pragma once

#include <algorithm>
#include <type_traits>

#include "core/base/deferred.h"
#include "core/scattering/albedo_tables.h"
#include "core/scattering/extension_tables.h"
#include "core/scattering/fresnel.h"
#include "core/scattering/ggx.h"
#include "core/scattering/shading_params.h"
#include "core/scene/effects.h"

namespace talbot {

// Mean cosine of (1 - mu)^5 mu dmu / sqrt(1 - mu^2), about: where Schlick's Fresnel keeps light
// from entering.
inline constexpr float kGrazingMean = 1.0f / 7;

// What the layer carries besides for each extension that its tier has.
struct OpaqueAnisotropy {
    Deferred<AnisotropicAlbedo> albedo;  // where active
    bool active = false;
};
struct OpaqueFilm {
    FilmNodes specular;    // reflectance, of dielectric and metal, compensated and weighted
    FilmNodes dielectric;  // x: of the dielectric's largest channel
    float alpha = 1;       // isotropic stand-in
    bool active = false;
};
struct OpaqueThrough {
    Rgb diffuse{0};
    float p = 0;  // of diffuse light: the probability that it leaves on the other side
};

template <EffectSet kTier>
class OpaqueLayer {
    static constexpr bool kAnisotropic = kTier.has(Effect::anisotropy);
    static constexpr bool kFilm = kTier.has(Effect::iridescence);
    static constexpr bool kThrough = kTier.has(Effect::diffuse_transmission);

  public:
    OpaqueLayer() = default;

    // metallic: share of metal within the layer; weight scales every value. wo has z >= 0.
    OpaqueLayer(const ShadingParams& m, float metallic, float specular, const Rgb& specular_color,
                float weight, const Vec3f& wo)
        : wo_(wo) {
        const Rgb dielectric =
            glm::min(normal_reflectance(m.ior) * specular_color, Rgb(1)) * specular;
        const float not_metal = 1 - metallic;
        f0_ = max_component(dielectric);
        f90_ = specular;
        delta_ = m.alpha < kDeltaAlpha;
        if constexpr (kFilm) film_.active = m.iridescence > 0;
        if constexpr (kAnisotropic) {
            anisotropy_.active = m.anisotropy > 0;
            delta_ = delta_ && !anisotropy_.active;
        }

        Rgb specular_albedo;
        float s_o = 0;  // S(mu_o)
        if (has_film()) [[unlikely]] {
            specular_albedo = make_film(m, metallic, dielectric, specular, weight, s_o);
        } else if (delta_) {
            const Rgb normal = not_metal * dielectric + metallic * m.base_color;
            const Rgb grazing(not_metal * specular + metallic);
            normal_ = weight * (normal + schlick_weight(wo.z) * (grazing - normal));
            specular_albedo = normal_;
            s_o = f0_ + (f90_ - f0_) * schlick_weight(wo.z);
            mean_s_ = f0_ + (f90_ - f0_) * (1.0f / 21);  // 2 int (1 - mu)^5 mu dmu = 1 / 21
        } else {
            make_distribution(m);
            const SchlickAlbedo albedo = directional_albedo(wo);
            const float lost = albedo.lost();
            const Rgb dielectric_scale = (weight * not_metal) * (Rgb(1) + lost * dielectric);
            const Rgb metal_scale = (weight * metallic) * (Rgb(1) + lost * m.base_color);
            normal_ = dielectric_scale * dielectric + metal_scale * m.base_color;
            grazing_ = dielectric_scale * specular + metal_scale;
            specular_albedo = albedo.a * normal_ + albedo.b * grazing_;
            s_o = compensated(albedo);
            mean_s_ = is_anisotropic()
                          ? hemisphere_mean([&](float mu) { return dielectric_albedo(mu); })
                          : row_.mean_compensated(f0_, f90_);
        }
        make_diffuse(m, not_metal, weight, s_o, mean_component(specular_albedo));
    }

    // Estimated albedo, mean of the channels, with the weight.
    float albedo() const { return albedo_; }
    float specular_probability() const { return p_specular_; }
    // Of diffuse samples: the share that leaves on the other side.
    float through_probability() const {
        if constexpr (kThrough) return through_.p;
        return 0;
    }

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
        if constexpr (kFilm) {
            if (film_.active) [[unlikely]]
                return {r.value_cos * film_.specular.at(r.cos_d), r.pdf};
        }
        const Rgb fresnel = normal_ + schlick_weight(r.cos_d) * (grazing_ - normal_);
        return {r.value_cos * fresnel, r.pdf};
    }

    // The diffuse lobe for a cosine > 0 to the normal, on wo's side or through; density of the lobe
    // alone.
    LobeValue eval_diffuse(float cos_i, bool through = false) const {
        if (p_specular_ == 1) return {};
        const float escaping = std::max(1 - dielectric_albedo(cos_i), 0.0f);
        if constexpr (kThrough) {
            const float p = through_.p;
            if (through) [[unlikely]]
                return {(escaping * cos_i) * through_.diffuse, p * (cos_i * kInvPi)};
            return {(escaping * cos_i) * diffuse_, (1 - p) * (cos_i * kInvPi)};
        }
        return {(escaping * cos_i) * diffuse_, cos_i * kInvPi};
    }

    // wi of the specular lobe, not a mirror; may have z <= 0, which carries nothing.
    Vec3f sample_specular(const Vec2f& u) const {
        const Vec3f h = ggx_.sample_visible_normal(wo_, slant_o_, u);
        return reflect_about(wo_, h, dot(wo_, h));
    }

  private:
    struct Absent {};

    bool is_anisotropic() const {
        if constexpr (kAnisotropic) return anisotropy_.active;
        return false;
    }
    bool has_film() const {
        if constexpr (kFilm) return film_.active;
        return false;
    }

    void make_distribution(const ShadingParams& m) {
        if constexpr (kAnisotropic) {
            if (anisotropy_.active) [[unlikely]] {
                const float across = std::max(m.alpha, kDeltaAlpha);
                const float along = anisotropic_alpha(across, m.anisotropy);
                ggx_ = Ggx(along, across);
                slant_o_ = ggx_.slant(wo_);
                const float round = std::sqrt(along * across);
                if constexpr (kFilm) film_.alpha = round;
                row_ = AlbedoRow(round);
                anisotropy_.albedo.make(across, m.anisotropy);
                return;
            }
        }
        if constexpr (kFilm) film_.alpha = m.alpha;
        ggx_ = Ggx(m.alpha);
        slant_o_ = ggx_.slant(wo_);
        row_ = AlbedoRow(m.alpha);
    }

    // Both reflectances under the film; returns the specular albedo.
    [[gnu::noinline]] Rgb make_film(const ShadingParams& m, float metallic, const Rgb& dielectric,
                                    float specular, float weight, float& s_o) {
        Rgb albedo(0);
        if constexpr (kFilm) {
            FilmNodes mixed;
            for (std::size_t k = 0; k < mixed.f.size(); ++k) {
                const float mu = FilmNodes::cosine(static_cast<int>(k));
                const float grazing = schlick_weight(mu);
                const auto under_film = [&](const Rgb& f0, float f90) {
                    const Rgb plain = f0 + grazing * (Rgb(f90) - f0);
                    const Rgb film =
                        film_reflectance(mu, m.iridescence_ior, m.iridescence_thickness, f0);
                    return plain + m.iridescence * (film - plain);
                };
                const Rgb base = metallic < 1 ? under_film(dielectric, specular) : Rgb(0);
                const Rgb metal = metallic > 0 ? under_film(m.base_color, 1) : Rgb(0);
                film_.dielectric.f[k] = Rgb(max_component(base));
                mixed.f[k] = base + metallic * (metal - base);
            }
            Rgb scale(weight);
            if (!delta_) {
                make_distribution(m);
                scale += (weight * directional_albedo(wo_).lost()) * mixed.at(wo_.z);
            }
            for (std::size_t k = 0; k < mixed.f.size(); ++k)
                film_.specular.f[k] = scale * mixed.f[k];
            albedo =
                delta_ ? film_.specular.at(wo_.z) : film_albedo(film_.specular, film_.alpha, wo_.z);
            normal_ = albedo;
            s_o = dielectric_albedo(wo_.z);
            mean_s_ = hemisphere_mean([&](float mu) { return dielectric_albedo(mu); });
        }
        return albedo;
    }

    void make_diffuse(const ShadingParams& m, float not_metal, float weight, float s_o,
                      float specular_share) {
        float diffuse_share = 0;
        if (not_metal > 0) {
            const float enters = weight * not_metal * std::max(1 - s_o, 0.0f);
            const float scale = mean_s_ < 1 ? kInvPi / (1 - mean_s_) : 0.0f;
            Rgb reflected = enters * m.base_color;
            diffuse_share = mean_component(reflected);
            if constexpr (kThrough) {
                if (m.diffuse_transmission > 0) [[unlikely]] {
                    reflected = (1 - m.diffuse_transmission) * reflected;
                    const Rgb through =
                        (enters * m.diffuse_transmission) * m.diffuse_transmission_color;
                    const float through_share = mean_component(through);
                    diffuse_share = mean_component(reflected) + through_share;
                    if (diffuse_share > 0) through_.p = through_share / diffuse_share;
                    through_.diffuse = through * scale;
                }
            }
            diffuse_ = reflected * scale;
        }
        albedo_ = specular_share + diffuse_share;
        p_specular_ = diffuse_share > 0 ? specular_share / albedo_ : 1.0f;
    }

    // Albedo of the distribution for a direction in the local frame.
    SchlickAlbedo directional_albedo(const Vec3f& w) const {
        if constexpr (kAnisotropic) {
            if (anisotropy_.active) [[unlikely]]
                return (*anisotropy_.albedo)(w);
        }
        return row_(w.z);
    }

    // S: the dielectric specular lobe's directional albedo in its largest channel.
    float dielectric_albedo(float mu) const {
        if constexpr (kFilm) {
            if (film_.active) [[unlikely]] {
                const float normal = film_.dielectric.at(mu).x;
                if (delta_) return normal;
                const float single = film_albedo(film_.dielectric, film_.alpha, mu).x;
                return std::min(single * (1 + normal * row_(mu).lost()), 1.0f);
            }
        }
        if constexpr (kAnisotropic) {
            if (anisotropy_.active) [[unlikely]]
                return compensated(anisotropy_.albedo->around(mu));
        }
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
    // Types of their own, so that absent ones take no room.
    struct NoFilm {};
    struct NoThrough {};
    [[no_unique_address]] std::conditional_t<kAnisotropic, OpaqueAnisotropy, Absent> anisotropy_;
    [[no_unique_address]] std::conditional_t<kFilm, OpaqueFilm, NoFilm> film_;
    [[no_unique_address]] std::conditional_t<kThrough, OpaqueThrough, NoThrough> through_;
};

}  // namespace talbot
