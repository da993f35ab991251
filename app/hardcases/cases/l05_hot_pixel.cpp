// L05: an environment with one hot pixel. Float prefix sums stall behind it, and the sky that
// follows is never sampled.
#include <array>
#include <numbers>

#include "app/hardcases/cases/light_setup.h"
#include "core/lights/environment_light.h"
#include "oracles/stats/random.h"
#include "oracles/stats/ztest.h"

namespace talbot::hardcases::l05 {
namespace {

using Real = long double;

struct Map {
    uint32_t width, height;
    uint32_t column, row;  // of the hot pixel
    double heat;           // over a sky of 1
    const char* place;

    std::shared_ptr<EnvironmentImage> image() const {
        auto image = std::make_shared<EnvironmentImage>();
        image->width = width;
        image->height = height;
        image->texels.assign(std::size_t{width} * height, Rgb(1));
        image->texels[std::size_t{row} * width + column] = Rgb(static_cast<float>(heat));
        return image;
    }
};

// Irradiance on a floor facing up: the even sky's pi, and the hot pixel's tent of bilinear weights
// over the nine cells that it touches; rows beyond the pole repeat the first.
Real irradiance(const Map& m) {
    constexpr int kSteps = 24;
    const Real pi = std::numbers::pi_v<Real>;
    Real tent = 0;
    for (int dy = -1; dy <= 1; ++dy) {
        const auto row = static_cast<int64_t>(m.row) + dy;
        if (row < 0 || row >= m.height) continue;
        Real line = 0;
        for (int i = 0; i < kSteps; ++i) {
            const Real y = static_cast<Real>(row) + (i + Real(0.5)) / kSteps;
            Real wy = std::max<Real>(0, 1 - std::abs(y - (static_cast<Real>(m.row) + Real(0.5))));
            if (m.row == 0 && y < Real(0.5)) wy = 1;
            if (m.row + 1 == m.height && y > static_cast<Real>(m.height) - Real(0.5)) wy = 1;
            const Real theta = pi * y / m.height;
            line += wy * std::max<Real>(0, std::cos(theta)) * std::sin(theta);
        }
        // A tent one texel wide has an area of one texel.
        tent += line / kSteps * (pi / m.height) * (2 * pi / m.width);
    }
    return pi + (static_cast<Real>(static_cast<float>(m.heat)) - 1) * tent;
}

// The control: one float prefix sum over all cells, weighted by the sine at the row's centre. What
// it cannot pick is lost: returns the irradiance that is left, and how many cells have no width.
Real naive_irradiance(const Map& m, double& unreachable) {
    const auto image = m.image();
    float sum = 0;
    Real lost = 0;
    for (uint32_t y = 0; y < m.height; ++y) {
        const float sine =
            std::sin(kPi * (static_cast<float>(y) + 0.5f) / static_cast<float>(m.height));
        const Real theta = std::numbers::pi_v<Real> * (y + Real(0.5)) / m.height;
        const Real cell = 2 * std::numbers::pi_v<Real> * std::numbers::pi_v<Real> /
                          (static_cast<Real>(m.width) * m.height) * std::sin(theta) *
                          std::max<Real>(0, std::cos(theta));
        for (uint32_t x = 0; x < m.width; ++x) {
            const float radiance = image->texels[std::size_t{y} * m.width + x].y;
            const float before = sum;
            sum += radiance * sine;
            if (sum != before) continue;
            ++unreachable;
            lost += cell * radiance;
        }
    }
    return irradiance(m) - lost;
}

struct Outcome {
    double z = 0;
    double relative_error = 0;
    double unreachable = 0;  // cells with light and no probability
    double sum_error = 0;
};

Outcome measure(const Map& m, int draws, bool every_cell) {
    Environment environment;
    environment.image = m.image();
    const EnvironmentLight light(environment);
    Outcome out;
    stats::Random random(case_seed(9));
    stats::Moments mean;
    for (int i = 0; i < draws; ++i) {
        double value = 0;
        if (const auto s = light.sample(random.pair()); s && s->pdf > 0 && s->wi.y > 0)
            value = static_cast<double>(s->radiance.y) * static_cast<double>(s->wi.y) /
                    static_cast<double>(s->pdf);
        mean.add(value);
    }
    const auto expected = static_cast<double>(irradiance(m));
    out.relative_error = relative(mean.mean(), expected);
    out.z = std::abs(mean.mean() - expected) / mean.standard_error();
    if (!every_cell) return out;
    // Every cell, at its middle.
    Real sum = 0;
    std::vector<double> weights(std::size_t{m.width} * m.height);
    for (uint32_t y = 0; y < m.height; ++y) {
        const double theta = std::numbers::pi * (y + 0.5) / m.height;
        for (uint32_t x = 0; x < m.width; ++x) {
            const double phi = ((x + 0.5) / m.width - 0.5) * 2 * std::numbers::pi;
            const Vec3f d(Vec3d(std::sin(theta) * std::cos(phi), std::cos(theta),
                                std::sin(theta) * std::sin(phi)));
            if (!(light.pdf(d) > 0)) ++out.unreachable;
            weights[std::size_t{y} * m.width + x] =
                static_cast<double>(environment.image->texels[std::size_t{y} * m.width + x].y) *
                std::sin(theta);
        }
    }
    const CellDistribution cells(weights, m.width, m.height);
    for (uint32_t y = 0; y < m.height; ++y)
        for (uint32_t x = 0; x < m.width; ++x) sum += static_cast<Real>(cells.mass(x, y));
    out.sum_error = static_cast<double>(std::abs(sum - 1));
    return out;
}

// A ball and a floor under such a sky; the control's sky lacks the cells behind the hot pixel.
CaseImages picture(Effort effort, uint64_t& nonfinite, WorkerPool& pool) {
    constexpr uint32_t kSize = 64;
    const Map m{1024, 512, 300, 100, 4e7, "sky"};
    SceneBuilder builder;
    builder.mesh(SceneBuilder::quad(Vec3f(-4, 0, -4), Vec3f(0, 0, 8), Vec3f(8, 0, 0)),
                 builder.material(SceneBuilder::diffuse(0.6f)));
    builder.sphere(Vec3d(0, 0.7, 0), 0.7, builder.material(SceneBuilder::diffuse(0.8f)));
    builder.desc().environment.intensity = 0.02f;
    builder.desc().environment.image = m.image();
    const Camera camera = camera_at(Vec3d(0, 1.8, 4), Vec3d(0, 0.5, 0), 0.6);
    const uint64_t passes = effort == Effort::full ? 32 : 8;
    NonFiniteCount bad;
    CaseImages images;
    images.own = render_film(builder.build(pool), camera, PathSettings{}, kSize, kSize, passes,
                             pool, -1, &bad)
                     .image(false);
    auto stalled = m.image();
    float sum = 0;
    for (uint32_t y = 0; y < m.height; ++y) {
        const float sine =
            std::sin(kPi * (static_cast<float>(y) + 0.5f) / static_cast<float>(m.height));
        for (uint32_t x = 0; x < m.width; ++x) {
            Rgb& texel = stalled->texels[std::size_t{y} * m.width + x];
            const float before = sum;
            sum += texel.y * sine;
            if (sum == before) texel = Rgb(0);
        }
    }
    builder.desc().environment.image = stalled;
    images.naive =
        render_film(builder.build(pool), camera, PathSettings{}, kSize, kSize, passes, pool)
            .image(false);
    nonfinite += bad.total();
    return images;
}

CaseResult run(Effort effort) {
    const bool full = effort == Effort::full;
    WorkerPool pool(run_settings().threads);
    CaseResult result;
    std::vector<Map> maps;
    const uint32_t w = full ? 2048 : 512;
    const uint32_t h = w / 2;
    for (const double heat : {1e3, 1e6, 1e9, 1e12}) {
        maps.push_back({w, h, w / 3, h / 4, heat, "sky"});
        if (heat != 1e6 && !full) continue;
        maps.push_back({w, h, 0, 0, heat, "corner at the pole"});
        maps.push_back({w, h, w / 5, 0, heat, "pole"});
        maps.push_back({w, h, w - 1, h / 5, heat, "seam"});
        maps.push_back({w, h, w / 5, h - 1, heat, "pole below"});
    }
    // Large enough, and just hot enough, that a float stalls and loses the most.
    maps.push_back(full ? Map{8192, 4096, 2000, 1000, 1e9, "sky"}
                        : Map{2048, 1024, 500, 200, 4e7, "sky"});

    Sweep sweep{"heat of the pixel over the sky",
                "relative error of the irradiance (Talbot's with its noise)",
                true,
                0.004,
                {}};
    WorstError z, unreachable, sum;
    double naive_unreachable = 0;
    WorstError naive_z;
    for (const Map& m : maps) {
        const auto where = [&] {
            return std::string(m.place) + " heat " + exact(m.heat) + " width " +
                   std::to_string(m.width);
        };
        const bool large = m.width > w;
        const Outcome out = measure(m, full ? 400000 : 40000, !large || full);
        z.add(out.z, where);
        unreachable.add(out.unreachable, where);
        sum.add(out.sum_error, where);
        double stalled = 0;
        const auto expected = irradiance(m);
        const Real naive = naive_irradiance(m, stalled);
        naive_unreachable = std::max(naive_unreachable, stalled);
        const double lost = static_cast<double>((expected - naive) / expected);
        naive_z.add(lost / 0.001);
        if (large || std::string(m.place) == "sky")
            sweep.points.push_back({m.heat, lost, out.relative_error});
    }
    std::sort(sweep.points.begin(), sweep.points.end(),
              [](const SweepPoint& a, const SweepPoint& b) { return a.parameter < b.parameter; });
    result.images.push_back(picture(effort, result.nonfinite, pool));
    result.measures.push_back(
        {"irradiance off, in standard errors (of the control: in steps of 0.1 %)", naive_z.value,
         z.or_infinite(), 4, Gate::at_most, z.where});
    result.measures.push_back({"cells with light and no probability", naive_unreachable,
                               unreachable.or_infinite(), 0, Gate::at_most, unreachable.where});
    result.measures.push_back({"sum of all probabilities, off 1", std::nan(""), sum.or_infinite(),
                               1e-12, Gate::at_most, sum.where});
    result.sweeps.push_back(sweep);
    return result;
}

const bool kAdded = add_case(
    {"L05", Priority::p0, "environment with one hot pixel", "one float prefix sum over all cells",
     "rows and columns summed in double; a cell's weight is the mean of the bilinear lookup over "
     "it",
     "mitsuba-renderer/mitsuba3#469, mitsuba-renderer/mitsuba2#173, mmp/pbrt-v3#62", run});

}  // namespace
}  // namespace talbot::hardcases::l05
