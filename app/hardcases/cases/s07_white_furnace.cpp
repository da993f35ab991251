// S07: white surfaces in a white surrounding return what they receive, rough ones too.
#include <algorithm>

#include "app/hardcases/cases/gltf_text.h"
#include "app/hardcases/cases/shading_setup.h"
#include "oracles/scattering_cases.h"

namespace talbot::hardcases::s07 {
namespace {

struct Range {
    double low = 1, high = 1;
    std::string lowest, highest;

    void add(double x, const std::string& where) {
        if (x < low) low = x, lowest = where;
        if (x > high) high = x, highest = where;
    }
};

// A single scattering: what textbook GGX returns. masked: with its shadowing, else D alone over
// 4 cos cos.
double single_scattering(float alpha, float mu, bool masked) {
    const Vec3f wo(std::sqrt(1 - mu * mu), 0, mu);
    const Ggx ggx(alpha);
    double sum = 0;
    constexpr uint32_t kPoints = 20000;
    for (uint32_t i = 0; i < kPoints; ++i) {
        const Vec3f h = ggx.sample_visible_normal(wo, even_point(i));
        const Vec3f wi = reflect_about(wo, h, dot(wo, h));
        if (!(wi.z > 0)) continue;
        sum += static_cast<double>(masked ? ggx.g2(wo, wi) / ggx.g1(wo) : 1 / ggx.g1(wo));
    }
    return sum / kPoints;
}

CaseImages picture(Effort effort, double& naive_worst, double& own_worst, uint64_t& nonfinite) {
    constexpr uint32_t kSize = 64;
    constexpr int kBalls = 4;
    WorkerPool pool(run_settings().threads);
    SceneBuilder builder;
    for (int i = 0; i < kBalls; ++i) {
        Material m;
        m.roughness_factor = i % 2 == 0 ? 1.0f : 0.6f;
        m.metallic_factor = i < 2 ? 1.0f : 0.0f;
        if (i >= 2) {
            m.transmission_factor = 1;
            m.thickness_factor = 1;
        }
        builder.sphere(Vec3d(i % 2 == 0 ? -1.1 : 1.1, i < 2 ? 1.1 : -1.1, 0), 1,
                       builder.material(m));
    }
    builder.environment(Rgb(1));
    const Camera camera = camera_at(Vec3d(0, 0, 8), Vec3d(0), 0.6);
    PathSettings settings;
    settings.max_depth = 1024;
    NonFiniteCount bad;
    const auto scene = builder.build(pool);
    const uint64_t passes = effort == Effort::full ? 1024 : 128;
    CaseImages images;
    images.own =
        render_film(scene, camera, settings, kSize, kSize, passes, pool, -1, &bad).image(false);
    images.naive = blank_image(kSize, kSize);
    const CameraRays rays(camera, scene->origin(), kSize, kSize, Bounds{});
    double own_sum[kBalls] = {};
    double naive_sum[kBalls] = {};
    double pixels[kBalls] = {};
    std::vector<double> naive_by_cosine(64);
    for (uint32_t y = 0; y < kSize; ++y) {
        for (uint32_t x = 0; x < kSize; ++x) {
            const Ray ray =
                rays.ray(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f, Vec2f(0));
            Hit hit;
            Rgb& naive = images.naive.rgb[y * kSize + x];
            naive = Rgb(1);
            if (!scene->accel().closest(ray, hit)) continue;
            const Sphere& ball = scene->geometry().spheres[hit.id.primitive];
            const std::size_t k = hit.id.primitive;
            const Vec3f n = normalize(ray.o + hit.t * ray.d - Vec3f(ball.center));
            // Glass loses at least what one of its rough faces does; the control shows metal's
            // loss.
            const float alpha = k % 2 == 0 ? 1.0f : 0.36f;
            naive = Rgb(
                static_cast<float>(AlbedoRow(alpha)(std::clamp(-dot(ray.d, n), 0.0f, 1.0f)).e()));
            own_sum[k] += static_cast<double>(mean_component(images.own.rgb[y * kSize + x]));
            naive_sum[k] += static_cast<double>(naive.x);
            ++pixels[k];
        }
    }
    for (int k = 0; k < kBalls; ++k) {
        own_worst = std::max(own_worst, std::abs(own_sum[k] / pixels[k] - 1));
        naive_worst = std::max(naive_worst, std::abs(naive_sum[k] / pixels[k] - 1));
    }
    nonfinite = bad.total();
    images.scene_file_name = "s07-furnace.gltf";
    images.scene_gltf = gltf_text(builder.desc(), camera, kSize, kSize);
    return images;
}

// Surfaces to be looked at from one direction.
struct Job {
    std::vector<ScatteringCase> surfaces;
    float mu;
    std::string at;
    bool layered;
};

// Range of albedos per job, and whether it is of layered surfaces.
std::vector<std::pair<Range, bool>> albedos(const std::vector<Job>& jobs, WorkerPool& pool) {
    std::vector<std::pair<Range, bool>> ranges(jobs.size());
    pool.parallel_for(jobs.size(), [&](uint64_t i, unsigned) {
        const Job& job = jobs[i];
        ranges[i].second = job.layered;
        for (const ScatteringCase& c : job.surfaces) {
            // Films and stretched refraction lose by design, see docs/materials.md.
            if (c.params.iridescence > 0 || c.name == "stretched glass") continue;
            const double a =
                c.params.anisotropy > 0 ? sampled_albedo(c, {job.mu}) : albedo(c, {job.mu});
            ranges[i].first.add(a, c.name + job.at);
        }
    });
    return ranges;
}

CaseResult run(Effort effort) {
    const bool full = effort == Effort::full;
    Range own;
    Range naive;
    Range layered;
    double unmasked = 0;
    double single = 0;
    std::string single_where;
    std::vector<Job> jobs;
    Sweep sweep{
        "roughness", "energy that a white metal loses or gains, cosine 0.5", false, 0.005, {}};
    for (int step = 0; step <= 10; ++step) {
        if (!full && step % 5 != 0) continue;
        const float roughness = 0.1f * static_cast<float>(step);
        const float alpha = roughness * roughness;
        for (const float mu : {1.0f, 0.5f, 0.1f, 0.01f}) {
            if (!full && mu == 0.1f) continue;
            const std::string at = " roughness " + exact(roughness) + " cosine " + exact(mu);
            jobs.push_back({white_surfaces(alpha), mu, at, false});
            if (full) jobs.push_back({layered_surfaces(alpha), mu, at, true});
            if (alpha < kDeltaAlpha) continue;
            const double s = single_scattering(alpha, mu, true);
            naive.add(s, at);
            if (s > single) single = s, single_where = at;
            unmasked = std::max(unmasked, single_scattering(alpha, mu, false));
            if (mu == 0.5f) {
                const double metal = albedo(white_surfaces(alpha)[5], {mu});
                sweep.points.push_back(
                    {static_cast<double>(roughness), std::abs(1 - s), std::abs(1 - metal)});
            }
        }
    }
    WorkerPool pool(run_settings().threads);
    for (const auto& [range, who] : albedos(jobs, pool)) {
        Range& total = who ? layered : own;
        total.add(range.low, range.lowest);
        total.add(range.high, range.highest);
    }
    CaseResult result;
    double naive_image = 0;
    double own_image = 0;
    result.images.push_back(picture(effort, naive_image, own_image, result.nonfinite));
    result.measures.push_back({"energy lost by a white surface", 1 - naive.low, 1 - own.low, 0.005,
                               Gate::at_most, own.lowest});
    result.measures.push_back({"energy gained by a white surface", unmasked - 1, own.high - 1,
                               0.002, Gate::at_most, own.highest});
    if (full) {
        result.measures.push_back({"energy lost under coat, sheen or stretched roughness",
                                   std::nan(""), 1 - layered.low, 0.005, Gate::at_most,
                                   layered.lowest});
        result.measures.push_back({"energy gained there", std::nan(""), layered.high - 1, 0.002,
                                   Gate::at_most, layered.highest});
    }
    result.measures.push_back({"energy gained by a single scattering", unmasked - 1, single - 1,
                               0.0005, Gate::at_most, single_where});
    result.measures.push_back({"mean of a rough ball in a unit sky, off 1", naive_image, own_image,
                               0.005, Gate::at_most, ""});
    result.sweeps.push_back(sweep);
    return result;
}

const bool kAdded = add_case(
    {"S07", Priority::p0, "white furnace", "a single scattering; D over 4 cos cos for the gain",
     "multiple scattering from tables integrated in double (Turquin 2019, Kulla and Conty 2017)",
     "mitsuba-renderer/mitsuba3#1155; gkjohnson/three-gpu-pathtracer#348; "
     "knightcrawler25/GLSL-PathTracer#78; AcademySoftwareFoundation/OpenPBR#146",
     run});

}  // namespace
}  // namespace talbot::hardcases::s07
