// glTF's sheen: a layer of fibres above everything but the clear coat. Charlie distribution
// (charlie.h); what lies below is scaled by 1 - max(colour) E(wo), so that energy is conserved.
// Local frame, z along the shading normal. The scale looks at wo alone: the whole is not
// reciprocal, the lobe itself is.
#pragma once

#include "core/math/warp.h"
#include "core/scattering/charlie.h"
#include "core/scattering/extension_tables.h"
#include "core/scattering/shading_params.h"

namespace talbot {

class SheenLayer {
  public:
    SheenLayer() = default;
    // weight scales every value. wo has z >= 0.
    SheenLayer(const Rgb& color, float alpha, float weight, const Vec3f& wo)
        : wo_(wo), alpha_(std::clamp(alpha, kMinSheenAlpha, 1.0f)), shadowing_(alpha_) {
        wo_.z = std::max(wo.z, kMinSheenCosine);
        // The distribution gives back more than arrives at grazing when it is sharp: scaled then.
        const float single = sheen_albedo(wo_.z, alpha_);
        const float e = std::min(single, 1.0f);
        const Rgb kept = glm::min(color, Rgb(1));
        color_ = (single > 1 ? weight / single : weight) * kept;
        lambda_o_ = shadowing_.lambda(wo_.z);
        below_ = 1 - max_component(kept) * e;
        albedo_ = weight * mean_component(kept) * e;
    }

    // Share of light that reaches what lies below.
    float below() const { return below_; }
    // Albedo, mean of the channels, with the weight.
    float albedo() const { return albedo_; }

    LobeValue eval(const Vec3f& wi) const {
        if (!(wi.z > 0)) return {};
        const Vec3f h = wo_ + wi;
        const float h2 = dot(h, h);
        if (!(h2 > 0)) return {};
        const float sin2 = std::min((h.x * h.x + h.y * h.y) / h2, 1.0f);
        const float g = 1 / (1 + lambda_o_ + shadowing_.lambda(std::min(wi.z, 1.0f)));
        const float f_cos = charlie_d(sin2, alpha_) * g / (4 * wo_.z);
        return {f_cos * color_, pdf_uniform_hemisphere()};
    }
    static Vec3f sample(const Vec2f& u) { return sample_uniform_hemisphere(u); }

  private:
    Vec3f wo_{0, 0, 1};
    Rgb color_{0};
    float alpha_ = 1;
    CharlieShadowing<float> shadowing_;
    float lambda_o_ = 0;
    float below_ = 1;
    float albedo_ = 0;
};

}  // namespace talbot
