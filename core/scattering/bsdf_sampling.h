// How a BSDF draws directions: the second half of bsdf.h, which includes it.
#pragma once

#include "core/scattering/bsdf.h"

namespace talbot {

template <EffectSet kTier>
std::optional<BsdfSample> Bsdf<kTier>::sample([[maybe_unused]] float u_lobe, const Vec2f& u) const {
    if (is_lambert()) return sample_diffuse(u);
    // What is left of u_lobe is stretched over the choices that remain.
    [[maybe_unused]] const auto rest = [&](float p) {
        u_lobe = std::min((u_lobe - p) / (1 - p), kOneMinusEpsilon);
    };
    if constexpr (kCoat) {
        if (u_lobe < coat_.p) return sample_coat(u);
        if (coat_.p > 0) rest(coat_.p);
    }
    if constexpr (kSheen) {
        if (sheen_.p > 0) {
            float p = sheen_.p;
            if constexpr (kCoat) p /= 1 - coat_.p;
            if (u_lobe < p) {
                const Vec3f wi = specular_frame().to_world(SheenLayer::sample(u));
                return smooth_sample(on_side(wi, false), false);
            }
            rest(p);
        }
    }
    if constexpr (kGlass) {
        if (u_lobe < p_glass_)
            return sample_glass(std::min(u_lobe / p_glass_, kOneMinusEpsilon), u);
        if (p_glass_ > 0) rest(p_glass_);
    }
    if constexpr (kGlossy || kGlass) {
        if (u_lobe < opaque_->specular_probability()) return sample_opaque_specular(u);
    }
    return sample_base_diffuse(u_lobe, u);
}

template <EffectSet kTier>
std::optional<BsdfSample> Bsdf<kTier>::sample_diffuse(const Vec2f& u) const {
    return smooth_sample(frame_.to_world(sample_cosine_hemisphere(u)), false);
}

// u_lobe at or above the probability of specular reflection.
template <EffectSet kTier>
std::optional<BsdfSample> Bsdf<kTier>::sample_base_diffuse([[maybe_unused]] float u_lobe,
                                                           const Vec2f& u) const {
    if constexpr (kThrough && (kGlossy || kGlass)) {
        const float diffuse = 1 - opaque_->specular_probability();
        const float through = opaque_->through_probability();
        if (through > 0 && u_lobe - opaque_->specular_probability() < through * diffuse) {
            Vec3f wi = sample_cosine_hemisphere(u);
            wi.z = -wi.z;
            return smooth_sample(frame_.to_world(wi), true);
        }
    }
    return sample_diffuse(u);
}

template <EffectSet kTier>
std::optional<BsdfSample> Bsdf<kTier>::sample_opaque_specular(const Vec2f& u) const {
    if constexpr (kGlossy || kGlass) {
        if (opaque_->is_mirror()) {
            const Vec3f wi(-wo_local_.x, -wo_local_.y, wo_local_.z);
            return delta_sample(on_side(specular_frame().to_world(wi), false),
                                opaque_->mirror_reflectance(),
                                p_base() * (1 - p_glass_) * opaque_->specular_probability());
        }
        const Vec3f wi = opaque_->sample_specular(u);
        if (wi.z > 0) return smooth_sample(on_side(specular_frame().to_world(wi), false), false);
    }
    return std::nullopt;
}

template <EffectSet kTier>
std::optional<BsdfSample> Bsdf<kTier>::sample_coat(const Vec2f& u) const {
    if constexpr (kCoat) {
        const Vec3f local = coat_.layer->sample(u);
        if (!(local.z > 0)) return std::nullopt;
        Vec3f wi = coat_.frame->to_world(local);
        if (!coat_.flat && dot(wi, n_geometric_) < 0) wi = fold_at_surface(wi, n_geometric_);
        if (coat_.layer->is_mirror())
            return delta_sample(wi, Rgb(coat_.layer->mirror_reflectance()), coat_.p);
        return smooth_sample(wi, false);
    }
    return std::nullopt;
}

template <EffectSet kTier>
std::optional<BsdfSample> Bsdf<kTier>::sample_glass(float u_lobe, const Vec2f& u) const {
    if constexpr (kGlass) {
        std::optional<BsdfSample> s;
        if (glass_->is_delta()) {
            const auto split = glass_->split(wo_local_.z);
            if (u_lobe < split.p_reflect) {
                const Vec3f wi(-wo_local_.x, -wo_local_.y, wo_local_.z);
                return delta_sample(on_side(specular_frame().to_world(wi), false),
                                    glass_->weight() * split.reflected,
                                    p_base() * p_glass_ * split.p_reflect);
            }
            const Vec3f wi =
                glass_->is_straight()
                    ? -wo_
                    : on_side(specular_frame().to_world(glass_->refracted(split.cos_t)), true);
            s = delta_sample(wi, glass_->weight() * glass_->transmitted_scale() * split.transmitted,
                             p_base() * p_glass_ * (1 - split.p_reflect));
            if (s) s->transmitted = true;
        } else {
            const Vec3f wi = glass_->sample(u_lobe, u);
            if (wi.z == 0) return s;
            const bool transmitted = wi.z < 0;
            s = smooth_sample(on_side(specular_frame().to_world(wi), transmitted), transmitted);
        }
        if (s && s->transmitted) s->eta = glass_->is_straight() ? 1.0f : glass_->eta();
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
