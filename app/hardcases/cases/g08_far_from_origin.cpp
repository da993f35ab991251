// G08: the same scene at 1e5 to 1e7 from the origin, as a transform in double and as float
// vertices.
#include <cmath>
#include <cstdint>

#include "app/hardcases/cases/case_run.h"
#include "app/hardcases/cases/case_scenes.h"
#include "app/hardcases/cases/spawned_rays.h"

namespace talbot::hardcases::g08 {
namespace {

using namespace geometry;

const Vec3d kFar[] = {Vec3d(1e5), Vec3d(1e6), Vec3d(1e7, -1e7, 1e7)};

// Every length a multiple of 2^-10, so that T + x is exact in double and moves nothing.
SceneDesc representable(SceneDesc desc) {
    constexpr double kGrid = 1024;
    for (MeshInstance& instance : desc.instances) {
        for (int c = 0; c < 4; ++c) {
            for (int r = 0; r < 3; ++r) {
                double& x = instance.world_from_object[c][r];
                x = std::round(x * kGrid) / kGrid;
            }
        }
    }
    for (Mesh& mesh : desc.meshes) {
        for (Vec3f& p : mesh.positions) p = Vec3f(glm::round(Vec3d(p) * kGrid) / kGrid);
    }
    for (Sphere& sphere : desc.spheres) sphere.center = glm::round(sphere.center * kGrid) / kGrid;
    return desc;
}

// Vertices in float world coordinates, as tools without transforms write them.
SceneDesc baked(SceneDesc desc, const Vec3d& by) {
    for (MeshInstance& instance : desc.instances) {
        Mesh& mesh = desc.meshes[instance.mesh];
        const Mat3d linear(instance.world_from_object);
        for (Vec3f& p : mesh.positions)
            p = Vec3f(linear * Vec3d(p) + Vec3d(instance.world_from_object[3]) + by);
        for (Vec3f& n : mesh.normals) n = normalize(Vec3f(linear * Vec3d(n)));
        instance.world_from_object = Mat4d(1.0);
    }
    for (Sphere& sphere : desc.spheres) sphere.center = Vec3d(Vec3f(sphere.center + by));
    return desc;
}

// A closed room of 40 m, black inside, in a bright world: any light is a leak.
SceneDesc leak_room() {
    SceneDesc desc;
    const uint32_t black = add_material(desc, diffuse(Rgb(0)));
    add_mesh(desc, uv_sphere_mesh(48, 96), black, scaling(20));
    desc.meshes[0].normals.clear();
    desc.environment.color = Rgb(1e9f);
    return desc;
}

// Rays that leave the walls of such a room.
SpawnScore self_hits(const Vec3d& by, uint64_t rays) {
    SceneDesc desc = baked(cornell_desc(), by);
    for (Mesh& mesh : desc.meshes) mesh.normals.clear();
    const auto scene = Scene::build(desc, workers());
    const Vec3f middle(by - scene->origin());
    return over_inputs<SpawnScore>(5, rays, [&](Rng& rng, SpawnScore& score) {
        Ray ray;
        ray.o = middle + rng.in_box(-0.5f, 0.5f);
        ray.d = rng.direction();
        spawn(*scene, ray, rng, score);
    });
}

CaseResult run(Effort effort) {
    const bool full = effort == Effort::full;
    CaseResult result;
    RenderWith with;
    with.width = with.height = full ? 96 : 40;
    with.passes = full ? 16 : 8;
    const SceneDesc desc = cornell_desc();
    const Camera camera = cornell_camera();
    const Rendering here = render(desc, camera, with);
    const SceneDesc exact = representable(desc);
    const Rendering exact_here = render(exact, camera, with);
    Sweep sweep{"distance from the origin, room of 2 m",
                "relMSE against the scene at the origin",
                true,
                1e-6,
                {}};
    double worst = 0;
    double naive_worst = 0;
    uint64_t changed = 0;
    uint64_t naive_changed = 0;
    for (const Vec3d& by : kFar) {
        const Rendering there = render(moved(desc, by), moved(camera, by), with);
        const Rendering control = render(baked(desc, by), moved(camera, by), with);
        const double own = relmse(there.image, here.image);
        const double naive = relmse(control.image, here.image);
        worst = std::max(worst, own);
        naive_worst = std::max(naive_worst, naive);
        sweep.points.push_back({length(by), naive, own});
        result.nonfinite += there.nonfinite + control.nonfinite;
        changed += differing_pixels(render(moved(exact, by), moved(camera, by), with), exact_here);
        naive_changed +=
            differing_pixels(render(baked(exact, by), moved(camera, by), with), exact_here);
        if (&by == &kFar[1]) {
            result.images.push_back(
                {control.image, there.image, "g08-far-room.gltf",
                 gltf_text(moved(desc, by), moved(camera, by), with.width, with.height)});
        }
    }
    result.measures.push_back({"relMSE of a scene moved by 1e5 to 1e7, against unmoved",
                               naive_worst, worst, 1e-6, Gate::at_most, ""});
    result.measures.push_back({"pixels that change where the sum with T is exact",
                               static_cast<double>(naive_changed), static_cast<double>(changed), 0,
                               Gate::at_most, ""});
    // Vertices that are far away in the file itself: nothing may leak or be lost.
    uint64_t leaks = 0;
    SpawnScore spawned;
    uint64_t nonfinite = 0;
    RenderWith inside = with;
    inside.passes = full ? 16 : 4;
    for (const Vec3d& by : {Vec3d(1e5), Vec3d(1e6), Vec3d(1e7, -1e7, 1e7)}) {
        Camera at;
        look_at(at, by, by + Vec3d(0.3, 0.2, 1));
        const Rendering room = render(baked(leak_room(), by), at, inside);
        for (const Rgb& c : room.image.rgb) leaks += !is_black(c);
        nonfinite += room.nonfinite;
        spawned.merge(self_hits(by, inputs(effort, 2e4, 1e6)));
    }
    result.nonfinite += nonfinite;
    result.measures.push_back({"leaking pixels of closed rooms with float vertices at 1e5 to 1e7",
                               NAN, static_cast<double>(leaks), 0, Gate::at_most, ""});
    result.measures.push_back({"unusable samples in such rooms", NAN,
                               static_cast<double>(nonfinite), 0, Gate::at_most, ""});
    result.measures.push_back(
        spawned.nothing.measure("self-hits in such a room, against no offset"));
    result.sweeps = {sweep};
    return result;
}

const bool kAdded = add_case(
    {"G08", Priority::p0, "scenes far from the origin", "vertices in float world coordinates",
     "transforms composed in double, the scene re-centred before it becomes float",
     "Blender T43835, LuxCoreRender/LuxCore#327, gkjohnson/three-gpu-pathtracer#678, "
     "mmp/pbrt-v3#265",
     run});

}  // namespace
}  // namespace talbot::hardcases::g08
