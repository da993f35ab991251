#include "core/session/prepared_view.h"

#include "core/integrate/tiers.h"
#include "core/scene/effects_off.h"

namespace talbot {
namespace {

// Texture coordinates are no effect, but a kernel must have them where anything that is placed
// asks.
EffectSet surface_needs(const Scene& scene) {
    std::vector<EffectSet> asked;
    for (const Material& material : scene.materials()) asked.push_back(material_effects(material));
    EffectSet needs;
    for (const SceneInstance& i : scene.geometry().instances) needs = needs | asked[i.material];
    for (const Sphere& s : scene.geometry().spheres) needs = needs | asked[s.material];
    return needs & EffectSet{EffectSet::bit(Effect::base_color_texture)};
}

std::shared_ptr<const TexturePyramids> pyramids_of(const PreparedView& view, WorkerPool& pool,
                                                   const PreparedView* previous) {
    if (view.texture_filter == TextureFiltering::none) return nullptr;
    if (previous && previous->pyramids && previous->reduced == view.reduced)
        return previous->pyramids;
    return make_texture_pyramids(*view.reduced, pool,
                                 previous ? previous->pyramids.get() : nullptr);
}

}  // namespace

PreparedView prepare_view(std::shared_ptr<const Scene> scene, const Camera& camera,
                          const RenderSettings& settings, WorkerPool& pool,
                          const PreparedView* previous) {
    PreparedView view;
    view.given = std::move(scene);
    view.forced_on = settings.forced_on;
    view.forced_off = settings.forced_off;
    view.sampling = light_sampling(settings);
    view.texture_filter = settings.texture_filter;
    view.camera = camera_without(camera, view.forced_off);
    if (previous && !previous->scene) previous = nullptr;
    const bool same_sets = previous && previous->forced_on == view.forced_on &&
                           previous->forced_off == view.forced_off;
    if (same_sets && previous->given == view.given) {
        view.reduced = previous->reduced;
        view.pyramids = pyramids_of(view, pool, previous);
        view.scene = previous->scene;
        if (!(previous->sampling == view.sampling) || previous->pyramids != view.pyramids)
            view.scene = std::make_shared<const RenderScene>(
                view.reduced, previous->scene.get(), view.forced_on, view.sampling, view.pyramids);
    } else {
        std::shared_ptr<const SceneGeometry> geometry = view.given->shared_geometry();
        if (same_sets && previous->given->shared_geometry() == geometry) {
            geometry = previous->reduced->shared_geometry();
        } else {
            geometry = geometry_without(std::move(geometry), view.forced_off, pool);
        }
        view.reduced = scene_without(view.given, view.forced_off, std::move(geometry));
        view.pyramids = pyramids_of(view, pool, previous);
        view.scene = std::make_shared<const RenderScene>(
            view.reduced, previous ? previous->scene.get() : nullptr, view.forced_on, view.sampling,
            view.pyramids);
    }
    view.effects = analyse_effects(*view.given, camera);
    const EffectSet needed = view.forced_off == EffectSet{}
                                 ? view.effects.active
                                 : analyse_effects(*view.reduced, view.camera).active;
    const EffectSet cones = view.pyramids && !view.pyramids->is_empty() ? kRayCones : EffectSet{};
    view.tier = smallest_tier(needed | view.forced_on | surface_needs(view.scene->scene()) | cones);
    return view;
}

}  // namespace talbot
