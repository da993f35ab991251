// G14: the shadow terminator of coarse spheres with smooth normals under a sun.
#include <cmath>
#include <cstdint>
#include <numbers>

#include "app/hardcases/cases/case_run.h"
#include "app/hardcases/cases/case_scenes.h"
#include "core/integrate/surface_interaction.h"
#include "core/integrate/tiers.h"

namespace talbot::hardcases::g14 {
namespace {

using namespace geometry;

constexpr float kAlbedo = 0.8f;

// A sphere of the given latitudes under a sun at that angle from the line of sight.
struct Setup {
    SceneDesc desc;
    Camera camera;
    Vec3d sun;
};

Setup sphere_under_sun(uint32_t stacks, double degrees, bool smooth) {
    Setup setup;
    const double angle = degrees * std::numbers::pi / 180;
    // The camera looks along -Z.
    setup.sun = Vec3d(std::sin(angle) * 0.8, std::sin(angle) * 0.6, std::cos(angle));
    Mesh mesh = uv_sphere_mesh(stacks, 2 * stacks);
    if (!smooth) mesh.normals.clear();
    add_mesh(setup.desc, std::move(mesh), add_material(setup.desc, diffuse(Rgb(kAlbedo))));
    PunctualLight light;
    light.kind = PunctualKind::directional;
    light.direction = Vec3f(-setup.sun);
    light.intensity = kPi;
    setup.desc.lights.push_back(light);
    setup.camera.kind = CameraKind::orthographic;
    setup.camera.xmag = setup.camera.ymag = 1.05;
    look_at(setup.camera, Vec3d(0, 0, 5), Vec3d(0));
    return setup;
}

// Control: the smooth normal's cosine, cut off by the facets.
double naive_light(const Scene& scene, const SurfaceInteraction& si, const Vec3f& sun) {
    Ray shadow;
    shadow.o = offset_ray_origin(si.p, si.p_error, si.n_geometric, sun);
    shadow.d = sun;
    shadow.skip_from = si.id;
    if (!(talbot::dot(si.n_geometric, sun) > 0) || scene.accel().occluded(shadow)) return 0;
    return kAlbedo * std::max(0.0f, talbot::dot(si.shading.n, sun));
}

struct Band {
    double naive = 0, own = 0;                // RMSE within 10 degrees of the terminator
    uint64_t naive_rises = 0, own_rises = 0;  // towards the dark
    uint64_t naive_turns = 0, own_turns = 0;  // between light and black along the terminator
};

// Light along meridians of the sun, from 10 degrees before the terminator on: where it grows again.
template <class Light>
uint64_t rises(const std::vector<Vec3d>& line, const Light& light) {
    uint64_t count = 0;
    double last = INFINITY;
    for (const Vec3d& n : line) {
        const double value = light(n);
        // Slack: one part in a thousand of full light.
        if (value > last + 1e-3) ++count;
        last = value;
    }
    return count;
}

Band band_of(const Setup& setup, const RenderWith& with, CaseImages& images) {
    const Rendering own = render(setup.desc, setup.camera, with);
    const auto scene = Scene::build(setup.desc, workers());
    const CameraRays rays(setup.camera, scene->origin(), with.width, with.height, Bounds{});
    const Vec3f sun(setup.sun);
    images.own = own.image;
    images.naive = own.image;
    Band band;
    double pixels = 0;
    for (uint32_t i = 0; i < own.image.rgb.size(); ++i) {
        Hit hit;
        const Ray ray = rays.ray(static_cast<float>(i % with.width) + 0.5f,
                                 static_cast<float>(i / with.width) + 0.5f, Vec2f(0));
        images.naive.rgb[i] = Rgb(0);
        if (!scene->accel().closest(ray, hit)) continue;
        const auto si = make_surface_interaction<kMatteTier>(*scene, ray, hit);
        const double naive = naive_light(*scene, si, sun);
        images.naive.rgb[i] = Rgb(static_cast<float>(naive));
        const Vec3d n = normalize(Vec3d(si.p) + scene->origin());
        const double cosine = talbot::dot(n, setup.sun);
        if (std::abs(cosine) > std::sin(10 * std::numbers::pi / 180)) continue;
        // Pixels that see past the silhouette have no one point.
        if (own.film.pixels()[i].covered != own.film.pixels()[i].samples) continue;
        const double exact = kAlbedo * std::max(0.0, cosine);
        band.naive += (naive - exact) * (naive - exact);
        band.own += std::pow(double{own.image.rgb[i].x} - exact, 2);
        ++pixels;
    }
    band.naive = std::sqrt(band.naive / pixels);
    band.own = std::sqrt(band.own / pixels);
    return band;
}

// Light that a point seen straight from outside sends back, by the kernels' own steps.
double own_light(const Scene& scene, const SurfaceInteraction& si, const Vec3f& sun) {
    if (!(talbot::dot(si.n_surface(), sun) > 0) || scene.accel().occluded(si.spawn(sun))) return 0;
    return kAlbedo * std::max(0.0f, talbot::dot(si.shading.n, sun));
}

void count_rises(const Setup& setup, Band& band) {
    const auto scene = Scene::build(setup.desc, workers());
    const Vec3f sun(setup.sun);
    const Vec3d u = normalize(talbot::cross(setup.sun, Vec3d(0.3, 0.5, 0.7)));
    const Vec3d v = talbot::cross(setup.sun, u);
    for (int k = 0; k < 64; ++k) {
        const double phi = 2 * std::numbers::pi * k / 64;
        std::vector<Vec3d> line;
        for (double degrees = 60; degrees < 110; degrees += 0.25) {
            const double a = degrees * std::numbers::pi / 180;
            line.push_back(std::cos(a) * setup.sun +
                           std::sin(a) * (std::cos(phi) * u + std::sin(phi) * v));
        }
        const auto at = [&](const Vec3d& n, const auto& light) {
            Ray ray;
            ray.o = Vec3f(2.0 * n - scene->origin());
            ray.d = Vec3f(-n);
            Hit hit;
            if (!scene->accel().closest(ray, hit)) return 0.0;
            return light(*scene, make_surface_interaction<kMatteTier>(*scene, ray, hit), sun);
        };
        band.naive_rises += rises(line, [&](const Vec3d& n) { return at(n, naive_light); });
        band.own_rises += rises(line, [&](const Vec3d& n) { return at(n, own_light); });
    }
}

// Circles round the sun, 80 to 88 degrees from it: how often light turns black or back.
void count_turns(const Setup& setup, Band& band) {
    const auto scene = Scene::build(setup.desc, workers());
    const Vec3f sun(setup.sun);
    const Vec3d u = normalize(talbot::cross(setup.sun, Vec3d(0.3, 0.5, 0.7)));
    const Vec3d v = talbot::cross(setup.sun, u);
    for (const double degrees : {80.0, 84.0, 88.0}) {
        const double a = degrees * std::numbers::pi / 180;
        bool naive_before = true;
        bool own_before = true;
        for (int k = 0; k < 720; ++k) {
            const double phi = 2 * std::numbers::pi * k / 720;
            const Vec3d n =
                std::cos(a) * setup.sun + std::sin(a) * (std::cos(phi) * u + std::sin(phi) * v);
            Ray ray;
            ray.o = Vec3f(2.0 * n - scene->origin());
            ray.d = Vec3f(-n);
            Hit hit;
            if (!scene->accel().closest(ray, hit)) continue;
            const auto si = make_surface_interaction<kMatteTier>(*scene, ray, hit);
            const bool naive = naive_light(*scene, si, sun) > 0;
            const bool own = own_light(*scene, si, sun) > 0;
            band.naive_turns += naive != naive_before;
            band.own_turns += own != own_before;
            naive_before = naive;
            own_before = own;
        }
    }
}

// Facets whose normals the file repeats: no point of them may be lifted.
uint64_t lifted_flat_points(uint64_t rays) {
    const Setup flat = sphere_under_sun(8, 75, false);
    const Mesh& mesh = flat.desc.meshes[0];
    Mesh told;
    for (size_t i = 0; i < mesh.indices.size(); ++i) {
        told.positions.push_back(mesh.positions[mesh.indices[i]]);
        told.indices.push_back(static_cast<uint32_t>(i));
    }
    for (size_t i = 0; i < told.positions.size(); i += 3) {
        const Vec3f n = safe_normalize(stable_cross(told.positions[i + 1] - told.positions[i],
                                                    told.positions[i + 2] - told.positions[i]),
                                       Vec3f(0, 0, 1));
        told.normals.insert(told.normals.end(), 3, n);
    }
    SceneDesc desc;
    add_mesh(desc, told, add_material(desc, diffuse(Rgb(kAlbedo))));
    const auto scene = Scene::build(desc, workers());
    const Failures lifted = over_inputs<Failures>(4, rays, [&](Rng& rng, Failures& failures) {
        Ray ray;
        ray.o = 3.0f * rng.direction();
        ray.d = 0.5f * rng.direction() - ray.o;
        Hit hit;
        if (!scene->accel().closest(ray, hit)) return;
        const auto si = make_surface_interaction<kMatteTier>(*scene, ray, hit);
        failures.see(false, si.is_lifted(), [&] { return hex(ray); });
    });
    return lifted.own;
}

CaseResult run(Effort effort) {
    const bool full = effort == Effort::full;
    CaseResult result;
    RenderWith with;
    with.width = with.height = full ? 128 : 96;
    with.passes = full ? 16 : 4;
    double worst_ratio = 0;
    Band all;
    std::string where;
    Sweep sweep{"angle between sun and line of sight, degrees; sphere of 8 x 16",
                "RMSE near the terminator",
                false,
                std::nan(""),
                {}};
    for (const uint32_t stacks : {8u, 16u, 32u}) {
        for (const double degrees : {60.0, 70.0, 80.0, 88.0}) {
            const Setup setup = sphere_under_sun(stacks, degrees, true);
            CaseImages images;
            Band band = band_of(setup, with, images);
            count_rises(setup, band);
            count_turns(setup, band);
            if (band.own / band.naive > worst_ratio) {
                worst_ratio = band.own / band.naive;
                where = line("sphere of %u x %u, sun at %g degrees", stacks, 2 * stacks, degrees);
            }
            all.naive_rises += band.naive_rises;
            all.own_rises += band.own_rises;
            all.naive_turns += band.naive_turns;
            all.own_turns += band.own_turns;
            if (stacks == 8) sweep.points.push_back({degrees, band.naive, band.own});
            if (stacks == 8 && degrees == 70) {
                images.scene_file_name = "g14-coarse-sphere.gltf";
                images.scene_gltf = gltf_text(setup.desc, setup.camera, with.width, with.height);
                result.images.push_back(images);
            }
        }
    }
    result.measures.push_back({"RMSE within 10 degrees of the terminator, of that without a remedy",
                               1, worst_ratio, 0.4, Gate::at_most, where});
    result.measures.push_back({"places where light grows towards the dark, on 64 meridians",
                               static_cast<double>(all.naive_rises),
                               static_cast<double>(all.own_rises), 0, Gate::at_most, ""});
    result.measures.push_back({"turns between light and black along circles round the sun",
                               static_cast<double>(all.naive_turns),
                               static_cast<double>(all.own_turns), 0, Gate::at_most, ""});
    result.measures.push_back({"lifted points of flat facets with normals in the file", NAN,
                               static_cast<double>(lifted_flat_points(inputs(effort, 1e5, 2e6))), 0,
                               Gate::at_most, ""});
    result.sweeps = {sweep};
    return result;
}

const bool kAdded = add_case(
    {"G14", Priority::p0, "shadow terminator of smooth normals", "facets cast shadows as they are",
     "rays leave from the round surface that the normals describe (Hanika 2021, Ray Tracing Gems "
     "II, "
     "chapter 4)",
     "mitsuba-renderer/mitsuba3#885, nvpro-samples/vk_gltf_renderer#42, RenderKit/ospray#75", run});

}  // namespace
}  // namespace talbot::hardcases::g14
