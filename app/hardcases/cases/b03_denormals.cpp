// B03: denormal numbers. They make loops many times slower, and no result may depend on how they
// are treated.
#include <algorithm>
#include <chrono>
#include <thread>

#include "app/hardcases/worst.h"
#include "core/accuracy/metrics.h"
#include "core/base/float_probe.h"
#include "oracles/scene_builder.h"

namespace talbot::hardcases::b03 {
namespace {

// Seconds of products that decay from `start`, by the CPU's own clock; the factor keeps denormals
// denormal.
double decay_seconds(float start) {
    volatile float sink = 0;
    double best = std::numeric_limits<double>::infinity();
    for (int repeat = 0; repeat < 7; ++repeat) {
        const auto begin = std::chrono::steady_clock::now();
        float x = start;
        float y = 0.5f * start;
        for (int i = 0; i < 100000; ++i) {
            x = x * 0.9999f + y * 0.0001f;
            y = y * 0.9999f + x * 0.0001f;
        }
        sink = sink + x + y;
        best = std::min(
            best, std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
    }
    return best;
}

double slowdown() {
    const double normal = decay_seconds(1.0f);
    return decay_seconds(1e-40f) / normal;
}

std::shared_ptr<const Scene> fog(float tau, WorkerPool& pool) {
    SceneBuilder builder;
    Material medium;
    medium.metallic_factor = 0;
    medium.roughness_factor = 0;
    medium.transmission_factor = 1;
    medium.thickness_factor = 1;
    medium.ior = 1;
    // tau in red, less in the others.
    medium.attenuation_distance = 1 / tau;
    medium.attenuation_color = Rgb(std::exp(-1.0f), std::exp(-0.5f), std::exp(-0.01f));
    builder.mesh(SceneBuilder::box(Vec3f(-0.5f), Vec3f(0.5f)), builder.material(medium));
    builder.environment(Rgb(1));
    return builder.build(pool);
}

// The picture by a thread that keeps denormals.
Film render_with_denormals(const std::shared_ptr<const Scene>& scene, const Camera& camera,
                           uint32_t side, uint64_t passes) {
    const RenderScene render_scene(scene);
    const CameraRays rays(camera, scene->origin(), side, side, scene->geometry().bounds);
    const PathSettings settings;
    Film film(side, side);
    TileCounts counts;
    const TileJob job{&render_scene, &rays, &settings, &film, 0, passes, 0, 0, side, side};
    std::thread([&] {
        tile_kernel(smallest_tier(analyse_effects(*scene, camera).active))(job, {}, counts);
    }).join();
    return film;
}

CaseResult run(Effort effort) {
    const uint32_t side = effort == Effort::full ? 64 : 16;
    WorkerPool pool(run_settings().threads);
    double kept = 0;
    double own = 0;
    std::thread([&] { kept = slowdown(); }).join();
    pool.parallel_for(1, [&](uint64_t, unsigned) { own = slowdown(); });
    // A worker that does not flush would be found here.
    std::vector<double> unflushed(pool.size(), 0);
    pool.parallel_for(uint64_t{pool.size()} * 16, [&](uint64_t, unsigned worker) {
        const FloatProbe probe = probe_floats();
        unflushed[worker] = probe.flushes_results && probe.flushes_operands ? 0 : 1;
    });
    Worst difference;
    NonFiniteCount counts;
    const Camera camera = camera_at(Vec3d(0.9, 0.7, 2), Vec3d(0), 0.6);
    for (const float tau : {1.0f, 80.0f, 95.0f, 300.0f}) {
        const auto scene = fog(tau, pool);
        const Film flushed = render_film(scene, camera, {}, side, side, 4, pool, -1, &counts);
        const Film denormal = render_with_denormals(scene, camera, side, 4);
        difference.add(compare_images(flushed.image(false), denormal.image(false), 0).relmse,
                       [&] { return "fog of optical depth " + std::to_string(tau); });
    }
    CaseResult result;
    result.measures.push_back({"time of a loop over denormals over one over usual numbers", kept,
                               own, 1.1, Gate::at_most, ""});
    double count = 0;
    for (const double u : unflushed) count += u;
    result.measures.push_back(
        {"workers that do not flush", kNoControl, count, 0, Gate::at_most, ""});
    result.measures.push_back({"relMSE of fog with and without flushing", kNoControl,
                               difference.figure, 1e-12, Gate::at_most, difference.where});
    result.nonfinite = counts.total();
    return result;
}

const bool kAdded = add_case({"B03", Priority::p1, "denormals cost nothing and change nothing",
                              "threads in the default mode", "workers flush them from their start",
                              "Embree's manual recommends the mode", run});

}  // namespace
}  // namespace talbot::hardcases::b03
