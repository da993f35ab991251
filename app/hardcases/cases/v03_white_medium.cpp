// V03: a medium that scatters and absorbs nothing, from thin to thick, forward to backward, in
// index- matched and glass bodies: a unit surrounding must be seen unchanged, and the mean way
// through a convex body is 4 V / S whatever the medium (Blanco and Fournier 2003).
#include <numbers>

#include "app/hardcases/cases/gltf_text.h"
#include "app/hardcases/cases/shading_setup.h"
#include "core/integrate/medium_point.h"
#include "core/integrate/tiers.h"
#include "core/scattering/henyey_greenstein.h"
#include "core/scattering/medium.h"
#include "oracles/stats/random.h"
#include "oracles/stats/ztest.h"

namespace talbot::hardcases::v03 {
namespace {

enum class Body { sphere, box, instance };

// From the origin to the copy of an instance.
constexpr double kAside = 4000;

// A body of about unit size; `sigma` per metre.
SceneBuilder body(Body kind, float sigma, float g, float ior) {
    SceneBuilder builder;
    Material m;
    m.metallic_factor = 0;
    m.roughness_factor = 0;
    m.transmission_factor = 1;
    m.thickness_factor = 1;
    m.ior = ior;
    m.attenuation_color = Rgb(0.36787944f);
    m.attenuation_distance = 1 / sigma;
    m.multiscatter_color = Rgb(1);
    m.scatter_anisotropy = g;
    const uint32_t material = builder.material(m);
    if (kind == Body::sphere) {
        builder.sphere(Vec3d(0), 1, material);
    } else {
        Mat4d place(1.0);
        if (kind == Body::instance) {
            // Turned and moved, and used twice, so that it stays an instance.
            const Mat4d turn(Vec4d(0.6, 0, -0.8, 0), Vec4d(0, 1, 0, 0), Vec4d(0.8, 0, 0.6, 0),
                             Vec4d(0, 0, 0, 1));
            place = turn;
        }
        builder.mesh(SceneBuilder::box(Vec3f(-0.8f), Vec3f(0.8f)), material, place);
        if (kind == Body::instance) {
            Mat4d aside(1.0);
            aside[3] = Vec4d(kAside, 0, 0, 1);
            builder.instance(0, aside);
        }
    }
    builder.environment(Rgb(1));
    return builder;
}

// Where a free path ends, as in the path tracer; the control's is o + t d.
enum class Points { own, naive };

// Ways of rays that enter a body evenly and from all sides, through its real boundary.
struct Ways {
    std::vector<double> lengths;
    double lost = 0;  // walks that came to be outside without crossing the boundary
};

// In a sphere, a box, or the copy of an instance.
stats::Moments walk(Body kind, float sigma, float g, int rays, uint64_t seed, WorkerPool& pool,
                    double& lost, Points points = Points::own) {
    const SceneBuilder builder = body(kind, sigma, g, 1);
    const auto scene = builder.build(pool);
    const Vec3d center(kind == Body::instance ? kAside : 0, 0, 0);
    const Vec3f middle(center - scene->origin());
    // An entry nearer to an edge than floats are apart there may be rounded past it.
    const float spacing = std::nextafter(max_component(glm::abs(middle)), kInfinity) -
                          max_component(glm::abs(middle));
    const float half_face = 0.8f - 2 * spacing;
    const Medium medium = medium_of(scene->materials()[1]);
    const HenyeyGreenstein phase(g);
    constexpr int kChunks = 16;
    std::vector<Ways> parts(kChunks);
    pool.parallel_for(kChunks, [&](uint64_t chunk, unsigned) {
        stats::Random random(case_seed(seed * kChunks + chunk));
        Ways& ways = parts[chunk];
        for (int i = 0; i < rays / kChunks; ++i) {
            // Even over the surface, cosine-distributed inwards.
            Vec3f from;
            Vec3f inward;
            if (kind == Body::sphere) {
                inward = -sample_uniform_sphere(random.pair());
                from = middle - 1.5f * inward;
            } else {
                const int axis = std::min(static_cast<int>(3 * random()), 2);
                const float sign = random() < 0.5f ? -1.0f : 1.0f;
                inward = Vec3f(0);
                inward[axis] = -sign;
                from = middle;
                for (int k = 0; k < 3; ++k)
                    from[k] += k == axis ? sign : half_face * (2 * random() - 1);
            }
            Ray probe;
            probe.o = from;
            probe.d = inward;
            Hit hit;
            if (!scene->accel().closest(probe, hit)) continue;
            const SurfaceInteraction entry =
                make_surface_interaction<kTransmissiveTier>(*scene, probe, hit);
            const Frame frame = Frame::from_normal(-entry.n_geometric);
            Ray ray = entry.spawn(frame.to_world(sample_cosine_hemisphere(random.pair())));
            double length = 0;
            for (;;) {
                Hit exit;
                if (!scene->accel().closest(ray, exit)) {
                    ++ways.lost;
                    break;
                }
                const MediumSample s = sample_medium(medium, Rgb(1), exit.t, random.pair());
                length += static_cast<double>(s.t);
                if (!s.scattered) break;
                const Vec3f p = points == Points::own
                                    ? point_in_medium(*scene, ray, s.t, true, exit)
                                    : ray.o + s.t * ray.d;
                const Vec3f d = phase.sample(ray.d, random.pair());
                ray = Ray{};
                ray.o = p;
                ray.d = d;
            }
            ways.lengths.push_back(length);
        }
    });
    lost = 0;
    stats::Moments length;
    for (const Ways& part : parts) {
        for (const double x : part.lengths) length.add(x);
        lost += part.lost;
    }
    return length;
}

CaseImages picture(Effort effort, double& naive_error, uint64_t& nonfinite, WorkerPool& pool) {
    constexpr uint32_t kSize = 64;
    const SceneBuilder builder = body(Body::sphere, 5, 0.5f, 1);
    const Camera camera = camera_at(Vec3d(0, 0, 4), Vec3d(0), 0.6);
    NonFiniteCount bad;
    const auto scene = builder.build(pool);
    CaseImages images;
    images.own = render_film(scene, camera, PathSettings{}, kSize, kSize,
                             effort == Effort::full ? 64 : 8, pool, -1, &bad)
                     .image(false);
    nonfinite += bad.total();
    // The control gives up after 8 events.
    images.naive = blank_image(kSize, kSize);
    const CameraRays rays(camera, scene->origin(), kSize, kSize, Bounds{});
    const Medium medium = medium_of(scene->materials()[1]);
    const HenyeyGreenstein phase(0.5f);
    stats::Random random(case_seed(3));
    double sum = 0;
    double count = 0;
    for (uint32_t y = 0; y < kSize; ++y) {
        for (uint32_t x = 0; x < kSize; ++x) {
            constexpr int kPasses = 8;
            float seen = 0;
            bool through_body = false;
            for (int pass = 0; pass < kPasses; ++pass) {
                Ray ray = rays.ray(static_cast<float>(x) + random(),
                                   static_cast<float>(y) + random(), Vec2f(0));
                Hit hit;
                if (!scene->accel().closest(ray, hit)) {
                    seen += 1;
                    continue;
                }
                through_body = true;
                ray = make_surface_interaction<kTransmissiveTier>(*scene, ray, hit).spawn(ray.d);
                for (int event = 0; event < 8; ++event) {
                    Hit exit;
                    if (!scene->accel().closest(ray, exit)) break;
                    const MediumSample s = sample_medium(medium, Rgb(1), exit.t, random.pair());
                    if (!s.scattered) {
                        seen += 1;
                        break;
                    }
                    const Vec3f p = ray.o + s.t * ray.d;
                    const Vec3f d = phase.sample(ray.d, random.pair());
                    ray = Ray{};
                    ray.o = p;
                    ray.d = d;
                }
            }
            images.naive.rgb[y * kSize + x] = Rgb(seen / kPasses);
            if (through_body) sum += static_cast<double>(seen / kPasses), ++count;
        }
    }
    naive_error = std::abs(sum / count - 1);
    images.scene_file_name = "v03-white-medium.gltf";
    images.scene_gltf = gltf_text(builder.desc(), camera, kSize, kSize);
    return images;
}

constexpr double kChordError = 0.002;

// Roulette ends long walks, so that thick bodies and glass have noise. What ten thousand products
// in float may make of a weight of 1 is no noise.
constexpr double kWalkRounding = 1e-4;
// A largest of up to 168 with 63 degrees of freedom exceeds it once in a thousand runs.
constexpr double kMostErrors = 5;

// Thin bodies take many: ways spread by a third to a half of their mean, which a million of them
// know to 0.05 %.
int full_walks(float sigma) {
    if (sigma < 0.1f) return 1000000;
    return sigma > 50 ? 10000 : 100000;
}

CaseResult run(Effort effort) {
    const bool full = effort == Effort::full;
    WorkerPool pool(run_settings().threads);
    CaseResult result;
    double naive_furnace = 0;
    result.images.push_back(picture(effort, naive_furnace, result.nonfinite, pool));

    // Total reflection traps light in glass for more than the usual 64 surfaces.
    PathSettings endless;
    endless.max_depth = 1u << 16;
    WorstError furnace;
    WorstError furnace_z;
    Sweep sweep{"optical thickness of the radius",
                "radiance of a body in a unit sky, off 1",
                true,
                0.002,
                {}};
    const std::vector<float> sigmas = full
                                          ? std::vector<float>{1e-3f, 1e-2f, 0.1f, 1, 10, 100, 1000}
                                          : std::vector<float>{1e-3f, 1, 5};
    for (const float sigma : sigmas) {
        WorstError here;
        for (const float g : {-0.99f, 0.0f, 0.8f, 0.99f}) {
            for (const Body kind : {Body::sphere, Body::box, Body::instance}) {
                for (const float ior : {1.0f, 1.5f}) {
                    // Glass is noisy, thick bodies are slow.
                    if (!full && (ior > 1 || (g != 0 && kind == Body::box))) continue;
                    if (sigma > 50 && (kind != Body::sphere || std::abs(g) > 0.9f)) continue;
                    NonFiniteCount bad;
                    const Film film = render_film(body(kind, sigma, g, ior).build(pool),
                                                  camera_at(Vec3d(0, 0, 6), Vec3d(0), 0.12),
                                                  endless, 8, 8, full ? 256 : 16, pool, -1, &bad);
                    result.nonfinite += bad.total();
                    const stats::Moments pixels = pixel_moments(film);
                    const double e = std::abs(pixels.mean() - 1);
                    const double error = std::hypot(pixels.standard_error(), kWalkRounding);
                    const auto where = [&] {
                        return "sigma " + exact(sigma) + " g " + exact(g) + " index " + exact(ior) +
                               " body " + std::to_string(static_cast<int>(kind));
                    };
                    here.add(e);
                    furnace.add(std::max(0.0, e - 4 * error), where);
                    furnace_z.add(e / error, where);
                }
            }
        }
        sweep.points.push_back({static_cast<double>(sigma), std::nan(""), here.value});
    }
    WorstError chord;
    WorstError chord_error;
    double lost = 0;
    double naive_lost = 0;
    std::string lost_where;
    uint64_t seed = 50;
    for (const float sigma : {0.05f, 1.0f, 20.0f, 300.0f}) {
        if (!full && sigma > 50) continue;
        for (const float g : {0.0f, -0.9f, 0.9f, 0.999f}) {
            for (const Body kind : {Body::sphere, Body::box, Body::instance}) {
                if (!full && kind == Body::box && g != 0) continue;
                // Far from the origin rounding is coarse.
                if (kind == Body::instance && (sigma != 20 || g != 0)) continue;
                const int rays = full ? full_walks(sigma) : 4000;
                double lost_here = 0;
                const stats::Moments ways = walk(kind, sigma, g, rays, ++seed, pool, lost_here);
                const auto where = [&] {
                    return "sigma " + exact(sigma) + " g " + exact(g) + " body " +
                           std::to_string(static_cast<int>(kind));
                };
                if (lost_here > 0 && lost == 0) lost_where = where();
                lost += lost_here;
                if (kind == Body::instance) {
                    walk(kind, sigma, g, rays, seed, pool, naive_lost, Points::naive);
                    continue;
                }
                // 4 V / S: 4/3 of the radius; 2/3 of the edge.
                const double expected = kind == Body::sphere ? 4.0 / 3 : 2.0 / 3 * 1.6;
                chord.add(std::abs(ways.mean() - expected) / ways.standard_error(), where);
                // Where chance alone leaves room for it.
                if (4 * ways.standard_error() < kChordError * expected)
                    chord_error.add(relative(ways.mean(), expected), where);
            }
        }
    }
    result.measures.push_back(
        {"radiance of a white body in a unit sky, off 1 beyond 4 standard errors", naive_furnace,
         furnace.or_infinite(), 0.002, Gate::at_most, furnace.where});
    result.measures.push_back({"the same in standard errors", std::nan(""), furnace_z.or_infinite(),
                               kMostErrors, Gate::at_most, furnace_z.where});
    result.measures.push_back({"mean way through a body, off 4 V / S in standard errors",
                               std::nan(""), chord.or_infinite(), 4, Gate::at_most, chord.where});
    if (full)
        result.measures.push_back({"mean way through a body, relative error", std::nan(""),
                                   chord_error.or_infinite(), kChordError, Gate::at_most,
                                   chord_error.where});
    result.measures.push_back({"walks that left a body without crossing its boundary", naive_lost,
                               lost, 0, Gate::at_most, lost_where});
    result.sweeps.push_back(sweep);
    return result;
}

const bool kAdded =
    add_case({"V03", Priority::p0, "white medium: furnace and mean way",
              "a walk of at most 8 events; o + t d",
              "walks without end but the roulette; free paths and boundaries from the same ray; a "
              "point that "
              "rounding took through the boundary goes back to its inside",
              "tangent-animation/blender278#78, #144; mitsuba-renderer/mitsuba3#1387", run});

}  // namespace
}  // namespace talbot::hardcases::v03
