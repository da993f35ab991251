#include "app/bias_record.h"

#include <algorithm>
#include <cmath>

#include "app/accuracy_render.h"

namespace talbot {
namespace {

constexpr double kPixels = 4096;
constexpr uint64_t kSamples = 16;

// Both sides with the same random numbers, as they are at half of the samples and at all.
BiasFloor compare(const AccuracyScene& scene, const RenderSettings& settings,
                  const RenderSettings& unbiased, WorkerPool& pool) {
    MeasuredRender a(scene, settings, pool), b(scene, unbiased, pool);
    a.render_unobserved(kSamples / 2);
    b.render_unobserved(kSamples / 2);
    const Film a_half = a.film(), b_half = b.film();
    a.render_unobserved(kSamples);
    b.render_unobserved(kSamples);
    return measure_floor(a_half, a.film(), b_half, b.film());
}

}  // namespace

std::vector<BiasEntry> measure_bias(const SceneSetup& setup, WorkerPool& pool) {
    std::vector<BiasEntry> ledger;
    const RenderSettings defaults;
    const EffectReport effects = analyse_effects(*setup.scene, setup.camera);
    const EffectSet off = setup.settings.forced_off & effects.active;
    const bool is_shallow = setup.settings.max_depth < defaults.max_depth;
    if (!is_shallow && off == EffectSet{}) return ledger;
    AccuracyScene scene;
    scene.setup = setup;
    scene.render_scene = std::make_shared<const RenderScene>(setup.scene);
    scene.effects = effects;
    RenderSettings settings = setup.settings;
    const double scale =
        std::min(1.0, std::sqrt(kPixels / (static_cast<double>(settings.width) * settings.height)));
    settings.width = std::max(1u, static_cast<uint32_t>(std::lround(settings.width * scale)));
    settings.height = std::max(1u, static_cast<uint32_t>(std::lround(settings.height * scale)));
    if (is_shallow) {
        RenderSettings unbiased = settings;
        unbiased.max_depth = defaults.max_depth;
        ledger.push_back({"max-depth " + std::to_string(settings.max_depth),
                          compare(scene, settings, unbiased, pool)});
    }
    for (const EffectInfo& info : kEffects) {
        if (!off.has(info.effect)) continue;
        RenderSettings unbiased = settings;
        unbiased.forced_off.remove(info.effect);
        ledger.push_back({"effects -" + std::string(info.name),
                          compare(scene, settings, unbiased, pool)});
    }
    return ledger;
}

}  // namespace talbot
