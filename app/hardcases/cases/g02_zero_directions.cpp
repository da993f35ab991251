// G02: directions with +0 and -0 components, origins in, on and next to the faces of boxes.

#include <cmath>
#include <cstdint>
#include <vector>

#include "app/hardcases/cases/case_run.h"
#include "app/hardcases/cases/exact_oracles.h"
#include "app/hardcases/cases/mesh_shapes.h"
#include "core/base/cpu_clock.h"

namespace talbot::hardcases::g02 {
namespace {

using namespace geometry;

constexpr float kPatterns[4] = {1, -1, 0.0f, -0.0f};

// All 56 patterns of signs and zeros through one random box.
void see_box(Rng& rng, Failures& failures) {
    const Bounds box = random_box(rng, true);
    for (int pattern = 0; pattern < 64; ++pattern) {
        Ray ray;
        ray.d =
            Vec3f(kPatterns[pattern & 3], kPatterns[(pattern >> 2) & 3], kPatterns[pattern >> 4]);
        if (ray.d == Vec3f(0)) continue;
        ray.d *= rng.uniform(0.1f, 3);
        for (int k = 0; k < 3; ++k) {
            const uint32_t where = rng.below(6);
            const float face = where % 2 == 0 ? box.lower[k] : box.upper[k];
            const float next = std::nextafter(face, rng.below(2) != 0 ? kInfinity : -kInfinity);
            ray.o[k] = where < 2 ? face : where < 4 ? next : rng.uniform(-3, 3);
        }
        if (!exact_box(ray, box)) continue;
        failures.see(!textbook_box(ray, box), !own_box(ray, box, true) || !own_box(ray, box, false),
                     [&] { return hex(ray) + " box " + hex(box.lower) + hex(box.upper); });
    }
}

// Integer boxes, so that rays along the axes run in faces and along edges.
struct Blocks {
    std::vector<MeshData> boxes;
    SceneData scene;

    Blocks() {
        Rng rng(4);
        for (int i = 0; i < 20; ++i) {
            const Vec3f lo(Vec3d(rng.between(-4, 4), rng.between(-4, 4), rng.between(-4, 4)));
            MeshData box;
            box.add_box(lo,
                        lo + Vec3f(Vec3d(rng.between(0, 2), rng.between(1, 2), rng.between(1, 2))));
            boxes.push_back(box);
            scene.show(box);
        }
    }
    // Control: triangles behind a textbook box test; whether it finds anything.
    bool naive_hit(const Ray& ray) const {
        for (const MeshData& box : boxes) {
            Bounds bounds;
            for (const Vec3f& p : box.positions) bounds.add(p);
            if (!textbook_box(ray, bounds)) continue;
            for (size_t i = 0; i < box.triangles(); ++i) {
                TriangleHit hit{};
                if (own_triangle(ray, box.triangle(i), hit) && hit.t > 0) return true;
            }
        }
        return false;
    }
};

Failures axis_aligned_scene(uint64_t rays) {
    const Blocks blocks;
    const auto accel = build_here(blocks.scene);
    const auto oracle = build_brute_force(blocks.scene.input());
    return over_inputs<Failures>(2, rays, [&](Rng& rng, Failures& failures) {
        Ray ray;
        ray.d = Vec3f(kPatterns[rng.below(4)], kPatterns[rng.below(4)], kPatterns[rng.below(4)]);
        if (ray.d == Vec3f(0)) return;
        for (int k = 0; k < 3; ++k) {
            ray.o[k] = static_cast<float>(rng.between(-10, 10)) / 2;
            if (rng.below(4) == 0) ray.o[k] = std::nextafter(ray.o[k], kInfinity);
        }
        Hit hit;
        Hit expected;
        const bool expect = oracle->closest(ray, expected);
        const bool found = accel->closest(ray, hit);
        const bool own =
            found != expect || !same_hit(hit, expected) || accel->occluded(ray) != expect;
        failures.see(blocks.naive_hit(ray) != expect, own, [&] { return hex(ray); });
    });
}

double seconds_for(const Accel& accel, const std::vector<Ray>& rays) {
    const double start = thread_cpu_seconds();
    uint32_t hits = 0;
    for (const Ray& ray : rays) {
        Hit hit;
        hits += accel.closest(ray, hit);
    }
    return hits == 0 ? INFINITY : thread_cpu_seconds() - start;
}

// Time of rays along the axes over that of the same rays turned by a hundredth of a degree, each
// the best of several rounds in turn: other work on the machine only adds.
double time_ratio(uint64_t count) {
    const SceneData scene = scene_of(city(2000, 1));
    const auto accel = build_here(scene);
    Rng rng(3);
    std::vector<Ray> along;
    std::vector<Ray> turned;
    const Bounds box = accel->bounds();
    for (uint64_t i = 0; i < count; ++i) {
        Ray ray;
        for (int k = 0; k < 3; ++k) ray.o[k] = rng.uniform(box.lower[k], box.upper[k]);
        ray.d = Vec3f(0);
        ray.d[rng.between(0, 2)] = rng.below(2) != 0 ? 1.0f : -1.0f;
        along.push_back(ray);
        ray.d += 2e-4f * rng.in_box(-1, 1);
        turned.push_back(ray);
    }
    double best_along = INFINITY;
    double best_turned = INFINITY;
    for (int round = 0; round < 40; ++round) {
        best_along = std::min(best_along, seconds_for(*accel, along));
        best_turned = std::min(best_turned, seconds_for(*accel, turned));
        if (round >= 7 && best_along <= 1.05 * best_turned) break;
    }
    return best_along / best_turned;
}

CaseResult run(Effort effort) {
    CaseResult result;
    result.measures.push_back(over_inputs<Failures>(1, inputs(effort, 2e3, 1e5), see_box, 64)
                                  .measure("boxes that are met and rejected"));
    result.measures.push_back(axis_aligned_scene(inputs(effort, 4e4, 2e6))
                                  .measure("rays along axes that differ from brute force"));
    // Quick runs are part of the tests, which never depend on a clock.
    if (effort == Effort::quick) return result;
    Measure speed{"time of rays along axes over that of turned ones",
                  NAN,
                  time_ratio(100000),
                  1.05,
                  Gate::at_most,
                  ""};
    result.measures.push_back(speed);
    return result;
}

const bool kAdded = add_case(
    {"G02", Priority::p0, "zero and negative-zero directions", "swap of near and far, NaN rejects",
     "near plane by the sign bit, parallel slabs by a power of two that never limits (after Ize "
     "2013)",
     "jbikker/tinybvh#282, jbikker/tinybvh#286, RenderKit/embree#589, madmann91/bvh#21", run});

}  // namespace
}  // namespace talbot::hardcases::g02
