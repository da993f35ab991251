// What the kernels read: the scene with its light table, its effects and per-pixel-independent
// settings. Immutable.
#pragma once

#include <memory>
#include <vector>

#include "core/integrate/sampling_kinds.h"
#include "core/lights/light_table.h"
#include "core/scene/effects.h"
#include "core/scene/scene.h"
#include "core/scene/texture_pyramid.h"

namespace talbot {

// Settings of the estimator that change pixels.
struct PathSettings {
    uint32_t max_depth = 64;
    SamplerKind sampler = SamplerKind::sobol;
    FilterKind filter = FilterKind::box;
    bool russian_roulette = true;
    bool next_event_estimation = true;
    bool transparent_background = false;
    uint64_t seed = 0;
};

// How hits on an instance or sphere are treated by the coverage filter.
enum CoverageFlags : uint8_t { kCoverageAlpha = 1, kCoverageSingleSided = 2 };

// What a triangle's texels say about its alpha.
enum class TriangleCoverage : uint8_t { opaque, clear, mixed };

class RenderScene {
  public:
    // Folds what cannot be seen, except what belongs to the effects of `forced_on`, and leaves out
    // questions with known answers; the image is the same, byte for byte. Reuses what `previous`
    // shares with the new scene. `pyramids`, where there are any, are for kernels with ray cones.
    RenderScene(std::shared_ptr<const Scene> scene, const RenderScene* previous = nullptr,
                EffectSet forced_on = {}, const LightSampling& sampling = {},
                std::shared_ptr<const TexturePyramids> pyramids = nullptr);

    const Scene& scene() const { return *scene_; }
    // As it was given.
    const std::shared_ptr<const Scene>& shared_scene() const { return given_; }
    const LightTable& lights() const { return *lights_; }
    const std::shared_ptr<const LightTable>& shared_lights() const { return lights_; }

    // Null where textures are not filtered.
    const TexturePyramids* pyramids() const { return pyramids_.get(); }

    uint8_t coverage_flags(PrimitiveId id) const { return surface_bits(id) & kCoverageBits; }
    // Index into kSurfaceTiers: the shading that a surface asks for.
    uint8_t surface_tier(PrimitiveId id) const { return surface_bits(id) >> kTierShift; }
    TriangleCoverage triangle_coverage(PrimitiveId id) const {
        if (id.instance == kSphereInstance) return TriangleCoverage::mixed;
        const AlphaLookup& lookup = instance_alpha_[id.instance];
        if (!lookup.triangles) return TriangleCoverage::mixed;
        const AlphaRange range = lookup.triangles[id.primitive];
        if (range.least >= lookup.limits.opaque_from) return TriangleCoverage::opaque;
        return range.most < lookup.limits.clear_below ? TriangleCoverage::clear
                                                      : TriangleCoverage::mixed;
    }
    // Flags that occur anywhere.
    uint8_t any_coverage() const { return any_coverage_; }
    // Whether any surface shines.
    bool any_emissive() const { return any_emissive_; }

  private:
    // Coverage flags and, above them, the surface tier.
    static constexpr uint8_t kTierShift = 2;
    static constexpr uint8_t kCoverageBits = (1 << kTierShift) - 1;
    uint8_t surface_bits(PrimitiveId id) const {
        return id.instance == kSphereInstance ? sphere_bits_[id.primitive]
                                              : instance_bits_[id.instance];
    }

    struct AlphaLookup {
        const AlphaRange* triangles = nullptr;  // of the scene's tables; null where all are mixed
        CoverageLimits limits;
    };

    std::shared_ptr<const Scene> given_;
    std::shared_ptr<const Scene> scene_;
    std::shared_ptr<const LightTable> lights_;
    std::vector<uint8_t> instance_bits_;
    std::vector<uint8_t> sphere_bits_;
    std::vector<AlphaLookup> instance_alpha_;
    uint8_t any_coverage_ = 0;
    std::shared_ptr<const TexturePyramids> pyramids_;
    bool any_emissive_ = false;
};

}  // namespace talbot
