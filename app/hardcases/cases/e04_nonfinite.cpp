// E04: samples that are not usable must neither spoil an image nor vanish unseen.
#include <array>
#include <functional>
#include <vector>

#include "app/hardcases/worst.h"
#include "core/integrate/replay.h"
#include "core/math/robust.h"
#include "oracles/scene_builder.h"

namespace talbot::hardcases::e04 {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr float kTooLarge = 0x1p60f;

// One fault in about a million samples, in each of four kinds and three channels. Returns how many
// faults the counters missed or added; `naive_bad` counts channels of a plain float film that are
// lost.
double miscounted(uint64_t samples, double& naive_bad) {
    constexpr std::array<float, 4> kFaults{kNaN, kInfinity, -1.0f, kTooLarge};
    Film film(4, 3);
    std::array<Rgb, 12> naive{};
    std::array<uint64_t, 4> injected{};
    NonFiniteCount counts;
    Draw draw(0xE04);
    for (uint64_t i = 0; i < samples; ++i) {
        const auto site = static_cast<uint32_t>(i % 12);
        Rgb value(0.5f);
        // The first sample of a site is always bad.
        if (i < 12 || draw.bits() % 1000000 == 0) {
            value[static_cast<int>(site % 3)] = kFaults[site / 3];
            ++injected[site / 3];
        }
        film.add(site % 4, site / 4, value, true, i / 12, counts);
        naive[site] += value;
    }
    const std::array<uint64_t, 4> counted{counts.nan, counts.inf, counts.negative, counts.overflow};
    double wrong = 0;
    for (std::size_t k = 0; k < 4; ++k) {
        wrong += std::abs(static_cast<double>(counted[k]) - static_cast<double>(injected[k]));
        naive_bad += static_cast<double>(injected[k]);  // its counters know nothing
    }
    if (!counts.has_first || counts.first_sample != 0) ++wrong;
    return wrong;
}

uint64_t unusable_pixels(const ImageRgba& image) {
    uint64_t count = 0;
    for (const Rgb& c : image.rgb) count += is_finite(c) && min_component(c) >= 0 ? 0 : 1;
    return count;
}

using Fault = std::function<void(SceneDesc&)>;

// Places where a scene can bring a bad number into a path. A file cannot: the loader refuses them.
std::vector<std::pair<std::string, Fault>> scene_faults() {
    const auto emission = [](const Rgb& c) {
        return [c](SceneDesc& d) { d.materials[1].emissive_factor = c; };
    };
    const auto base_colour = [](float c) {
        return [c](SceneDesc& d) { d.materials[2].base_color_factor.y = c; };
    };
    const auto sky = [](const Rgb& c) { return [c](SceneDesc& d) { d.environment.color = c; }; };
    return {
        {"infinite emission", emission(Rgb(kInfinity))},
        {"emission beyond the film", emission(Rgb(kTooLarge))},
        {"a channel of emission is NaN", emission(Rgb(1, kNaN, 1))},
        {"base colour is NaN", base_colour(kNaN)},
        {"base colour is infinite", base_colour(kInfinity)},
        {"environment is NaN", sky(Rgb(1, 1, kNaN))},
        {"environment is infinite", sky(Rgb(kInfinity, 1, 1))},
        {"environment is negative", sky(Rgb(1, -1, 1))},
        {"environment's intensity is infinite",
         [](SceneDesc& d) { d.environment.intensity = kInfinity; }},
        {"environment's intensity is NaN", [](SceneDesc& d) { d.environment.intensity = kNaN; }},
    };
}

SceneDesc stage() {
    SceneBuilder builder;
    Material lamp;
    lamp.emissive_factor = Rgb(1);
    lamp.double_sided = true;
    const uint32_t lamp_id = builder.material(lamp);
    Material floor;
    floor.metallic_factor = 0;
    floor.specular_factor = 0;
    floor.roughness_factor = 1;
    floor.double_sided = true;
    const uint32_t floor_id = builder.material(floor);
    builder.mesh(SceneBuilder::quad(Vec3f(-1, 0.5f, -1), Vec3f(1, 0, 0), Vec3f(0, 1, 0)), lamp_id);
    builder.mesh(SceneBuilder::quad(Vec3f(-2, 0, -2), Vec3f(4, 0, 0), Vec3f(0, 0, 4)), floor_id);
    builder.environment(Rgb(0.2f));
    return builder.desc();
}

CaseResult run(Effort effort) {
    CaseResult result;
    double naive_bad = 0;
    const double own = miscounted(effort == Effort::full ? 60000000 : 20000000, naive_bad);
    result.measures.push_back({"faults of 12 kinds and channels, 1 in 1e6, that counters miss",
                               naive_bad, own, 0, Gate::at_most, ""});

    WorkerPool pool(run_settings().threads);
    const Camera camera = camera_at(Vec3d(0, 1.2, 3), Vec3d(0, 0.3, 0), 0.9);
    constexpr uint32_t kSide = 24;
    constexpr uint64_t kPasses = 4;
    Worst unseen, spoiled, unrepeated;
    uint64_t naive_spoiled = 0;
    for (const auto& [name, fault] : scene_faults()) {
        SceneDesc desc = stage();
        fault(desc);
        const auto scene = Scene::build(std::move(desc), pool);
        NonFiniteCount counts;
        const Film film = render_film(scene, camera, {}, kSide, kSide, kPasses, pool, -1, &counts);
        const auto where = [n = name] { return n; };
        spoiled.add(static_cast<double>(unusable_pixels(film.image(false))), where);
        unseen.add(counts.total() > 0 ? 0 : 1, where);
        naive_spoiled += counts.total();
        if (!counts.has_first) continue;
        const RenderScene render_scene(scene);
        const CameraRays rays(camera, scene->origin(), kSide, kSide, scene->geometry().bounds);
        const std::string log = replay_sample(render_scene, rays, {}, counts.first_x,
                                              counts.first_y, counts.first_sample);
        const std::string last = log.substr(log.rfind("radiance"));
        const bool bad = last.find("nan") != std::string::npos ||
                         last.find("inf") != std::string::npos || last.find('-') < last.find('=') ||
                         counts.overflow > 0;
        unrepeated.add(bad ? 0 : 1, where);
    }
    result.measures.push_back({"pixels that a bad number in the scene spoils (10 places)",
                               static_cast<double>(naive_spoiled), spoiled.figure, 0, Gate::at_most,
                               spoiled.where});
    result.measures.push_back({"places whose bad numbers no counter shows", kNoControl,
                               unseen.figure, 0, Gate::at_most, unseen.where});
    result.measures.push_back({"first bad samples that a replay does not repeat", kNoControl,
                               unrepeated.figure, 0, Gate::at_most, unrepeated.where});
    return result;
}

const bool kAdded = add_case(
    {"E04", Priority::p0, "samples that are not usable are counted, not hidden",
     "every sample is added as it is",
     "zero in the image, counted by kind, the first kept for replay",
     "pbrt-v4#12, pbrt-v4#134, appleseed#1077, RayTracing/raytracing.github.io#1021", run});

}  // namespace
}  // namespace talbot::hardcases::e04
