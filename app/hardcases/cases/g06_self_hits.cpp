// G06: rays that leave a triangle or a sphere must not hit it again, whatever its size, place,
// instance or the angle.
#include <cmath>
#include <cstdint>
#include <numbers>

#include "app/hardcases/cases/case_run.h"
#include "app/hardcases/cases/case_scenes.h"
#include "app/hardcases/cases/naive_render.h"
#include "app/hardcases/cases/spawned_rays.h"

namespace talbot::hardcases::g06 {
namespace {

using namespace geometry;

float log_uniform(Rng& rng, float low, float high) {
    return std::pow(10.0f, rng.uniform(low, high));
}

constexpr int kTriangles = 1100;  // so many that two instances share the mesh

// Triangles of size 1e-6 to 1e6 at 0 to 1e6 from the origin, as they are or under two transforms.
void see_triangles(Rng& rng, bool instanced, SpawnScore& score) {
    Mesh mesh;
    for (int i = 0; i < kTriangles; ++i) {
        const float size = log_uniform(rng, -6, 6);
        const Vec3f at = rng.below(4) == 0 ? Vec3f(0) : rng.direction() * log_uniform(rng, -6, 6);
        for (int k = 0; k < 3; ++k) {
            mesh.positions.push_back(at + size * rng.in_box(-1, 1));
            mesh.indices.push_back(static_cast<uint32_t>(mesh.indices.size()));
        }
    }
    SceneDesc desc;
    const uint32_t material = add_material(desc, diffuse(Rgb(0.5f)));
    add_mesh(desc, mesh, material);
    if (instanced) {
        for (int i = 0; i < 2; ++i) {
            Mat4d m(1.0);
            do {
                for (int c = 0; c < 3; ++c) m[c] = Vec4d(Vec3d(rng.in_box(-2, 2)), 0);
            } while (std::abs(glm::determinant(Mat3d(m))) < 0.1);
            m[3] = Vec4d(Vec3d(rng.in_box(-100, 100)), 1);
            if (i == 0) {
                desc.instances[0].world_from_object = m;
            } else {
                desc.objects.push_back({"second"});
                desc.instances.push_back({0, 1, m});
            }
        }
    }
    WorkerPool pool(1);
    SceneBuildOptions options;
    options.quality = BuildQuality::fast;
    const auto scene = Scene::build(desc, pool, options);
    for (int i = 0; i < 8 * kTriangles; ++i) {
        const uint32_t instance = rng.below(static_cast<uint32_t>(desc.instances.size()));
        const SceneInstance& placed = scene->geometry().instances[instance];
        const Mesh& stored = scene->geometry().meshes[placed.mesh];
        Vec3d world[3];
        const uint32_t triangle = rng.below(kTriangles);
        for (uint32_t k = 0; k < 3; ++k) {
            const Vec3d p(stored.positions[3 * triangle + k]);
            world[k] = Vec3d(placed.world_from_object * Vec4d(p, 1));
        }
        double b0 = rng.uniform();
        double b1 = rng.uniform();
        if (b0 + b1 > 1) {
            b0 = 1 - b0;
            b1 = 1 - b1;
        }
        const Vec3d target = b0 * world[0] + b1 * world[1] + (1 - b0 - b1) * world[2];
        const Vec3d normal = talbot::cross(world[1] - world[0], world[2] - world[0]);
        if (!(length(normal) > 0)) continue;
        const double size = length(world[1] - world[0]);
        Ray ray;
        ray.o = Vec3f(target + size * (normalize(normal) + Vec3d(rng.in_box(-0.5f, 0.5f))));
        ray.d = Vec3f(target - Vec3d(ray.o));
        if (length(Vec3d(ray.d)) > 0) spawn(*scene, ray, rng, score);
    }
}

void see_spheres(Rng& rng, SpawnScore& score) {
    SceneDesc desc;
    const uint32_t material = add_material(desc, diffuse(Rgb(0.5f)));
    for (int i = 0; i < 500; ++i) {
        const double radius = log_uniform(rng, -6, 6);
        const double away = rng.below(4) == 0 ? 0.0 : log_uniform(rng, -6, 6);
        add_sphere(desc, Vec3d(rng.direction()) * away, radius, material);
    }
    WorkerPool pool(1);
    const auto scene = Scene::build(desc, pool);
    for (uint32_t i = 0; i < desc.spheres.size(); ++i) {
        const Sphere& sphere = scene->geometry().spheres[i];
        const Vec3d n(rng.direction());
        Ray ray;
        ray.o = Vec3f(sphere.center + sphere.radius * (2.0 * n + Vec3d(rng.in_box(-0.3f, 0.3f))));
        ray.d = Vec3f(sphere.center + sphere.radius * 0.9 * Vec3d(rng.direction()) - Vec3d(ray.o));
        if (!(length(Vec3d(ray.d)) > 0)) continue;
        spawn(*scene, ray, rng, score);
    }
}

CaseImages pictures(Effort effort, uint64_t& nonfinite) {
    RenderWith with;
    with.width = with.height = effort == Effort::full ? 128 : 64;
    with.passes = effort == Effort::full ? 32 : 8;
    // In units of a ten thousandth: what a CAD file in micrometres is when it is read as metres.
    constexpr double kScale = 1e-4;
    const SceneDesc desc = scaled(plain_desc(), kScale);
    const Camera camera = scaled(cornell_camera(), kScale);
    const Rendering own = render(desc, camera, with);
    nonfinite += own.nonfinite;
    return {naive_render(desc, camera, with, 1e-4f), own.image, "g06-small-room.gltf",
            gltf_text(desc, camera, with.width, with.height)};
}

CaseResult run(Effort effort) {
    CaseResult result;
    const auto many = [&](uint64_t seed, double quick, double full, const auto& body) {
        return over_inputs<SpawnScore>(seed, inputs(effort, quick, full), body, 1);
    };
    SpawnScore plain =
        many(1, 8, 120, [](Rng& rng, SpawnScore& score) { see_triangles(rng, false, score); });
    SpawnScore instanced =
        many(2, 4, 60, [](Rng& rng, SpawnScore& score) { see_triangles(rng, true, score); });
    SpawnScore spheres = many(3, 40, 2000, see_spheres);
    const auto add = [&](const char* what, const SpawnScore& score) {
        result.measures.push_back(score.epsilon.measure(std::string("self-hits on ") + what +
                                                        " against 1e-4 along the ray"));
        result.measures.push_back(
            score.nothing.measure(std::string("self-hits on ") + what + " against no offset"));
        const auto n = static_cast<double>(score.count);
        result.measures.push_back(
            {std::string("mean offset on ") + what + ", in eps times the largest coordinate",
             score.naive_offsets / n, score.offsets / n, 16, Gate::at_most, ""});
    };
    add("triangles", plain);
    add("instances", instanced);
    add("spheres", spheres);
    result.images.push_back(pictures(effort, result.nonfinite));
    return result;
}

const bool kAdded = add_case(
    {"G06", Priority::p0, "rays that leave a surface do not hit it again",
     "1e-4 along the ray; no offset at all",
     "offset by the point's own error bound (Pharr, Jakob, Humphreys 2023, section 6.8) and the "
     "primitive left out by identity",
     "mitsuba-renderer/mitsuba3#1962, LuxCoreRender/LuxCore#79, appleseedhq/appleseed#2718, "
     "knightcrawler25/GLSL-PathTracer#35",
     run});

}  // namespace
}  // namespace talbot::hardcases::g06
