// The layered glTF surface as one BSDF: an opaque part (GGX reflection over a diffuse base, or
// metal) mixed with a glass part (reflection and refraction at a dielectric interface), under
// sheen, under a clear coat. Each layer scales what lies below by what it lets through of wo.
// Directions point away from the surface, unit length, in world space. Templated over the effect
// tier: parts that the tier lacks are not compiled in, and give the same numbers where they would
// have weight zero.
//
// Values are of radiance: glass scales by 1 / eta^2 on the way into wo, so a closed body in a
// uniform environment returns 1.
#pragma once

#include <algorithm>
#include <memory>
#include <optional>
#include <type_traits>

#include "core/base/deferred.h"
#include "core/math/frame.h"
#include "core/math/vec.h"
#include "core/math/warp.h"
#include "core/scattering/coat_layer.h"
#include "core/scattering/glass_layer.h"
#include "core/scattering/opaque_layer.h"
#include "core/scattering/shading_normal.h"
#include "core/scattering/shading_params.h"
#include "core/scattering/sheen_layer.h"
#include "core/scene/effects.h"

namespace talbot {

template <EffectSet kTier>
class Bsdf {
    static constexpr bool kGlossy = kTier.has(Effect::glossy);
    static constexpr bool kSpecular = kTier.has(Effect::specular);
    static constexpr bool kGlass = kTier.has(Effect::transmission);
    static constexpr bool kThin = kTier.has(Effect::thin_wall);
    static constexpr bool kCoat = kTier.has(Effect::clearcoat);
    static constexpr bool kSheen = kTier.has(Effect::sheen);
    static constexpr bool kThrough = kTier.has(Effect::diffuse_transmission);

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
    // p is the probability of choosing a layer: the rest is there where it is above zero.
    struct Coat {
        Deferred<CoatLayer> layer;
        Deferred<Frame> frame;
        bool flat = true;  // the coat's normal is the surface's
        float p = 0;
    };
    struct Sheen {
        Deferred<SheenLayer> layer;
        float p = 0;
    };

    void make_base(const ShadingParams& params, bool outside, float weight);
    float make_coat(const ShadingParams& params);
    float make_sheen(const ShadingParams& params, float weight);
    void make_frames(const ShadingParams& params);
    void share_probability(float base_albedo);

    bool is_lambert() const {
        if constexpr (!kGlossy && !kGlass) return true;
        return lambert_;
    }
    // Probability of choosing neither coat nor sheen.
    float p_base() const {
        float p = 1;
        if constexpr (kCoat) p -= coat_.p;
        if constexpr (kSheen) p -= sheen_.p;
        return p;
    }
    // Whether diffuse light may leave on the other side.
    bool passes_diffuse() const {
        if constexpr (kThrough && (kGlossy || kGlass))
            return p_glass_ < 1 && opaque_->through_probability() > 0;
        return false;
    }
    void add_specular(const Vec3f& wi_local, BsdfEval& sum) const;
    void add_diffuse(float cos_i, bool through, BsdfEval& sum) const;
    void add_sheen(const Vec3f& wi_local, BsdfEval& sum) const;
    void add_coat(const Vec3f& wi, BsdfEval& sum) const;
    BsdfEval eval_lambert(const Vec3f& wi) const;
    BsdfEval eval_tilted(const Vec3f& wi) const;
    std::optional<BsdfSample> sample_diffuse(const Vec2f& u) const;
    std::optional<BsdfSample> sample_base_diffuse(float u_lobe, const Vec2f& u) const;
    std::optional<BsdfSample> sample_opaque_specular(const Vec2f& u) const;
    std::optional<BsdfSample> sample_glass(float u_lobe, const Vec2f& u) const;
    std::optional<BsdfSample> sample_coat(const Vec2f& u) const;
    std::optional<BsdfSample> smooth_sample(const Vec3f& wi, bool transmitted) const;
    std::optional<BsdfSample> delta_sample(const Vec3f& wi, const Rgb& share, float p) const;

