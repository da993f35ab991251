// G17: inputs that break builders: equal, nested, collinear and exponentially spread triangles.
#include <cmath>
#include <cstdint>
#include <functional>

#include "app/hardcases/cases/case_run.h"
#include "app/hardcases/cases/mesh_shapes.h"
#include "core/geometry/bvh.h"

namespace talbot::hardcases::g17 {
namespace {

using namespace geometry;

// Control: depth of a tree that halves the longest side of the centroids' box down to one triangle
// a leaf, without any way out; `cap` stands for endless.
uint32_t naive_depth(const MeshData& mesh, uint32_t cap) {
    std::vector<Vec3f> centroids;
    for (size_t i = 0; i < mesh.triangles(); ++i) {
        const auto t = mesh.triangle(i);
        centroids.push_back((t[0] + t[1] + t[2]) / 3.0f);
    }
    struct Range {
        size_t begin, end;
        uint32_t depth;
    };
    std::vector<Range> stack = {{0, centroids.size(), 0}};
    uint32_t deepest = 0;
    while (!stack.empty()) {
        const Range range = stack.back();
        stack.pop_back();
        deepest = std::max(deepest, range.depth);
        if (deepest >= cap) return cap;
        if (range.end - range.begin <= 1) continue;
        Bounds box;
        for (size_t i = range.begin; i < range.end; ++i) box.add(centroids[i]);
        const Vec3f size = box.upper - box.lower;
        const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
        const float middle = 0.5f * box.lower[axis] + 0.5f * box.upper[axis];
        const auto split =
            std::partition(centroids.begin() + static_cast<std::ptrdiff_t>(range.begin),
                           centroids.begin() + static_cast<std::ptrdiff_t>(range.end),
                           [&](const Vec3f& c) { return c[axis] < middle; });
        const auto at = static_cast<size_t>(split - centroids.begin());
        if (at == range.begin || at == range.end) return cap;  // the same range again, for ever
        stack.push_back({range.begin, at, range.depth + 1});
        stack.push_back({at, range.end, range.depth + 1});
    }
    return deepest;
}

struct Input {
    const char* name;
    MeshData mesh;
    uint64_t rays;
    bool timed = false;
};

std::vector<Input> make_inputs(bool full) {
    std::vector<Input> list;
    const int many = full ? 300000 : 60000;
    const uint64_t few_rays = full ? 40 : 12;
    MeshData equal;
    for (int i = 0; i < many; ++i) equal.add_triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    list.push_back({"identical triangles", std::move(equal), few_rays, true});
    MeshData powers;
    for (int j = -120; j <= 120; ++j) {
        const float s = std::ldexp(1.0f, j);
        powers.add_triangle({s, 0, 0}, {1.5f * s, s, 0}, {s, 0, s});
    }
    list.push_back({"centroids at powers of two", std::move(powers), full ? 30000u : 3000u, false});
    MeshData shells;
    const MeshData shell = displaced_sphere(2, 0);
    for (int j = 0; j < 24; ++j) {
        MeshData scaled = shell;
        for (Vec3f& p : scaled.positions) p *= std::ldexp(1.0f, j - 12);
        shells.add(scaled);
    }
    list.push_back({"concentric shells", std::move(shells), full ? 20000u : 2000u, false});
    MeshData collinear;
    for (int i = 0; i < (full ? 100000 : 30000); ++i) {
        const auto x = static_cast<float>(i);
        collinear.add_triangle({x, 0, 0}, {x + 0.5f, 0.25f, 0}, {x, 0, 0.5f});
    }
    list.push_back({"collinear centroids", std::move(collinear), few_rays, true});
    MeshData nested;
    for (int i = 1; i < 500; ++i) {
        const auto s = static_cast<float>(i);
        nested.add_quad({-s, -s, 0}, {s, -s, 0}, {s, s, 0}, {-s, s, 0});
    }
    list.push_back(
        {"equal centroids of every size", std::move(nested), full ? 10000u : 500u, false});
    for (int n = 0; n <= 2; ++n) {
        MeshData small;
        for (int i = 0; i < n; ++i) {
            const auto z = static_cast<float>(i);
            small.add_triangle({0, 0, z}, {1, 0, z}, {0, 1, z});
        }
        list.push_back(
            {"none, one or two triangles", std::move(small), full ? 100000u : 1000u, false});
    }
    return list;
}

Failures against_brute_force(const Input& input, const SceneData& scene, const Accel& accel,
                             uint64_t seed) {
    const auto oracle = build_brute_force(scene.input());
    Bounds box = accel.bounds();
    if (box.is_empty()) box = {Vec3f(-1), Vec3f(1)};
    return over_inputs<Failures>(
        seed, input.rays,
        [&](Rng& rng, Failures& failures) {
            Ray ray;
            ray.o = 0.5f * (box.lower + box.upper) + rng.in_box(-1, 1) * (box.upper - box.lower);
            Vec3f target = box.lower + rng.in_box(0, 1) * (box.upper - box.lower);
            if (input.mesh.triangles() > 0 && rng.below(2) != 0) {
                const auto t =
                    input.mesh.triangle(rng.below(static_cast<uint32_t>(input.mesh.triangles())));
                target = (t[0] + t[1] + t[2]) / 3.0f;
                ray.o = target + rng.in_box(-2, 2) * length(t[1] - t[0]);
            }
            ray.d = target - ray.o;
            Hit hit;
            Hit expected;
            const bool expect = oracle->closest(ray, expected);
            const bool own = accel.closest(ray, hit) != expect || !same_hit(hit, expected) ||
                             accel.occluded(ray) != expect;
            failures.see(false, own, [&] { return input.name + (": " + hex(ray)); });
        },
        4);
}

// Time of building over that of as many random triangles; the best of some attempts in turn.
double build_ratio(const SceneData& scene, size_t triangles) {
    const SceneData random = scene_of(soup(triangles, 0.01f, 1));
    double own = INFINITY;
    double other = INFINITY;
    for (int i = 0; i < 5; ++i) {
        own = std::min(own, build_here(scene)->stats().build_seconds);
        other = std::min(other, build_here(random)->stats().build_seconds);
        if (i > 0 && own <= 5 * other) break;
    }
    return own / other;
}

CaseResult run(Effort effort) {
    constexpr uint32_t kEndless = 1000000;
    CaseResult result;
    Failures wrong;
    double deepest = 0;
    double naive_deepest = 0;
    double ratio = 0;
    std::string where;
    uint64_t seed = 0;
    for (const Input& input : make_inputs(effort == Effort::full)) {
        const SceneData scene = scene_of(input.mesh);
        for (const BuildQuality quality : {BuildQuality::fast, BuildQuality::high}) {
            const auto accel = build_here(scene, quality);
            wrong.merge(against_brute_force(input, scene, *accel, ++seed));
            deepest = std::max<double>(deepest, accel->stats().depth);
        }
        if (input.mesh.triangles() > 0) {
            const double depth = naive_depth(input.mesh, kEndless);
            naive_deepest = std::max<double>(naive_deepest, depth < kEndless ? depth : INFINITY);
        }
        if (input.timed) {
            const double r = build_ratio(scene, input.mesh.triangles());
            if (r > ratio) where = input.name;
            ratio = std::max(ratio, r);
        }
    }
    Measure hits = wrong.measure("hits that differ from brute force");
    hits.naive = NAN;
    result.measures.push_back(hits);
    result.measures.push_back({"depth of the tree (cap of its stack)", naive_deepest, deepest,
                               kMaxDepth, Gate::at_most, ""});
    result.measures.push_back(
        {"time of the build over that of random triangles", NAN, ratio, 5, Gate::at_most, where});
    return result;
}

const bool kAdded = add_case(
    {"G17", Priority::p0, "degenerate and deep trees",
     "halving the centroids' box without a way out",
     "ranges are halved by count from a fixed depth on, the stack is sized for that",
     "jbikker/tinybvh#164, jbikker/tinybvh#192, bepu/bepuphysics2#354, svenstaro/bvh#136", run});

}  // namespace
}  // namespace talbot::hardcases::g17
