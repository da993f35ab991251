// G18: up to a million layers: all of them are met, once and in order, and let through what they
// should.
#include <cmath>
#include <cstdint>

#include "app/hardcases/cases/case_run.h"
#include "app/hardcases/cases/case_scenes.h"
#include "core/integrate/surface_interaction.h"
#include "core/integrate/tiers.h"

namespace talbot::hardcases::g18 {
namespace {

using namespace geometry;

// Sheets of side 2 * half, the k-th at z = -k * spacing.
Mesh sheets(uint32_t count, float spacing, float half) {
    Mesh mesh;
    for (uint32_t k = 0; k < count; ++k) {
        const float z = -static_cast<float>(static_cast<double>(k) * static_cast<double>(spacing));
        for (const Vec2f& p : {Vec2f(-1, -1), Vec2f(1, -1), Vec2f(1, 1), Vec2f(-1, 1)})
            mesh.positions.emplace_back(half * p.x, half * p.y, z);
        for (const uint32_t i : {0u, 1u, 2u, 0u, 2u, 3u}) mesh.indices.push_back(4 * k + i);
    }
    return mesh;
}

Camera facing(double half) {
    Camera camera;
    camera.kind = CameraKind::orthographic;
    camera.xmag = camera.ymag = half;
    look_at(camera, Vec3d(0, 0, 1), Vec3d(0, 0, 0));
    return camera;
}

// Layers that are missed, met again or met out of order when the ray goes on from hit to hit.
template <class GoOn>
uint64_t wrong_layers(const Scene& scene, uint32_t count, const Vec3f& d, const GoOn& go_on) {
    Ray ray;
    ray.o = Vec3f(0.3f, 0.2f, 1) - Vec3f(scene.origin());
    ray.d = d;
    uint64_t wrong = 0;
    uint32_t expected = 0;
    Hit hit;
    for (uint32_t steps = 0; steps < 2 * count + 10; ++steps) {
        if (!scene.accel().closest(ray, hit)) break;
        const uint32_t layer = hit.id.primitive / 2;
        if (layer < expected) {
            ++wrong;
        } else {
            wrong += layer - expected;
            expected = layer + 1;
        }
        ray = go_on(ray, hit);
    }
    return wrong + (count - expected);
}

Measure all_hits(uint32_t count) {
    SceneDesc desc;
    add_mesh(desc, sheets(count, 1e-3f, 40), add_material(desc, diffuse(Rgb(0.5f))));
    const auto scene = Scene::build(desc, workers());
    const Vec3f d = normalize(Vec3f(0.01f, 0.02f, -1));
    const uint64_t own = wrong_layers(*scene, count, d, [&](const Ray& ray, const Hit& hit) {
        return make_surface_interaction<kMatteTier>(*scene, ray, hit).spawn(d);
    });
    const uint64_t naive = wrong_layers(*scene, count, d, [](const Ray& ray, const Hit& hit) {
        Ray next;
        next.o = ray.o + (hit.t + 1e-3f) * ray.d;
        next.d = ray.d;
        return next;
    });
    return {line("layers missed or repeated (of %u, a millimetre apart)", count),
            static_cast<double>(naive),
            static_cast<double>(own),
            0,
            Gate::at_most,
            "d " + hex(d)};
}

struct Transmitted {
    double mean = 0;
    double paths = 0;
};

Transmitted transmitted(const SceneDesc& desc, const RenderWith& with, uint64_t& nonfinite) {
    const Rendering r = render(desc, facing(0.1), with);
    nonfinite += r.nonfinite;
    Transmitted out;
    for (const FilmPixel& pixel : r.film.pixels()) {
        out.mean += pixel.sum[0].value();
        out.paths += static_cast<double>(pixel.samples);
    }
    out.mean /= out.paths;
    return out;
}

// Two gates on a share T of paths that come through.
void gate_share(const std::string& what, double exact, double naive, const Transmitted& own,
                CaseResult& result) {
    const double sigma = std::sqrt(exact * (1 - exact) / own.paths);
    result.measures.push_back({what + line(", T = %.4g: deviation in standard errors", exact),
                               std::abs(naive - exact) / sigma, std::abs(own.mean - exact) / sigma,
                               4, Gate::at_most, ""});
    // Where chance alone leaves room for it.
    if (sigma > 0.0025 * exact) return;
    result.measures.push_back({what + line(", T = %.4g: relative deviation", exact),
                               std::abs(naive / exact - 1), std::abs(own.mean / exact - 1), 0.005,
                               Gate::at_most, ""});
}

void alpha_sheets(uint32_t count, uint64_t passes, CaseResult& result) {
    SceneDesc desc;
    Material m = diffuse(Rgb(0));
    m.alpha_mode = AlphaMode::blend;
    const double alpha = 0.25 / count;
    m.base_color_factor.w = static_cast<float>(alpha);
    add_mesh(desc, sheets(count, 0.01f, 5), add_material(desc, m));
    desc.environment.color = Rgb(1);
    RenderWith with;
    with.passes = passes;
    const double exact = std::pow(1 - static_cast<double>(m.base_color_factor.w), count);
    // Control: black beyond 16 layers.
    constexpr uint32_t kLayers = 16;
    const double naive = count > kLayers ? 0 : exact;
    gate_share(line("%u sheets of alpha %.3g", count, alpha), exact, naive,
               transmitted(desc, with, result.nonfinite), result);
}

// Plates with a lamp behind; the control ends paths after 16 events.
void glass_plates(uint32_t count, uint64_t passes, CaseResult& result) {
    SceneDesc desc;
    const uint32_t clear = add_material(desc, glass(1.5f, Rgb(1), kInfinity));
    Mesh plates;
    for (uint32_t k = 0; k < count; ++k) {
        const float z = -static_cast<float>(k);
        const Mesh box = box_mesh({-5, -5, z - 0.25f}, {5, 5, z});
        const auto first = static_cast<uint32_t>(plates.positions.size());
        plates.positions.insert(plates.positions.end(), box.positions.begin(), box.positions.end());
        for (const uint32_t i : box.indices) plates.indices.push_back(first + i);
    }
    add_mesh(desc, plates, clear);
    const float behind = -static_cast<float>(count) - 1;
    add_mesh(desc, quad_mesh({-5, -5, behind}, {10, 0, 0}, {0, 10, 0}),
             add_material(desc, emitter(Rgb(1))));
    RenderWith with;
    with.passes = passes;
    with.max_depth = 100000000;
    RenderWith capped = with;
    capped.max_depth = 16;
    capped.passes = std::min<uint64_t>(passes, 8);
    const double surfaces = 2.0 * count;
    constexpr double kReflectance = 0.04;
    const double exact = (1 - kReflectance) / (1 + (surfaces - 1) * kReflectance);
    uint64_t ignored = 0;
    gate_share(line("%u glass plates", count), exact, transmitted(desc, capped, ignored).mean,
               transmitted(desc, with, result.nonfinite), result);
}

void matched_sheets(uint32_t count, CaseResult& result) {
    SceneDesc desc;
    Material m = glass(1, Rgb(1), kInfinity);
    m.thickness_factor = 0;
    add_mesh(desc, sheets(count, 0.01f, 5), add_material(desc, m));
    desc.environment.color = Rgb(1);
    RenderWith with;
    with.width = with.height = 4;
    with.passes = 1;
    with.max_depth = 100000000;
    RenderWith capped = with;
    capped.max_depth = 16;
    uint64_t ignored = 0;
    result.measures.push_back({line("light lost in %u sheets of index 1", count),
                               std::abs(transmitted(desc, capped, ignored).mean - 1),
                               std::abs(transmitted(desc, with, result.nonfinite).mean - 1), 0,
                               Gate::at_most, ""});
}

// Sheets of falling width: from left to right more and more of them.
CaseImages staircase(uint64_t passes, uint64_t& nonfinite) {
    constexpr uint32_t kSheets = 48;
    constexpr float kAlpha = 0.04f;
    SceneDesc desc;
    Material m = diffuse(Rgb(0));
    m.alpha_mode = AlphaMode::blend;
    m.base_color_factor.w = kAlpha;
    const uint32_t material = add_material(desc, m);
    for (uint32_t k = 0; k < kSheets; ++k) {
        const float x = -1 + 2 * static_cast<float>(k) / kSheets;
        add_mesh(desc, quad_mesh({x, -1, -0.01f * static_cast<float>(k)}, {2, 0, 0}, {0, 2, 0}),
                 material);
    }
    desc.environment.color = Rgb(0.6f, 0.75f, 1);
    RenderWith with;
    with.width = with.height = kSheets * 2;
    with.passes = passes;
    const Camera camera = facing(1);
    const Rendering own = render(desc, camera, with);
    nonfinite += own.nonfinite;
    ImageRgba naive = own.image;
    for (uint32_t i = 0; i < naive.rgb.size(); ++i) {
        const uint32_t layers = i % with.width / 2 + 1;
        naive.rgb[i] =
            layers > 16 ? Rgb(0)
                        : desc.environment.color * std::pow(1 - kAlpha, static_cast<float>(layers));
    }
    return {naive, own.image, "g18-sheets.gltf", gltf_text(desc, camera, with.width, with.height)};
}

CaseResult run(Effort effort) {
    const bool full = effort == Effort::full;
    CaseResult result;
    result.measures.push_back(all_hits(full ? 1000000 : 100000));
    alpha_sheets(full ? 1000 : 64, full ? 14 : 24, result);
    glass_plates(full ? 30 : 5, full ? 200 : 20, result);
    if (full) glass_plates(1000, 8, result);
    matched_sheets(full ? 100000 : 5000, result);
    result.images.push_back(staircase(full ? 64 : 16, result.nonfinite));
    return result;
}

const bool kAdded = add_case(
    {"G18", Priority::p0, "thousands to millions of layers",
     "t + 1e-3; black beyond 16 layers or 16 events",
     "the layer that was left is excluded by identity, coverage is decided within one traversal, "
     "no "
     "cap on layers",
     "LuxCoreRender/LuxCore#124, GPUOpen-LibrariesAndSDKs/RadeonRays_SDK#47, chunky-dev/chunky#511",
     run});

}  // namespace
}  // namespace talbot::hardcases::g18
