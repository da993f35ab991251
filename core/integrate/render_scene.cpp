#include "core/integrate/render_scene.h"

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

}  // namespace

RenderScene::RenderScene(std::shared_ptr<const Scene> scene, const RenderScene* previous)
    : scene_(std::move(scene)), lights_(*scene_, previous ? &previous->lights_ : nullptr) {
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
