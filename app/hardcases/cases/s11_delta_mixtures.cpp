// S11: delta lobes beside smooth ones. A delta event has a probability, not a density: no number
// stands in for infinity, and its MIS weight is 1.
#include "app/hardcases/cases/shading_setup.h"
#include "core/integrate/pixel_filter.h"
#include "core/integrate/sampler.h"
#include "oracles/scattering_cases.h"
#include "oracles/stats/random.h"
#include "oracles/stats/ztest.h"

namespace talbot::hardcases::s11 {
namespace {

constexpr uint32_t kSize = 32;

std::shared_ptr<const EnvironmentImage> hot_sky() {
    auto image = std::make_shared<EnvironmentImage>();
    image->width = 1024;
    image->height = 512;
    image->texels.assign(std::size_t{1024} * 512, Rgb(1));
    image->texels[std::size_t{130} * 1024 + 256] = Rgb(1e9f);
    return image;
}

struct Exactness {
    double naive = 0, own = 0;
};

// A mirror floor under a sky with one hot pixel: every sample equals the sky in the mirror's
// direction, bit for bit. The control weighs it against light sampling with a stand-in density.
Exactness mirror_of_hot_sky(WorkerPool& pool, uint64_t passes, uint64_t& nonfinite) {
    SceneBuilder builder;
    Material mirror;
    mirror.roughness_factor = 0;
    builder.mesh(SceneBuilder::quad(Vec3f(-50, 0, -50), Vec3f(0, 0, 100), Vec3f(100, 0, 0)),
                 builder.material(mirror));
    builder.desc().environment.image = hot_sky();
    const auto scene = builder.build(pool);
    const LightTable lights(*scene);
    // Looks where the mirror shows the pixel: row 130 of 512, column 256 of 1024 (towards -z).
    const Camera camera = camera_at(Vec3d(0, 1, 1), Vec3d(0, 0, 0), 0.2);
    const CameraRays rays(camera, scene->origin(), kSize, kSize, Bounds{});
    PathSettings settings;
    NonFiniteCount bad;
    const Film film = render_film(scene, camera, settings, kSize, kSize, passes, pool, -1, &bad);
    nonfinite += bad.total();
    Exactness differing;
    for (uint32_t y = 0; y < kSize; ++y) {
        for (uint32_t x = 0; x < kSize; ++x) {
            ExactSum expected;
            ExactSum weighed;
            for (uint64_t i = 0; i < passes; ++i) {
                const Sampler sampler(settings.sampler, settings.seed, x, y, i);
                const Vec2f at = sample_pixel_filter(settings.filter, sampler.pair(Purpose::pixel));
                const Ray ray =
                    rays.ray(static_cast<float>(x) + at.x, static_cast<float>(y) + at.y, Vec2f(0));
                const Vec3f wi(ray.d.x, -ray.d.y, ray.d.z);
                const float radiance = lights.environment().eval(wi).y;
                expected.add(radiance);
                constexpr float kStandIn = 1e6f;
                weighed.add(radiance * power_heuristic(kStandIn, lights.pdf_environment(wi)));
            }
            const ExactSum& own = film.pixel(x, y).sum[1];
            if (!(own == expected)) ++differing.own;
            if (!(weighed == expected)) ++differing.naive;
        }
    }
    return differing;
}

// A floor and a ball under an area light: the mean with light sampling and without.
double strategies_apart(WorkerPool& pool, const Material& floor, const Material& ball,
                        uint64_t passes) {
    SceneBuilder builder;
    builder.mesh(SceneBuilder::quad(Vec3f(-5, 0, -5), Vec3f(0, 0, 10), Vec3f(10, 0, 0)),
                 builder.material(floor));
    builder.sphere(Vec3d(0, 0.8, 0), 0.7, builder.material(ball));
    Material lamp = SceneBuilder::diffuse(0);
    lamp.emissive_factor = Rgb(4);
    builder.mesh(SceneBuilder::quad(Vec3f(-1.5f, 3, -1.5f), Vec3f(3, 0, 0), Vec3f(0, 0, 3)),
                 builder.material(lamp));
    builder.environment(Rgb(0.1f));
    const auto scene = builder.build(pool);
    stats::Moments means[2];
    for (uint64_t seed = 1; seed <= 16; ++seed) {
        for (int without = 0; without < 2; ++without) {
            PathSettings settings;
            settings.seed = seed * 2 + static_cast<uint64_t>(without);
            settings.max_depth = 8;
            settings.next_event_estimation = without == 0;
            means[without].add(
                film_mean(render_film(scene, camera_at(Vec3d(0, 1.5, 4), Vec3d(0, 0.6, 0)),
                                      settings, 16, 16, passes, pool)));
        }
    }
    return std::abs(means[0].mean() - means[1].mean()) /
           std::hypot(means[0].standard_error(), means[1].standard_error());
}

// The control on such a scene: smooth plastic whose mirror is a lobe of density 1e6 for MIS, seen
// in a lamp that light sampling finds with the same density.
double stand_in_apart() {
    stats::Random random(case_seed(3));
    stats::Moments with;
    for (int i = 0; i < 100000; ++i) {
        constexpr float kMirror = 0.04f;
        const bool mirrored = random() < kMirror;
        with.add(mirrored ? static_cast<double>(power_heuristic(1e6f, 1e6f)) : 0.0);
    }
    stats::Moments exact_mean;
    stats::Random again(case_seed(3));
    for (int i = 0; i < 100000; ++i) exact_mean.add(again() < 0.04f ? 1 : 0);
    return std::abs(with.mean() - exact_mean.mean()) / with.standard_error();
}

CaseResult run(Effort effort) {
    const bool full = effort == Effort::full;
    WorkerPool pool(run_settings().threads);
    CaseResult result;
    const Exactness exactness = mirror_of_hot_sky(pool, full ? 64 : 4, result.nonfinite);

    Material plastic;
    plastic.metallic_factor = 0;
    plastic.roughness_factor = 0;
    plastic.base_color_factor = Vec4f(0.5f, 0.5f, 0.5f, 1);
    Material glass;
    glass.metallic_factor = 0;
    glass.roughness_factor = 0;
    glass.transmission_factor = 1;
    glass.thickness_factor = 1;
    Material mirror;
    mirror.roughness_factor = 0;
    const uint64_t passes = full ? 256 : 8;
    WorstError apart;
    const auto judge = [&](const Material& floor, const Material& ball, const char* name) {
        apart.add(strategies_apart(pool, floor, ball, passes), [&] { return std::string(name); });
    };
    judge(plastic, plastic, "mirror over diffuse");
    judge(SceneBuilder::diffuse(0.5f), glass, "smooth glass over a diffuse floor");
    judge(plastic, mirror, "mirror ball on smooth plastic");

    // Lobes are chosen with probabilities that sum to 1.
    WorstError sum;
    for (const float mu : {1.0f, 0.5f, 0.1f, 1e-3f}) {
        for (const ScatteringCase& c : white_surfaces(0)) {
            const FullBsdf bsdf = make_bsdf(c, {mu});
            double p = 0;
            for (const BsdfSample& s : delta_events(bsdf)) p += static_cast<double>(s.pdf);
            if (bsdf.has_smooth_lobe())
                p += integrate_sphere(c, {mu}, [](const Vec3f&, const BsdfEval& e) {
                    return static_cast<double>(e.pdf);
                });
            sum.add(std::abs(p - 1), [&] { return c.name + " cosine " + exact(mu); });
        }
    }
    result.measures.push_back({"pixels of a mirror that differ from the hot sky it shows",
                               exactness.naive, exactness.own, 0, Gate::at_most, ""});
    result.measures.push_back({"light sampling on and off, apart in standard errors",
                               stand_in_apart(), apart.or_infinite(), 4, Gate::at_most,
                               apart.where});
    result.measures.push_back({"probabilities of all lobes, off 1", std::nan(""), sum.or_infinite(),
                               1e-3, Gate::at_most, sum.where});
    return result;
}

const bool kAdded = add_case(
    {"S11", Priority::p0, "delta lobes in mixtures",
     "a density of 1e6 stands in for the delta lobe", "a flag, a probability and a MIS weight of 1",
     "gkjohnson/three-gpu-pathtracer#174, #846; nvpro-samples/vk_gltf_renderer#20", run});

}  // namespace
}  // namespace talbot::hardcases::s11
