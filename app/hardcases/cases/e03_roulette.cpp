// E03: Russian roulette. In a closed box of emission 1 and albedo rho every point has L = 1 / (1 -
// rho), however long the paths.
#include <algorithm>
#include <vector>

#include "app/hardcases/worst.h"
#include "oracles/scene_builder.h"

namespace talbot::hardcases {
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

struct Estimate {
    double mean = 0;
    double error = 0;     // standard error of the mean, from pixels
    double variance = 0;  // of pixels
    double largest = 0;   // pixel
    uint64_t nonfinite = 0;
};

Estimate render(float rho, bool glass, bool roulette, uint64_t passes, WorkerPool& pool) {
    PathSettings settings;
    settings.max_depth = 1u << 16;
    settings.russian_roulette = roulette;
    settings.seed = run_settings().seed;
    NonFiniteCount counts;
    const Film film =
        render_film(furnace(rho, glass, pool), camera_at(Vec3d(0.3, 0.2, 0.9), Vec3d(0)), settings,
                    kSide, kSide, passes, pool, -1, &counts);
    Estimate e;
    e.nonfinite = counts.total();
    double square = 0;
    const auto n = static_cast<double>(film.pixels().size());
    for (const FilmPixel& pixel : film.pixels()) {
        const double value = pixel.sum[1].value() / static_cast<double>(pixel.samples);
        e.mean += value / n;
        square += value * value / n;
        e.largest = std::max(e.largest, value);
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
    for (int vertex = 0; vertex < 100000 && reach > 1e-12; ++vertex) {
        L += reach;
        throughput *= rho;
        reach *= rho * (vertex >= 3 ? std::max(throughput, 0.05) : 1.0);
    }
    return L;
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
            const uint64_t passes = full ? (rho > 0.99f ? 512 : 1024) : (rho < 0.95f ? 64 : 16);
            const Estimate e = render(rho, glass, true, passes, pool);
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
    // One sample a pixel: the spread of samples, with roulette and without.
    const Estimate on = render(0.9f, false, true, 1, pool);
    const Estimate off = render(0.9f, false, false, 1, pool);
    result.measures.push_back({"variance with roulette over variance without, albedo 0.9",
                               kNoControl, on.variance / off.variance, 3, Gate::at_most, ""});
    result.measures.push_back(
        {"largest sample over the mean", kNoControl, on.largest / on.mean, 1e6, Gate::at_most, ""});
    result.sweeps.push_back(sweep);
    return result;
}

const bool kAdded =
    add_case({"E03", Priority::p0, "Russian roulette over very long paths",
              "survival is not divided out", "throughput over survival, floor 0.05, no hard depth",
              "chunky-dev/chunky#1018, NJUCG/Moer#77, mitsuba3#1511", run});

}  // namespace
}  // namespace talbot::hardcases
