#include "core/integrate/render_scene.h"

#include <algorithm>

#include "core/integrate/tiers.h"
#include "core/scene/effects_fold.h"

namespace talbot {
namespace {

uint8_t side_flag(const Material& material) {
    // The boundary of a volume has no back: both of its sides are seen.
    return !material.double_sided && !material.is_volume() ? kCoverageSingleSided : 0;
}

bool emits_alike(const Material& a, const Material& b) {
    if (!a.is_emissive() && !b.is_emissive()) return true;
    return a.emissive_factor == b.emissive_factor && a.emissive_strength == b.emissive_strength &&
           a.emissive_texture == b.emissive_texture && a.double_sided == b.double_sided &&
           a.unlit == b.unlit;
}

// Whether the light table of one scene serves the other: same shapes, same emission.
bool emits_alike(const Scene& a, const Scene& b) {
    return &a.geometry() == &b.geometry() && a.environment() == b.environment() &&
           a.punctual_lights() == b.punctual_lights() &&
           std::equal(a.materials().begin(), a.materials().end(), b.materials().begin(),
                      b.materials().end(),
                      [](const Material& x, const Material& y) { return emits_alike(x, y); });
}

std::shared_ptr<const LightTable> make_lights(const Scene& scene, const RenderScene* previous,
                                              const LightSampling& sampling) {
    if (previous && previous->lights().sampling() == sampling &&
        emits_alike(scene, previous->scene()))
        return previous->shared_lights();
    return std::make_shared<const LightTable>(scene, previous ? &previous->lights() : nullptr,
                                              sampling);
}

}  // namespace

RenderScene::RenderScene(std::shared_ptr<const Scene> scene, const RenderScene* previous,
                         EffectSet forced_on, const LightSampling& sampling,
                         std::shared_ptr<const TexturePyramids> pyramids)
    : given_(std::move(scene)),
      scene_(fold_scene(given_, forced_on)),
      lights_(make_lights(*scene_, previous, sampling)),
      pyramids_(std::move(pyramids)) {
    const SceneGeometry& geometry = scene_->geometry();
    const std::vector<Material>& materials = scene_->materials();
    const bool exact = !forced_on.has(Effect::alpha_mask) && !forced_on.has(Effect::alpha_blend);
    std::vector<CoverageLimits> limits;
    std::vector<EffectSet> asked;
    for (const Material& material : materials) {
        limits.push_back(coverage_limits(material));
        asked.push_back(material_effects(material) | forced_on);
        any_emissive_ = any_emissive_ || material.is_emissive();
    }
    const auto tier_bits = [](EffectSet effects) {
        return static_cast<uint8_t>(smallest_surface_tier(effects) << kTierShift);
    };
    for (const SceneInstance& instance : geometry.instances) {
        const Material& material = materials[instance.material];
        const Mesh& mesh = geometry.meshes[instance.mesh];
        const MeshAlpha* alpha = scene_->mesh_alpha(instance.mesh);
        uint8_t flags = side_flag(material);
        if (asks_alpha(*scene_, material, &mesh, alpha, exact)) flags |= kCoverageAlpha;
        AlphaLookup lookup;
        if (exact && alpha && alpha->slot == material.base_color_texture && mesh.colors.empty())
            lookup = {alpha->triangles.data(), limits[instance.material]};
        EffectSet effects = asked[instance.material];
        if (!mesh.colors.empty()) effects.add(Effect::vertex_color);
        instance_bits_.push_back(flags | tier_bits(effects));
        instance_alpha_.push_back(lookup);
        any_coverage_ |= flags;
    }
    for (const Sphere& sphere : geometry.spheres) {
        const Material& material = materials[sphere.material];
        uint8_t flags = side_flag(material);
        if (asks_alpha(*scene_, material, nullptr, nullptr, exact)) flags |= kCoverageAlpha;
        sphere_bits_.push_back(flags | tier_bits(asked[sphere.material]));
        any_coverage_ |= flags;
    }
}

}  // namespace talbot
