// The layered glTF surface as one BSDF: an opaque part (GGX reflection over a diffuse base, or
// metal) mixed with a glass part (reflection and refraction at a dielectric interface). Directions
// point away from the surface, unit length, in world space. Templated over the effect tier: parts
// that the tier lacks are not compiled in, and give the same numbers where they would have weight
// zero.
//
// Values are of radiance: glass scales by 1 / eta^2 on the way into wo, so a closed body in a
// uniform environment returns 1.
#pragma once

#include <algorithm>
#include <optional>
#include <type_traits>

#include "core/math/frame.h"
#include "core/math/vec.h"
#include "core/math/warp.h"
#include "core/scattering/glass_layer.h"
#include "core/scattering/opaque_layer.h"
#include "core/scattering/shading_normal.h"
#include "core/scene/effects.h"

namespace talbot {

// A material's factors at one point, after textures. alpha = roughness^2 of glTF.
struct ShadingParams {
    Rgb base_color{1};
    float metallic = 0;
    float alpha = 1;     // below kDeltaAlpha the surface is a perfect mirror or smooth interface
    float specular = 1;  // KHR_materials_specular factor
    Rgb specular_color{1};
    float ior = 1.5f;  // of the material; 0 = Fresnel 1 everywhere
    float transmission = 0;
    bool thin = true;  // thin wall: no refraction
};

struct BsdfSample {
    Vec3f wi{0, 0, 1};
    Rgb weight{
        0};  // f |cos| / pdf (for delta: the lobe's reflectance over its selection probability)
    float pdf = 0;  // per solid angle; selection probability for delta
    bool delta = false;
    bool transmitted = false;  // wi is on the other side of the geometric surface
    float eta = 1;             // index on wi's side over that on wo's side; 1 unless refracted
};

struct BsdfEval {
    Rgb f_cos{0};   // f times |cos theta_i| of the shading normal
    float pdf = 0;  // of sample() giving wi
};

template <EffectSet kTier>
class Bsdf {
    static constexpr bool kGlossy = kTier.has(Effect::glossy);
    static constexpr bool kSpecular = kTier.has(Effect::specular);
    static constexpr bool kGlass = kTier.has(Effect::transmission);
    static constexpr bool kThin = kTier.has(Effect::thin_wall);

  public:
    // frame.n is the shading normal on wo's side, n_geometric the unit geometric normal on wo's
    // side. outside: wo is on the outside of a closed volume (always true for thin walls and opaque
    // surfaces).
    Bsdf(const ShadingParams& params, const Frame& frame, const Vec3f& n_geometric, const Vec3f& wo,
         bool outside);

    // Whether eval() can be non-zero for any direction: false for purely specular surfaces.
    bool has_smooth_lobe() const;

    // Value and density for a direction; both 0 for delta lobes and for directions that the lobes
    // cannot reach.
    BsdfEval eval(const Vec3f& wi) const;

    // u_lobe selects the lobe, u the direction, each in [0, 1). Empty when the sample carries
    // nothing.
    std::optional<BsdfSample> sample(float u_lobe, const Vec2f& u) const;

  private:
    struct Absent {};

    bool is_lambert() const {
        if constexpr (!kGlossy && !kGlass) return true;
        return lambert_;
    }
    void add_specular(const Vec3f& wi_local, BsdfEval& sum) const;
    void add_diffuse(float cos_i, BsdfEval& sum) const;
    BsdfEval eval_lambert(const Vec3f& wi) const;
    BsdfEval eval_tilted(const Vec3f& wi) const;
    std::optional<BsdfSample> sample_diffuse(const Vec2f& u) const;
    std::optional<BsdfSample> sample_opaque_specular(const Vec2f& u) const;
    std::optional<BsdfSample> sample_glass(float u_lobe, const Vec2f& u) const;
    std::optional<BsdfSample> smooth_sample(const Vec3f& wi, bool transmitted) const;
    std::optional<BsdfSample> delta_sample(const Vec3f& wi, const Rgb& share, float p) const;

    const Frame& specular_frame() const { return flat_ ? frame_ : bent_frame_; }
    // w, folded at the surface if it is not on the side where a reflection or a transmission
    // belongs.
    Vec3f on_side(const Vec3f& w, bool transmitted) const {
        if (flat_ || (dot(w, n_geometric_) < 0) == transmitted) return w;
        return fold_at_surface(w, n_geometric_);
    }

