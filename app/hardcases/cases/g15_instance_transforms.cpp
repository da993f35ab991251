// G15: mirrored, squeezed, stretched and sheared instances against the mesh transformed beforehand
// in double; flattened ones against the flat mesh.
#include <cmath>
#include <cstdint>

#include "app/hardcases/cases/case_run.h"
#include "app/hardcases/cases/case_scenes.h"
#include "app/hardcases/cases/mesh_shapes.h"
#include "core/integrate/surface_interaction.h"
#include "core/integrate/tiers.h"
#include "core/math/robust.h"

namespace talbot::hardcases::g15 {
namespace {

using namespace geometry;

struct Transform {
    const char* name;
    Mat4d world;
};

std::vector<Transform> transforms() {
    const auto stretch = [](double x, double y, double z) {
        Mat4d m(1.0);
        m[0][0] = x;
        m[1][1] = y;
        m[2][2] = z;
        return m;
    };
    Mat4d turn(1.0);
    turn[0] = Vec4d(0.36, 0.48, -0.8, 0);
    turn[1] = Vec4d(-0.8, 0.6, 0, 0);
    turn[2] = Vec4d(0.48, 0.64, 0.6, 0);
    Mat4d shear(1.0);
    shear[1][0] = 100;
    return {{"mirror (1, 1, -1)", stretch(1, 1, -1)},
            {"turned mirror", turn * stretch(-1, 1, 1)},
            {"scale (2, 1, 1)", turn * stretch(2, 1, 1)},
            {"scale (1, 1e-7, 1)", stretch(1, 1e-7, 1)},
            {"scale (1e6, 1, 1e-6)", stretch(1e6, 1, 1e-6)},
            {"shear by 100", shear},
            {"mirror, scale and move",
             translation(Vec3d(1e4, -2e4, 3e4)) * turn * stretch(0.1, 0.2, -3)}};
}

// Crossings along the ray by plain double arithmetic on the transformed mesh.
struct Crossing {
    double t;
    Vec3d n;  // unit, of the winding, which a mirror turns
    bool entering;
};

struct Truth {
    std::vector<Crossing> crossings;
    double margin = 1;  // least barycentric distance from an edge
};

#ifdef __clang__
#define TALBOT_OPAQUE [[gnu::noinline]]
#else
#define TALBOT_OPAQUE [[gnu::noipa]]
#endif

// Not inlined: GCC 12 would see through the rounding of the ray to float.
TALBOT_OPAQUE Truth crossings(const Mesh& mesh, const Mat4d& world, const Ray& ray) {
    const Vec3d o(ray.o);
    const Vec3d d(ray.d);
    const double side = glm::determinant(Mat3d(world)) < 0 ? -1 : 1;
    Truth truth;
    for (size_t i = 0; i < mesh.triangle_count(); ++i) {
        Vec3d p[3];
        for (size_t k = 0; k < 3; ++k)
            p[k] = Vec3d(world * Vec4d(Vec3d(mesh.positions[mesh.indices[3 * i + k]]), 1));
        const Vec3d e1 = p[1] - p[0];
        const Vec3d e2 = p[2] - p[0];
        const Vec3d q = talbot::cross(d, e2);
        const double det = talbot::dot(e1, q);
        if (det == 0) continue;
        const Vec3d s = o - p[0];
        const double u = talbot::dot(s, q) / det;
        const Vec3d r = talbot::cross(s, e1);
        const double v = talbot::dot(d, r) / det;
        const double t = talbot::dot(e2, r) / det;
        const double least = std::min(u, std::min(v, 1 - u - v));
        if (t > 0) truth.margin = std::min(truth.margin, std::abs(least));
        if (!(t > 0) || least < 0) continue;
        const Vec3d n = side * normalize(talbot::cross(e1, e2));
        truth.crossings.push_back({t, n, talbot::dot(n, d) < 0});
    }
    std::sort(truth.crossings.begin(), truth.crossings.end(),
              [](const Crossing& a, const Crossing& b) { return a.t < b.t; });
    return truth;
}

struct After {
    float t = -1;
    PrimitiveId id{};
};
bool is_after(const void* context, const Ray&, const Hit& hit) {
    const After& last = *static_cast<const After*>(context);
    if (hit.t != last.t) return hit.t > last.t;
    return hit.id.instance != last.id.instance ? hit.id.instance > last.id.instance
                                               : hit.id.primitive > last.id.primitive;
}

struct Score {
    Failures parity;  // number of crossings, or whether each enters or leaves
    Largest depth;    // relative to the last crossing
    Largest normal;
    void merge(const Score& later) {
        parity.merge(later.parity);
        depth.merge(later.depth);
        normal.merge(later.normal);
    }
};

// The bumpy ball twice, so that it stays an instance; the second far away.
SceneDesc twice(const Mesh& mesh, const Mat4d& world) {
    SceneDesc desc;
    add_mesh(desc, mesh, add_material(desc, glass(1.5f, Rgb(1), kInfinity)), world);
    desc.objects.push_back({"second"});
    desc.instances.push_back({0, 1, translation(Vec3d(0, 1e7, 0))});
    return desc;
}

void see_transform(const Mesh& mesh, const Transform& transform, uint64_t seed, uint64_t rays,
                   Score& all) {
    const auto scene = Scene::build(twice(mesh, transform.world), workers());
    Mat4d world = transform.world;
    world[3] -= Vec4d(scene->origin(), 0);
    all.merge(over_inputs<Score>(seed, rays, [&](Rng& rng, Score& score) {
        const auto at = [&](const Vec3d& p) { return Vec3d(world * Vec4d(p, 1)); };
        Ray ray;
        ray.o = Vec3f(at(3.0 * Vec3d(rng.direction())));
        ray.d = Vec3f(at(Vec3d(rng.in_box(-1, 1))) - Vec3d(ray.o));
        const Truth truth = crossings(mesh, world, ray);
        if (truth.margin < 1e-3) return;
        const auto where = [&] { return transform.name + (": " + hex(ray)); };
        After last;
        Hit hit;
        size_t n = 0;
        bool wrong = false;
        bool naive_wrong = false;
        while (scene->accel().closest(ray, hit, {is_after, &last})) {
            last = {hit.t, hit.id};
            if (hit.id.instance != 0) continue;
            if (n >= truth.crossings.size()) {
                wrong = true;
                break;
            }
            const Crossing& c = truth.crossings[n++];
            score.depth.see(0, std::abs(hit.t - c.t) / truth.crossings.back().t, where);
            const auto si = make_surface_interaction<kMatteTier>(*scene, ray, hit);
            wrong = wrong || si.front != c.entering;
            // Control: mat3(M) n.
            const uint32_t* index = &mesh.indices[size_t{3} * hit.id.primitive];
            const Vec3d object =
                talbot::cross(Vec3d(mesh.positions[index[1]]) - Vec3d(mesh.positions[index[0]]),
                              Vec3d(mesh.positions[index[2]]) - Vec3d(mesh.positions[index[0]]));
            const Vec3d naive = normalize(Mat3d(world) * object);
            naive_wrong = naive_wrong || (talbot::dot(naive, Vec3d(ray.d)) < 0) != c.entering;
            score.normal.see(length(naive - c.n), length(Vec3d(si.n_geometric) - c.n), where);
        }
        score.parity.see(naive_wrong, wrong || n != truth.crossings.size(), where);
    }));
}

struct Singular {
    uint64_t hidden = UINT64_MAX;  // pixels that an instance changes that is squeezed to a line
    uint64_t flat = UINT64_MAX;    // and in which a flattened one is not the mesh flattened before
};

Singular see_singular(uint64_t& nonfinite) {
    SceneDesc desc;
    const uint32_t grey = add_material(desc, diffuse(Rgb(0.6f)));
    add_mesh(desc, uv_sphere_mesh(8, 16), grey);
    desc.environment.color = Rgb(1);
    Camera camera;
    look_at(camera, Vec3d(0.4, 0.5, 4), Vec3d(0));
    RenderWith with;
    with.width = with.height = 48;
    with.passes = 2;
    const auto read = [&](const SceneDesc& scene) {
        return load_text(gltf_text(scene, camera, with.width, with.height));
    };
    const auto differing = [&](const SceneDesc& a, const SceneDesc& b) {
        const Rendering first = render(a, camera, with);
        const Rendering second = render(b, camera, with);
        nonfinite += first.nonfinite + second.nonfinite;
        return differing_pixels(first, second);
    };
    SceneDesc lined = desc;
    Mat4d line(1.0);
    line[1][1] = line[2][2] = 0;
    lined.instances.push_back({0, 0, line});
    SceneDesc turned = desc;
    Mat4d flat(1.0);
    flat[2][2] = 0;
    flat[3] = Vec4d(0.5, 0, 1.5, 1);
    turned.instances.push_back({0, 0, flat});
    SceneDesc before = desc;
    before.meshes.push_back(before.meshes[0]);
    for (Vec3f& n : before.meshes[1].normals) n = Vec3f(0, 0, 1);
    for (Vec3f& p : before.meshes[1].positions) p.z *= static_cast<float>(kFlatLayerShare);
    before.instances.push_back({1, 0, translation(Vec3d(flat[3]))});
    const Result<SceneDesc> alone = read(desc);
    const Result<SceneDesc> with_line = read(lined);
    const Result<SceneDesc> with_flat = read(turned);
    const Result<SceneDesc> with_before = read(before);
    Singular result;
    if (!alone || !with_line || !with_flat || !with_before) return result;
    result.hidden = differing(*alone, *with_line);
    result.flat = differing(*with_before, *with_flat);
    if (differing(*alone, *with_flat) == 0) result.flat = UINT64_MAX;
    return result;
}

CaseResult run(Effort effort) {
    CaseResult result;
    const MeshData ball = displaced_sphere(10, 0.2f);
    Mesh mesh;
    mesh.positions = ball.positions;
    mesh.indices = ball.indices;
    Score all;
    uint64_t seed = 0;
    for (const Transform& transform : transforms())
        see_transform(mesh, transform, ++seed, inputs(effort, 1200, 20000), all);
    Measure depth = all.depth.measure("error of depth, relative", 1e-5);
    depth.naive = NAN;
    result.measures.push_back(depth);
    result.measures.push_back(all.normal.measure("error of the unit normal", 1e-5));
    result.measures.push_back(all.parity.measure("rays that count, enter or leave wrongly"));
    const Singular singular = see_singular(result.nonfinite);
    result.measures.push_back({"pixels that an instance squeezed to a line changes", NAN,
                               static_cast<double>(singular.hidden), 0, Gate::at_most, ""});
    result.measures.push_back({"pixels where a flattened instance is not the flat mesh", NAN,
                               static_cast<double>(singular.flat), 0, Gate::at_most, ""});
    return result;
}

const bool kAdded =
    add_case({"G15", Priority::p0, "mirrored, squeezed and sheared instances", "normals by mat3(M)",
              "inverse in double, normals by the cofactor matrix with the sign of the determinant; "
              "flattened instances as meshes of their own",
              "google/filament#3001, NVIDIA-RTX/Donut#3, LuxCoreRender/LuxCore#300, "
              "KhronosGroup/ANARI-SDK#8",
              run});

}  // namespace
}  // namespace talbot::hardcases::g15
