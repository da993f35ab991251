// C02: images of no pixels, one pixel or one row; orthographic views of any size.
#include <vector>

#include "app/hardcases/worst.h"
#include "app/options.h"
#include "core/math/robust.h"
#include "oracles/scene_builder.h"

namespace talbot::hardcases::c02 {
namespace {

bool refuses(const std::string& size) {
    const auto parsed = parse_options(std::vector<std::string>{"--size", size});
    return !parsed && parsed.error().kind == ErrorKind::usage;
}

std::shared_ptr<const Scene> stage(WorkerPool& pool) {
    SceneBuilder builder;
    Material wall = SceneBuilder::diffuse(0.5f);
    const uint32_t wall_id = builder.material(wall);
    builder.mesh(SceneBuilder::box(Vec3f(-0.5f), Vec3f(0.5f)), wall_id);
    builder.environment(Rgb(1));
    return builder.build(pool);
}

double mean_of(const ImageRgba& image) {
    double sum = 0;
    for (const Rgb& c : image.rgb) sum += static_cast<double>(c.y);
    return sum / static_cast<double>(image.rgb.size());
}

// Largest distance in pixels between where an orthographic ray starts and where it should, in long
// double. The control adds the offset to the camera's world position in float.
void orthographic(Worst& naive, Worst& own, double scale, Draw& draw) {
    constexpr uint32_t kPixels = 1000;
    Camera camera;
    camera.kind = CameraKind::orthographic;
    camera.xmag = camera.ymag = scale;
    // Where scenes of such a size are seen from: a thousand sizes off the world's origin.
    const Vec3d target(1000 * scale, 200 * scale, -3000 * scale);
    look_at(camera, target + Vec3d(3, 2, 5) * scale, target);
    const CameraRays rays(camera, target, kPixels, kPixels, Bounds{});
    for (int i = 0; i < 200; ++i) {
        const auto px = static_cast<float>(draw.between(0, kPixels));
        const auto py = static_cast<float>(draw.between(0, kPixels));
        const long double x = (2 * static_cast<long double>(px) / kPixels - 1) * scale;
        const long double y = (1 - 2 * static_cast<long double>(py) / kPixels) * scale;
        const Vec3f o = rays.ray(px, py, Vec2f(0)).o;
        const Vec3f world = Vec3f(camera.position) + Vec3f(camera.right) * static_cast<float>(x) +
                            Vec3f(camera.up) * static_cast<float>(y);
        long double e_own = 0;
        long double e_naive = 0;
        for (int axis = 0; axis < 3; ++axis) {
            const long double exact = static_cast<long double>(camera.position[axis]) +
                                      x * camera.right[axis] + y * camera.up[axis];
            const long double d_own = static_cast<long double>(o[axis]) + target[axis] - exact;
            const long double d_naive = static_cast<long double>(world[axis]) - exact;
            e_own += d_own * d_own;
            e_naive += d_naive * d_naive;
        }
        const double pixel = 2 * scale / kPixels;
        const auto where = [&] { return "half-extent " + std::to_string(scale); };
        own.add(std::sqrt(static_cast<double>(e_own)) / pixel, where);
        naive.add(std::sqrt(static_cast<double>(e_naive)) / pixel, where);
    }
}

CaseResult run(Effort effort) {
    CaseResult result;
    double accepted = 0;
    for (const char* size :
         {"0x5", "5x0", "0x0", "-1x5", "65536x1", "65535x65535", "5", "x", "5x5x5"})
        accepted += refuses(size) ? 0 : 1;
    result.measures.push_back(
        {"impossible sizes that are accepted, of 9", kNoControl, accepted, 0, Gate::at_most, ""});

    WorkerPool pool(run_settings().threads);
    const auto scene = stage(pool);
    const Camera camera = camera_at(Vec3d(1, 0.8, 1.5), Vec3d(0), 0.8);
    PathSettings settings;
    settings.sampler = SamplerKind::independent;
    settings.seed = run_settings().seed;
    NonFiniteCount counts;
    const uint64_t samples = effort == Effort::full ? 1u << 20 : 1u << 16;
    const Film one = render_film(scene, camera, settings, 1, 1, samples, pool, -1, &counts);
    const Film large =
        render_film(scene, camera, settings, 64, 64, samples / 4096, pool, -1, &counts);
    // Radiance lies in 0..1, so its deviation is at most a half.
    const double error = 0.5 * std::sqrt(2.0 / static_cast<double>(samples));
    result.measures.push_back(
        {"1x1 image against the mean of 64x64, in standard errors", kNoControl,
         std::abs(mean_of(one.image(false)) - mean_of(large.image(false))) / error, 4,
         Gate::at_most, ""});
    double spoiled = 0;
    for (const auto& [width, height] : {std::pair{1u, 65535u}, std::pair{65535u, 1u}}) {
        const Film strip =
            render_film(scene, camera, settings, width, height, 1, pool, -1, &counts);
        for (const Rgb& c : strip.image(false).rgb) spoiled += is_finite(c) ? 0 : 1;
    }
    result.measures.push_back({"pixels of 1x65535 and 65535x1 that are not finite", kNoControl,
                               spoiled, 0, Gate::at_most, ""});

    Worst naive, own;
    Draw draw(0xC02);
    Sweep sweep{"half-extent in metres", "error of an orthographic ray in pixels", true, 0.01, {}};
    for (int exponent = -6; exponent <= 6; ++exponent) {
        Worst n, o;
        orthographic(n, o, std::pow(10.0, exponent), draw);
        sweep.points.push_back({std::pow(10.0, exponent), n.figure, o.figure});
        naive.add(n.figure, [&] { return n.where; });
        own.add(o.figure, [&] { return o.where; });
    }
    result.measures.push_back({"error of orthographic rays in pixels, half-extents 1e-6 to 1e6 m",
                               naive.figure, own.figure, 0.01, Gate::at_most, own.where});
    result.sweeps.push_back(sweep);
    result.nonfinite = counts.total();
    return result;
}

const bool kAdded = add_case({"C02", Priority::p1, "extreme image sizes and orthographic scales",
                              "ray origins in world coordinates in float",
                              "sizes are checked at the door, rays start in re-centred coordinates",
                              "bezo97/IFSRenderer#33, mitsuba3#512, LuxCore#327", run});

}  // namespace
}  // namespace talbot::hardcases::c02