    Frame frame_;
    Frame bent_frame_;  // of the specular lobes; only where the normals differ
    Vec3f n_geometric_;
    Vec3f wo_;
    Vec3f wo_local_{0, 0, 1};  // in the specular lobes' frame
    Rgb base_color_;
    float tilt_scale_ =
        1;  // of diffuse reflection, for the part of its lobe that the surface hides
    float p_glass_ = 0;
    bool flat_ = true;
    bool lambert_ = true;
    [[no_unique_address]] std::conditional_t<kGlossy || kGlass, OpaqueLayer, Absent> opaque_;
    [[no_unique_address]] std::conditional_t<kGlass, GlassLayer, Absent> glass_;
};

template <EffectSet kTier>
Bsdf<kTier>::Bsdf(const ShadingParams& params, const Frame& frame, const Vec3f& n_geometric,
                  const Vec3f& wo, bool outside)
    : frame_(frame), n_geometric_(n_geometric), wo_(wo), base_color_(params.base_color) {
    flat_ = frame.n == n_geometric;
    if (!flat_) {
        // Normals more than a right angle apart mean nothing: the surface's own then.
        const float cos_tilt = dot(frame.n, n_geometric);
        if (cos_tilt > 0) {
            // A cosine lobe tilted by t has (1 + cos t) / 2 of its energy above the surface.
            tilt_scale_ = 2 / (1 + cos_tilt);
        } else {
            frame_ = Frame::from_normal(n_geometric);
            flat_ = true;
        }
    }
    if constexpr (kGlossy || kGlass) {
        const float specular = kSpecular ? params.specular : 1.0f;
        const float metallic = kGlossy ? params.metallic : 0.0f;
        const float transmission = kGlass ? params.transmission * (1 - metallic) : 0.0f;
        lambert_ = !(transmission > 0) && !(kGlossy && (specular > 0 || metallic > 0));
        if (lambert_) return;

        if (!flat_) {
            bent_frame_ = frame_;
            const Vec3f n = bend_shading_normal(frame_.n, n_geometric, wo);
            if (n != frame_.n) bent_frame_ = Frame::from_normal(n);
        }
        wo_local_ = specular_frame().to_local(wo);
        wo_local_.z = glm::clamp(wo_local_.z, 0.0f, 1.0f);
        const Rgb specular_color = kSpecular ? params.specular_color : Rgb(1);
        if constexpr (kGlass) {
            if (transmission > 0) {
                const bool thin = kThin && params.thin;
                glass_ = GlassLayer({params.base_color, params.alpha, specular, specular_color,
                                     params.ior, thin, outside},
                                    transmission, wo_local_);
                p_glass_ = 1;
            }
        }
        if (transmission < 1) {
            const float weight = 1 - transmission;
            opaque_ = OpaqueLayer({params.base_color, metallic / weight, params.alpha,
                                   kGlossy ? specular : 0.0f, specular_color, params.ior},
                                  weight, wo_local_);
            if (!flat_) tilt_scale_ = opaque_.diffuse_tilt_scale(dot(frame_.n, n_geometric_));
            if constexpr (kGlass) {
                const float glass = transmission > 0 ? glass_.albedo() : 0.0f;
                const float sum = glass + opaque_.albedo();
                p_glass_ = sum > 0 ? glass / sum : 0.0f;
            }
        }
    }
}

template <EffectSet kTier>
bool Bsdf<kTier>::has_smooth_lobe() const {
    if (is_lambert()) return true;
    bool smooth = false;
    if constexpr (kGlossy || kGlass) smooth = p_glass_ < 1 && opaque_.has_smooth_lobe();
    if constexpr (kGlass) smooth = smooth || (p_glass_ > 0 && !glass_.is_delta());
    return smooth;
}

template <EffectSet kTier>
BsdfEval Bsdf<kTier>::eval(const Vec3f& wi) const {
    if (is_lambert()) return eval_lambert(wi);
    if (!flat_) return eval_tilted(wi);
    const Vec3f wi_local = frame_.to_local(wi);
    BsdfEval sum;
    add_specular(wi_local, sum);
    if (wi_local.z > 0) add_diffuse(wi_local.z, sum);
    return sum;
}

template <EffectSet kTier>
BsdfEval Bsdf<kTier>::eval_lambert(const Vec3f& wi) const {
    const float cos_i = dot(wi, frame_.n);
    if (!(cos_i > 0)) return {};
    const float pdf = cos_i * kInvPi;
    if (flat_) return {pdf * base_color_, pdf};
    if (!(dot(wi, n_geometric_) > 0)) return {};
    return {(pdf * tilt_scale_) * base_color_, pdf};
}

// The specular lobes are folded at the surface: what would go through it joins its mirror image.
template <EffectSet kTier>
BsdfEval Bsdf<kTier>::eval_tilted(const Vec3f& wi) const {
    BsdfEval sum;
    const float side = dot(wi, n_geometric_);
    if (side == 0) return sum;
    const Vec3f direct = bent_frame_.to_local(wi);
    const Vec3f folded = bent_frame_.to_local(fold_at_surface(wi, n_geometric_));
    if ((direct.z > 0) == (side > 0)) add_specular(direct, sum);
    if ((folded.z > 0) == (side > 0)) add_specular(folded, sum);
    if (side > 0) {
        const float cos_i = dot(wi, frame_.n);
        if (cos_i > 0) add_diffuse(cos_i, sum);
    }
    return sum;
}

template <EffectSet kTier>
void Bsdf<kTier>::add_specular(const Vec3f& wi_local, BsdfEval& sum) const {
    if constexpr (kGlossy) {
        if (p_glass_ < 1 && wi_local.z > 0) {
            const LobeValue v = opaque_.eval_specular(wi_local);
            sum.f_cos += v.f_cos;
            sum.pdf += (1 - p_glass_) * opaque_.specular_probability() * v.pdf;
        }
    }
    if constexpr (kGlass) {
        if (p_glass_ > 0 && wi_local.z != 0) {
            const LobeValue v = glass_.eval(wi_local);
            sum.f_cos += v.f_cos;
            sum.pdf += p_glass_ * v.pdf;
        }
    }
}

template <EffectSet kTier>
void Bsdf<kTier>::add_diffuse(float cos_i, BsdfEval& sum) const {
    if constexpr (kGlossy || kGlass) {
        if (!(p_glass_ < 1)) return;
        const LobeValue v = opaque_.eval_diffuse(std::min(cos_i, 1.0f));
        sum.f_cos += flat_ ? v.f_cos : tilt_scale_ * v.f_cos;
        sum.pdf += (1 - p_glass_) * (1 - opaque_.specular_probability()) * v.pdf;
    }
}

template <EffectSet kTier>
std::optional<BsdfSample> Bsdf<kTier>::sample([[maybe_unused]] float u_lobe, const Vec2f& u) const {
    if (is_lambert()) return sample_diffuse(u);
    if constexpr (kGlass) {
        if (u_lobe < p_glass_)
            return sample_glass(std::min(u_lobe / p_glass_, kOneMinusEpsilon), u);
        u_lobe = std::min((u_lobe - p_glass_) / (1 - p_glass_), kOneMinusEpsilon);
    }
    if constexpr (kGlossy || kGlass) {
        if (u_lobe < opaque_.specular_probability()) return sample_opaque_specular(u);
    }
    return sample_diffuse(u);
}

template <EffectSet kTier>
std::optional<BsdfSample> Bsdf<kTier>::sample_diffuse(const Vec2f& u) const {
    return smooth_sample(frame_.to_world(sample_cosine_hemisphere(u)), false);
}

template <EffectSet kTier>
std::optional<BsdfSample> Bsdf<kTier>::sample_opaque_specular(const Vec2f& u) const {
    if constexpr (kGlossy || kGlass) {
        if (opaque_.is_mirror()) {
            const Vec3f wi(-wo_local_.x, -wo_local_.y, wo_local_.z);
            return delta_sample(on_side(specular_frame().to_world(wi), false),
                                opaque_.mirror_reflectance(),
                                (1 - p_glass_) * opaque_.specular_probability());
        }
        const Vec3f wi = opaque_.sample_specular(u);
        if (wi.z > 0) return smooth_sample(on_side(specular_frame().to_world(wi), false), false);
    }
    return std::nullopt;
}

template <EffectSet kTier>
std::optional<BsdfSample> Bsdf<kTier>::sample_glass(float u_lobe, const Vec2f& u) const {
    if constexpr (kGlass) {
        std::optional<BsdfSample> s;
        if (glass_.is_delta()) {
            const GlassLayer::Split split = glass_.split(wo_local_.z);
            if (u_lobe < split.p_reflect) {
                const Vec3f wi(-wo_local_.x, -wo_local_.y, wo_local_.z);
                return delta_sample(on_side(specular_frame().to_world(wi), false),
                                    glass_.weight() * split.reflected, p_glass_ * split.p_reflect);
            }
            const Vec3f wi =
                glass_.is_straight()
                    ? -wo_
                    : on_side(specular_frame().to_world(glass_.refracted(split.cos_t)), true);
            s = delta_sample(wi, glass_.weight() * glass_.transmitted_scale() * split.transmitted,
                             p_glass_ * (1 - split.p_reflect));
            if (s) s->transmitted = true;
        } else {
            const Vec3f wi = glass_.sample(u_lobe, u);
            if (wi.z == 0) return s;
            const bool transmitted = wi.z < 0;
            s = smooth_sample(on_side(specular_frame().to_world(wi), transmitted), transmitted);
        }
        if (s && s->transmitted) s->eta = glass_.is_straight() ? 1.0f : glass_.eta();
        return s;
    }
    return std::nullopt;
}

// The record of a drawn direction, valued by the same code that light sampling uses.
template <EffectSet kTier>
std::optional<BsdfSample> Bsdf<kTier>::smooth_sample(const Vec3f& wi, bool transmitted) const {
    const BsdfEval e = eval(wi);
    if (!(e.pdf > 0) || is_black(e.f_cos)) return std::nullopt;
    const bool crosses = dot(wi, n_geometric_) < 0;
    if (crosses != transmitted) return std::nullopt;
    return BsdfSample{wi, e.f_cos * (1 / e.pdf), e.pdf, false, transmitted, 1};
}

// share: what the lobe returns; p: the probability of choosing it.
template <EffectSet kTier>
std::optional<BsdfSample> Bsdf<kTier>::delta_sample(const Vec3f& wi, const Rgb& share,
                                                    float p) const {
    if (!(p > 0) || is_black(share)) return std::nullopt;
    return BsdfSample{wi, share * (1 / p), p, true, false, 1};
}

}  // namespace talbot