    const Frame& specular_frame() const { return flat_ ? frame_ : bent_frame_; }
    // w, folded at the surface if it is not on the side where a reflection or a transmission
    // belongs.
    Vec3f on_side(const Vec3f& w, bool transmitted) const {
        if (flat_ || (dot(w, n_geometric_) < 0) == transmitted) return w;
        return fold_at_surface(w, n_geometric_);
    }
    Vec3f local_wo(const Frame& frame) const {
        Vec3f w = frame.to_local(wo_);
        w.z = glm::clamp(w.z, 0.0f, 1.0f);
        return w;
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
    // Made in place: they are too large to copy at every hit. Neither is there for a Lambert
    // surface; opaque_ is where p_glass_ < 1, glass_ where p_glass_ > 0.
    std::conditional_t<kGlossy || kGlass, Deferred<OpaqueLayer<kTier>>, Absent> opaque_;
    std::conditional_t<kGlass, Deferred<GlassLayer<kTier>>, Absent> glass_;
    [[no_unique_address]] std::conditional_t<kCoat, Coat, Absent> coat_;
    [[no_unique_address]] std::conditional_t<kSheen, Sheen, Absent> sheen_;
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
        if constexpr (kThrough) lambert_ = lambert_ && !(params.diffuse_transmission > 0);
        if constexpr (kCoat) lambert_ = lambert_ && !(params.clearcoat > 0 && outside);
        if constexpr (kSheen) lambert_ = lambert_ && is_black(params.sheen_color);
        if (lambert_) return;

        make_frames(params);
        float weight = 1;
        if constexpr (kCoat) {
            if (params.clearcoat > 0 && outside) weight = make_coat(params);
        }
        if constexpr (kSheen) {
            if (!is_black(params.sheen_color) && outside) weight *= make_sheen(params, weight);
        }
        make_base(params, outside, weight);
    }
}

template <EffectSet kTier>
void Bsdf<kTier>::make_frames(const ShadingParams& params) {
    if constexpr (kTier.has(Effect::anisotropy)) {
        if (params.anisotropy > 0) [[unlikely]]
            frame_ = Frame::from_normal_and_tangent(frame_.n, params.anisotropy_direction);
    }
    if (!flat_) {
        bent_frame_ = frame_;
        const Vec3f n = bend_shading_normal(frame_.n, n_geometric_, wo_);
        if (n != frame_.n) {
            bent_frame_ = Frame::from_normal(n);
            if constexpr (kTier.has(Effect::anisotropy)) {
                if (params.anisotropy > 0)
                    bent_frame_ = Frame::from_normal_and_tangent(n, frame_.t);
            }
        }
    }
    wo_local_ = local_wo(specular_frame());
}

// Returns the share of light that reaches what lies below.
template <EffectSet kTier>
float Bsdf<kTier>::make_coat(const ShadingParams& params) {
    if constexpr (kCoat) {
        Vec3f n = params.clearcoat_normal;
        if (!(dot(n, n_geometric_) > 0)) n = n_geometric_;
        coat_.flat = n == n_geometric_;
        if (!coat_.flat) n = bend_shading_normal(n, n_geometric_, wo_);
        const Frame& frame = coat_.frame.make(Frame::from_normal(n));
        const CoatLayer& layer =
            coat_.layer.make(params.clearcoat, params.clearcoat_alpha, local_wo(frame));
        coat_.p = layer.albedo();
        return 1 - layer.albedo();
    }
    return 1;
}

// The same for sheen.
template <EffectSet kTier>
float Bsdf<kTier>::make_sheen(const ShadingParams& params, float weight) {
    if constexpr (kSheen) {
        const SheenLayer& layer =
            sheen_.layer.make(params.sheen_color, params.sheen_alpha, weight, wo_local_);
        sheen_.p = layer.albedo();
        return layer.below();
    }
    return 1;
}

template <EffectSet kTier>
void Bsdf<kTier>::make_base(const ShadingParams& params, bool outside, float weight) {
    if constexpr (kGlossy || kGlass) {
        const float specular = kSpecular ? params.specular : 1.0f;
        const float metallic = kGlossy ? params.metallic : 0.0f;
        const float transmission = kGlass ? params.transmission * (1 - metallic) : 0.0f;
        const Rgb specular_color = kSpecular ? params.specular_color : Rgb(1);
        float albedo = 0;
        if constexpr (kGlass) {
            if (transmission > 0) {
                const bool thin = kThin && params.thin;
                glass_.make(params, thin, specular, specular_color, outside, transmission * weight,
                            wo_local_);
                p_glass_ = 1;
                albedo = glass_->albedo();
            }
        }
        if (!(transmission >= 1)) {  // also where it is no number
            const float share = 1 - transmission;
            opaque_.make(params, metallic / share, kGlossy ? specular : 0.0f, specular_color,
                         share * weight, wo_local_);
            if (!flat_) tilt_scale_ = opaque_->diffuse_tilt_scale(dot(frame_.n, n_geometric_));
            const float sum = albedo + opaque_->albedo();
            if constexpr (kGlass) p_glass_ = sum > 0 ? albedo / sum : 0.0f;
            albedo = sum;
        }
        share_probability(albedo);
    }
}

// Coat and sheen are chosen in proportion to what they return, which is in their p so far.
template <EffectSet kTier>
void Bsdf<kTier>::share_probability([[maybe_unused]] float base_albedo) {
    if constexpr (kCoat || kSheen) {
        float sum = base_albedo;
        if constexpr (kCoat) sum += coat_.p;
        if constexpr (kSheen) sum += sheen_.p;
        const bool shared = sum > base_albedo;
        if constexpr (kCoat) coat_.p = shared ? coat_.p / sum : 0.0f;
        if constexpr (kSheen) sheen_.p = shared ? sheen_.p / sum : 0.0f;
    }
}

template <EffectSet kTier>
bool Bsdf<kTier>::has_smooth_lobe() const {
    if (is_lambert()) return true;
    bool smooth = false;
    if constexpr (kGlossy || kGlass) smooth = p_glass_ < 1 && opaque_->has_smooth_lobe();
    if constexpr (kGlass) smooth = smooth || (p_glass_ > 0 && !glass_->is_delta());
    if constexpr (kCoat) smooth = smooth || (coat_.p > 0 && !coat_.layer->is_mirror());
    if constexpr (kSheen) smooth = smooth || sheen_.p > 0;
    return smooth;
}

template <EffectSet kTier>
BsdfEval Bsdf<kTier>::eval(const Vec3f& wi) const {
    if (is_lambert()) return eval_lambert(wi);
    if (!flat_) return eval_tilted(wi);
    const Vec3f wi_local = frame_.to_local(wi);
    BsdfEval sum;
    add_specular(wi_local, sum);
    if (wi_local.z > 0) {
        add_diffuse(wi_local.z, false, sum);
        add_sheen(wi_local, sum);
        add_coat(wi, sum);
    } else if (passes_diffuse() && wi_local.z < 0) [[unlikely]] {
        add_diffuse(-wi_local.z, true, sum);
    }
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
    const float cos_i = dot(wi, frame_.n);
    if (side > 0) {
        if (cos_i > 0) add_diffuse(cos_i, false, sum);
        add_sheen(direct, sum);
        add_sheen(folded, sum);
        add_coat(wi, sum);
    } else if (passes_diffuse() && cos_i < 0) [[unlikely]] {
        add_diffuse(-cos_i, true, sum);
    }
    return sum;
}

template <EffectSet kTier>
void Bsdf<kTier>::add_specular(const Vec3f& wi_local, BsdfEval& sum) const {
    if constexpr (kGlossy) {
        if (p_glass_ < 1 && wi_local.z > 0) {
            const LobeValue v = opaque_->eval_specular(wi_local);
            sum.f_cos += v.f_cos;
            sum.pdf += p_base() * (1 - p_glass_) * opaque_->specular_probability() * v.pdf;
        }
    }
    if constexpr (kGlass) {
        if (p_glass_ > 0 && wi_local.z != 0) {
            const LobeValue v = glass_->eval(wi_local);
            sum.f_cos += v.f_cos;
            sum.pdf += p_base() * p_glass_ * v.pdf;
        }
    }
}

template <EffectSet kTier>
void Bsdf<kTier>::add_diffuse(float cos_i, bool through, BsdfEval& sum) const {
    if constexpr (kGlossy || kGlass) {
        if (!(p_glass_ < 1)) return;
        const LobeValue v = opaque_->eval_diffuse(std::min(cos_i, 1.0f), through);
        sum.f_cos += flat_ ? v.f_cos : tilt_scale_ * v.f_cos;
        sum.pdf += p_base() * (1 - p_glass_) * (1 - opaque_->specular_probability()) * v.pdf;
    }
}

template <EffectSet kTier>
void Bsdf<kTier>::add_sheen([[maybe_unused]] const Vec3f& wi_local,
                            [[maybe_unused]] BsdfEval& sum) const {
    if constexpr (kSheen) {
        if (!(sheen_.p > 0) || !(wi_local.z > 0)) return;
        const LobeValue v = sheen_.layer->eval(wi_local);
        sum.f_cos += v.f_cos;
        sum.pdf += sheen_.p * v.pdf;
    }
}

// The coat's lobe, folded at the surface where its normal is tilted.
template <EffectSet kTier>
void Bsdf<kTier>::add_coat([[maybe_unused]] const Vec3f& wi, [[maybe_unused]] BsdfEval& sum) const {
    if constexpr (kCoat) {
        if (!(coat_.p > 0)) return;
        const auto add = [&](const Vec3f& w) {
            const Vec3f local = coat_.frame->to_local(w);
            if (!(local.z > 0)) return;
            const LobeValue v = coat_.layer->eval(local);
            sum.f_cos += v.f_cos;
            sum.pdf += coat_.p * v.pdf;
        };
        add(wi);
        if (!coat_.flat) add(fold_at_surface(wi, n_geometric_));
    }
}

}  // namespace talbot

#include "core/scattering/bsdf_sampling.h"
