// E03: Russian roulette. In a closed box of emission 1 and albedo rho every point has L = 1 / (1 -
// rho), however long the paths.
#include <algorithm>
#include <vector>

#include "app/hardcases/worst.h"
#include "core/integrate/roulette.h"
#include "oracles/scene_builder.h"

namespace talbot::hardcases::e03 {
namespace {

constexpr uint32_t kSide = 16;

std::shared_ptr<const Scene> furnace(float rho, bool glass, WorkerPool& pool) {
    SceneBuilder builder;
    Material wall = SceneBuilder::diffuse(rho);
    wall.emissive_factor = Rgb(1);
    builder.mesh(SceneBuilder::box(Vec3f(-1), Vec3f(1)), builder.material(wall));
    if (glass) {
        Material clear;
        clear.metallic_factor = 0;
        clear.roughness_factor = 0;
        clear.transmission_factor = 1;
        clear.thickness_factor = 1;
        builder.sphere(Vec3d(0.1, 0, -0.3), 0.4, builder.material(clear));
    }
    return builder.build(pool);
}

// A closed room of albedo 0.8 with one lamp: paths have a spread of their own. In the furnace all
// paths without roulette are worth the same, so a ratio of variances has nothing below the line.
std::shared_ptr<const Scene> room(WorkerPool& pool) {
    SceneBuilder builder;
    Material lamp = SceneBuilder::diffuse(0);
    lamp.emissive_factor = Rgb(10);
    builder.mesh(SceneBuilder::box(Vec3f(-1), Vec3f(1)),
                 builder.material(SceneBuilder::diffuse(0.8f)));
    builder.mesh(
        SceneBuilder::quad(Vec3f(-0.3f, 0.9f, -0.3f), Vec3f(0.6f, 0, 0), Vec3f(0, 0, 0.6f)),
        builder.material(lamp));
    return builder.build(pool);
}

struct Estimate {
    std::vector<double> pixels;
    double mean = 0;
    double error = 0;     // standard error of the mean, from pixels
    double variance = 0;  // of pixels
    double largest = 0;   // pixel
    uint64_t nonfinite = 0;
};

Estimate render(const std::shared_ptr<const Scene>& scene, bool roulette, uint64_t passes,
                WorkerPool& pool, uint64_t seed = 0) {
    PathSettings settings;
    settings.max_depth = roulette ? 1u << 16 : 128;  // 0.8^128 is nothing
    settings.russian_roulette = roulette;
    settings.seed = run_settings().seed + seed;
    settings.sampler = SamplerKind::independent;
    NonFiniteCount counts;
    const Film film = render_film(scene, camera_at(Vec3d(0.3, 0.2, 0.9), Vec3d(0)), settings, kSide,
                                  kSide, passes, pool, -1, &counts);
    Estimate e;
    e.nonfinite = counts.total();
    double square = 0;
    const auto n = static_cast<double>(film.pixels().size());
    for (const FilmPixel& pixel : film.pixels()) {
        const double value = pixel.sum[1].value() / static_cast<double>(pixel.samples);
        e.mean += value / n;
        square += value * value / n;
        e.largest = std::max(e.largest, value);
        e.pixels.push_back(value);
    }
    e.variance = std::max(0.0, square - e.mean * e.mean) * n / (n - 1);
    e.error = std::sqrt(e.variance / n);
    return e;
}

// A walk that ends by roulette without dividing by the chance to survive.
double undivided(double rho) {
    double L = 0;
    double reach = 1;  // chance to get here times throughput
    double throughput = 1;
    for (uint32_t vertex = 1; vertex <= 100000 && reach > 1e-12; ++vertex) {
        L += reach;
        throughput *= rho;
        reach *= rho;
        if (vertex >= kRouletteStart)
            reach *= static_cast<double>(roulette_survival(static_cast<float>(throughput)));
    }
    return L;
}

uint64_t full_passes(float rho) {
    if (rho > 0.99f) return 16;
    if (rho > 0.9f) return 128;
    return rho > 0.5f ? 1024 : 4096;
}

CaseResult run(Effort effort) {
    WorkerPool pool(run_settings().threads);
    const bool full = effort == Effort::full;
    std::vector<float> albedos{0.5f, 0.9f, 0.97f};
    if (full) albedos = {0.5f, 0.9f, 0.99f, 0.999f};
    CaseResult result;
    Worst naive, own, z;
    Sweep sweep{"1 - albedo", "relative error of L", true, 0.002, {}};
    for (const float rho : albedos) {
        const double exact = 1 / (1 - static_cast<double>(rho));
        const double e_naive = std::abs(undivided(static_cast<double>(rho)) / exact - 1);
        SweepPoint point{1 / exact, e_naive, 0};
        for (const bool glass : {false, true}) {
            // Paths are 1 / (1 - rho) vertices long and their worth spreads by its mean: 4096,
            // 1024, 128 and 16 passes of 256 pixels know L to 0.1, 0.2, 0.6 and 1.6 %.
            const uint64_t passes = full ? full_passes(rho) : (rho < 0.95f ? 64 : 16);
            const Estimate e = render(furnace(rho, glass, pool), true, passes, pool);
            result.nonfinite += e.nonfinite;
            // What four standard errors do not explain.
            const double off = std::abs(e.mean - exact);
            const double beyond = std::max(0.0, off - 4 * e.error) / exact;
            const auto where = [&] {
                return "albedo " + std::to_string(rho) + (glass ? " with a glass sphere" : "");
            };
            naive.add(e_naive, where);
            own.add(beyond, where);
            z.add(off / e.error, where);
            point.own = std::max(point.own, off / exact);
        }
        sweep.points.push_back(point);
    }
    result.measures.push_back({"relative error of L = 1 / (1 - albedo) beyond 4 standard errors",
                               naive.figure, own.figure, 0.002, Gate::at_most, own.where});
    result.measures.push_back(
        {"deviation of L in standard errors", kNoControl, z.figure, 4, Gate::at_most, z.where});
    // Variance from two renders of other seeds, with roulette and without.
    const auto scene = room(pool);
    const auto noise = [&](bool roulette) {
        const uint64_t passes = full ? 256 : 64;
        const Estimate a = render(scene, roulette, passes, pool, 1);
        const Estimate b = render(scene, roulette, passes, pool, 2);
        double sum = 0;
        for (std::size_t i = 0; i < a.pixels.size(); ++i)
            sum += (a.pixels[i] - b.pixels[i]) * (a.pixels[i] - b.pixels[i]);
        return sum;
    };
    result.measures.push_back({"variance with roulette over variance without, a room of albedo 0.8",
                               kNoControl, noise(true) / noise(false), 3, Gate::at_most, ""});
    const Estimate single = render(scene, true, 1, pool);
    result.measures.push_back({"largest sample over the mean", kNoControl,
                               single.largest / single.mean, 1e6, Gate::at_most, ""});
    result.sweeps.push_back(sweep);
    return result;
}

const bool kAdded =
    add_case({"E03", Priority::p0, "Russian roulette over very long paths",
              "survival is not divided out", "throughput over survival, floor 0.05, no hard depth",
              "chunky-dev/chunky#1018, NJUCG/Moer#77, mitsuba3#1511", run});

}  // namespace
}  // namespace talbot::hardcases::e03
