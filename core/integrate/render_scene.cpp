#include "core/integrate/render_scene.h"

#include <algorithm>

namespace talbot {
namespace {

uint8_t flags_of(const Material& material) {
    uint8_t flags = 0;
    const bool can_be_clear =
        material.base_color_texture.used() || material.base_color_factor.w < 1;
    if (material.alpha_mode != AlphaMode::opaque && can_be_clear) flags |= kCoverageAlpha;
    // The boundary of a volume has no back: both of its sides are seen.
    if (!material.double_sided && !material.is_volume()) flags |= kCoverageSingleSided;
    return flags;
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

std::shared_ptr<const LightTable> make_lights(const Scene& scene, const RenderScene* previous) {
    if (!previous) return std::make_shared<const LightTable>(scene);
    if (emits_alike(scene, previous->scene())) return previous->shared_lights();
    return std::make_shared<const LightTable>(scene, &previous->lights());
}

}  // namespace

RenderScene::RenderScene(std::shared_ptr<const Scene> scene, const RenderScene* previous)
    : scene_(std::move(scene)), lights_(make_lights(*scene_, previous)) {
    const SceneGeometry& geometry = scene_->geometry();
    for (const SceneInstance& instance : geometry.instances) {
        instance_coverage_.push_back(flags_of(scene_->materials()[instance.material]));
        any_coverage_ |= instance_coverage_.back();
    }
    for (const Sphere& sphere : geometry.spheres) {
        sphere_coverage_.push_back(flags_of(scene_->materials()[sphere.material]));
        any_coverage_ |= sphere_coverage_.back();
    }
}

}  // namespace talbot
