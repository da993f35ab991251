// E08: the same bytes for any number of threads, any tiles, and after a pause.
#include <algorithm>
#include <vector>

#include "app/hardcases/worst.h"
#include "core/session/render_pass.h"
#include "oracles/scene_builder.h"

namespace talbot::hardcases::e08 {
namespace {

constexpr uint32_t kWidth = 48;
constexpr uint32_t kHeight = 32;

std::shared_ptr<const Scene> stage(WorkerPool& pool) {
    SceneBuilder builder;
    Material lamp;
    lamp.emissive_factor = Rgb(8, 7, 5);
    lamp.double_sided = true;
    Material gold;
    gold.base_color_factor = Vec4f(1, 0.7f, 0.3f, 1);
    gold.roughness_factor = 0.3f;
    Material glass;
    glass.metallic_factor = 0;
    glass.roughness_factor = 0;
    glass.transmission_factor = 1;
    glass.thickness_factor = 1;
    const uint32_t lamp_id = builder.material(lamp);
    const uint32_t floor_id = builder.material(SceneBuilder::diffuse(0.7f));
    builder.mesh(SceneBuilder::quad(Vec3f(-1, 2, -1), Vec3f(2, 0, 0), Vec3f(0, 0, 1)), lamp_id);
    builder.mesh(SceneBuilder::quad(Vec3f(-4, 0, -4), Vec3f(8, 0, 0), Vec3f(0, 0, 8)), floor_id);
    builder.sphere(Vec3d(-0.6, 0.5, 0), 0.5, builder.material(gold));
    builder.sphere(Vec3d(0.6, 0.5, 0.2), 0.5, builder.material(glass));
    builder.environment(Rgb(0.3f, 0.4f, 0.6f));
    return builder.build(pool);
}

// Samples [first, first + passes) of every pixel, a pass at a time as a session makes them.
Film render(const RenderScene& scene, const Camera& camera, unsigned threads, uint32_t tile,
            uint64_t first, uint64_t passes) {
    WorkerPool pool(threads);
    RenderSettings settings;
    settings.width = kWidth;
    settings.height = kHeight;
    settings.tile_size = tile;
    settings.first_sample = first;
    settings.seed = run_settings().seed;
    const std::size_t tier = smallest_tier(analyse_effects(scene.scene(), camera).active);
    Film film(kWidth, kHeight);
    TileCounts counts;
    for (uint64_t pass = 1; pass <= passes; ++pass) {
        std::stop_source stop;
        render_pass({scene, camera, settings, tier, pass}, film, pool, stop, {}, counts);
    }
    return film;
}

constexpr int kRenders = 11;

// Sums in float of the same samples in as many other orders: how many give other bytes.
double float_orders_that_differ(const RenderScene& scene, const Camera& camera, uint64_t passes) {
    std::vector<ImageRgba> samples;
    for (uint64_t i = 0; i < passes; ++i)
        samples.push_back(render(scene, camera, 1, 32, i, 1).image(false));
    const auto sum = [&] {
        std::vector<Rgb> total(samples[0].rgb.size(), Rgb(0));
        for (const ImageRgba& sample : samples) {
            for (std::size_t p = 0; p < total.size(); ++p) total[p] += sample.rgb[p];
        }
        return total;
    };
    const std::vector<Rgb> first = sum();
    double count = 0;
    Draw draw(0xE08);
    for (int i = 0; i < kRenders; ++i) {
        for (std::size_t k = samples.size() - 1; k > 0; --k)
            std::swap(samples[k], samples[draw.bits() % (k + 1)]);
        count += sum() == first ? 0 : 1;
    }
    return count;
}

CaseResult run(Effort effort) {
    const uint64_t passes = effort == Effort::full ? 64 : 8;
    WorkerPool pool(run_settings().threads);
    const RenderScene scene(stage(pool));
    const Camera camera = camera_at(Vec3d(0, 1.4, 4), Vec3d(0, 0.6, 0), 0.8);
    const std::string first = render(scene, camera, 1, 32, 0, passes).hash();
    Worst own;
    double differing = 0;
    const auto look = [&](const Film& film, const std::string& what) {
        differing += film.hash() == first ? 0 : 1;
        own.add(differing, [&] { return what; });
    };
    for (const unsigned threads : {2u, 3u, 7u, 16u})
        look(render(scene, camera, threads, 32, 0, passes), std::to_string(threads) + " threads");
    for (const uint32_t tile : {1u, 5u, 16u, 256u})
        look(render(scene, camera, 3, tile, 0, passes), "tiles of " + std::to_string(tile));
    for (const uint64_t cut : {uint64_t{1}, passes / 2, passes - 1}) {
        Film film = render(scene, camera, 2, 32, 0, cut);
        film.merge(render(scene, camera, 2, 32, cut, passes - cut));
        look(film, "two parts, cut after " + std::to_string(cut));
    }
    CaseResult result;
    result.measures.push_back(
        {"renders of 11 with other bytes: 1 to 16 threads, tiles of 1 to 256, merged parts",
         float_orders_that_differ(scene, camera, passes), differing, 0, Gate::at_most, own.where});
    return result;
}

const bool kAdded =
    add_case({"E08", Priority::p0, "same bytes for any threads, tiles and parts",
              "sums in float, added in the order of arrival",
              "samples are functions of pixel and index, sums are exact",
              "mitsuba-renderer/mitsuba#184, LuxCore#255, POV-Ray/povray#353", run});

}  // namespace
}  // namespace talbot::hardcases::e08
