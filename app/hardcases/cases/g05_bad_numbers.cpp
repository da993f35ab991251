// G05: vertices and rays that are NaN, infinite, huge or denormal.
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "app/hardcases/cases/case_run.h"
#include "app/hardcases/cases/case_scenes.h"
#include "app/hardcases/cases/exact_oracles.h"
#include "app/hardcases/cases/mesh_shapes.h"

namespace talbot::hardcases::g05 {
namespace {

using namespace geometry;

constexpr float kBad[] = {std::numeric_limits<float>::quiet_NaN(),
                          std::numeric_limits<float>::infinity(),
                          -std::numeric_limits<float>::infinity(),
                          std::numeric_limits<float>::max(), -std::numeric_limits<float>::max()};

// The mesh with one bad coordinate, and the one whose triangles at that vertex are gone.
struct Pair {
    MeshData bad;
    MeshData without;
    uint64_t dropped = 0;
};

Pair spoil(const MeshData& good, uint32_t vertex, int axis, float value) {
    Pair pair{good, good, 0};
    pair.bad.positions[vertex][axis] = value;
    for (size_t i = 0; i < good.triangles(); ++i) {
        uint32_t* t = &pair.without.indices[3 * i];
        if (t[0] != vertex && t[1] != vertex && t[2] != vertex) continue;
        t[0] = t[1] = t[2];
        ++pair.dropped;
    }
    return pair;
}

// Control: bounds by comparisons that let NaN through, and no look at the vertices.
Bounds naive_bounds(const MeshData& mesh) {
    Bounds box;
    for (const Vec3f& p : mesh.positions) {
        for (int i = 0; i < 3; ++i) {
            box.lower[i] = box.lower[i] < p[i] ? box.lower[i] : p[i];
            box.upper[i] = box.upper[i] > p[i] ? box.upper[i] : p[i];
        }
    }
    return box;
}

Failures bad_vertices(const MeshData& good, uint64_t rays) {
    Failures failures;
    uint64_t seed = 0;
    for (const float value : kBad) {
        for (int axis = 0; axis < 3; ++axis) {
            // The last vertex, so that nothing after it can hide what it did to the bounds.
            const auto vertex = static_cast<uint32_t>(good.positions.size() - 1);
            const Pair pair = spoil(good, vertex, axis, value);
            const auto accel = build_here(scene_of(pair.bad), BuildQuality::fast);
            const auto oracle = build_here(scene_of(pair.without), BuildQuality::fast);
            const Bounds poisoned = naive_bounds(pair.bad);
            failures.merge(over_inputs<Failures>(++seed, rays, [&](Rng& rng, Failures& f) {
                Ray ray;
                ray.o = rng.in_box(-2, 2);
                ray.d = rng.in_box(-1, 1) - ray.o;
                Hit hit;
                Hit expected;
                const bool expect = oracle->closest(ray, expected);
                const bool own = accel->closest(ray, hit) != expect || !same_hit(hit, expected);
                f.see(expect && !textbook_box(ray, poisoned), own, [&] { return hex(ray); });
            }));
            if (accel->stats().dropped_triangles != pair.dropped)
                failures.see(false, true, [&] { return line("dropped count, axis %d", axis); });
        }
    }
    return failures;
}

SceneDesc desc_of(const MeshData& mesh, bool drop) {
    SceneDesc desc;
    Mesh out;
    out.positions = mesh.positions;
    for (size_t i = 0; i < mesh.triangles(); ++i) {
        const uint32_t* t = &mesh.indices[3 * i];
        if (!drop || t[0] != t[1]) out.indices.insert(out.indices.end(), t, t + 3);
    }
    add_mesh(desc, std::move(out), add_material(desc, diffuse(Rgb(0.7f))));
    desc.environment.color = Rgb(1);
    return desc;
}

struct Import {
    uint64_t pixels = 0;        // that differ from the file without the triangles
    uint64_t naive_pixels = 0;  // that see nothing when the scene's box is poisoned
    uint64_t wrong_warnings = 0;
    uint64_t refused = 0;
    uint64_t nonfinite = 0;
};

// Through a file, as a user meets it.
Import imported(const MeshData& good) {
    Import import;
    Camera camera;
    look_at(camera, Vec3d(0.5, 0.7, 3), Vec3d(0));
    RenderWith with;
    with.width = with.height = 32;
    with.passes = 1;
    const auto vertex = static_cast<uint32_t>(good.positions.size() - 1);
    for (const float value : kBad) {
        Pair pair = spoil(good, vertex, 1, value);
        const Result<SceneDesc> bad =
            load_text(gltf_text(desc_of(pair.bad, false), camera, with.width, with.height));
        const Result<SceneDesc> plain =
            load_text(gltf_text(desc_of(pair.without, true), camera, with.width, with.height));
        if (!bad || !plain) {
            ++import.refused;
            continue;
        }
        import.wrong_warnings += bad->warnings.size() != 1 || !plain->warnings.empty();
        const Rendering a = render(*bad, camera, with);
        const Rendering b = render(*plain, camera, with);
        import.pixels += differing_pixels(a, b);
        import.nonfinite += a.nonfinite;
        const Bounds poisoned = naive_bounds(pair.bad);
        const CameraRays rays(camera, Vec3d(0), with.width, with.height, Bounds{});
        for (uint32_t i = 0; i < with.width * with.height; ++i) {
            const Ray ray = rays.ray(static_cast<float>(i % with.width) + 0.5f,
                                     static_cast<float>(i / with.width) + 0.5f, Vec2f(0));
            import.naive_pixels += b.film.pixels()[i].covered > 0 && !textbook_box(ray, poisoned);
        }
    }
    return import;
}

// A sphere, a mesh, and the mesh twice as large elsewhere.
SceneData mixed_scene() {
    SceneData scene = scene_of(displaced_sphere(4, 0.1f));
    scene.spheres.push_back({Vec3d(0.5), 1, false});
    scene.place(0, Mat4d(2.0));
    scene.instances.back().world_from_object[3] = Vec4d(3, 0, 0, 1);
    return scene;
}

// Rays of any bit pattern: the same answer as brute force, and every figure of a hit in range. The
// control answers by the textbook sphere test.
Failures any_rays(uint64_t count) {
    const SceneData scene = mixed_scene();
    const auto accel = build_here(scene);
    const auto oracle = build_brute_force(scene.input());
    constexpr uint32_t kSpecial[] = {0x00000000, 0x80000000, 0x00000001, 0x807FFFFF,
                                     0x00800000, 0x3F7FFFFF, 0x3F800000, 0x3F800001,
                                     0x7F7FFFFF, 0xFF7FFFFF, 0x7F800000, 0xFF800000,
                                     0x7FC00000, 0x7F800001, 0x58800000, 0x26800000};
    return over_inputs<Failures>(99, count, [&](Rng& rng, Failures& failures) {
        const auto any = [&](float usual) {
            const uint32_t kind = rng.below(4);
            if (kind == 0) return std::bit_cast<float>(kSpecial[rng.below(16)]);
            if (kind == 1) return std::bit_cast<float>(static_cast<uint32_t>(rng.bits()));
            return usual;
        };
        Ray ray;
        const Vec3f d = rng.direction();
        for (int k = 0; k < 3; ++k) {
            ray.o[k] = any(rng.uniform(-3, 3));
            ray.d[k] = any(d[k]);
        }
        ray.t_max = any(kInfinity);
        Hit hit;
        Hit expected;
        const bool found = accel->closest(ray, hit);
        bool own = found != oracle->closest(ray, expected) || !same_hit(hit, expected);
        own = own || (found && !(hit.t > 0 && hit.t < ray.t_max && hit.u >= 0 && hit.v >= 0 &&
                                 hit.u <= 1 && hit.v <= 1));
        float t[2] = {1, 1};
        const bool naive = naive_sphere(ray, Vec3f(0.5f), 1, t) && !(t[0] <= t[1]);
        failures.see(naive, own, [&] { return hex(ray); });
    });
}

// A direction times any power of two that keeps it a normal float meets the same, at the distance
// divided by that, or nothing where that is no normal float.
Failures any_lengths(uint64_t count) {
    const SceneData scene = mixed_scene();
    const auto accel = build_here(scene);
    return over_inputs<Failures>(98, count, [&](Rng& rng, Failures& failures) {
        constexpr int kSteps = 512;  // to 1, so that small components stay normal, too
        Ray unit;
        unit.o = rng.in_box(-3, 4);
        int smallest = kSteps;
        for (int k = 0; k < 3; ++k) {
            const int d = rng.below(4) == 0 ? 0 : rng.between(-kSteps, kSteps);
            unit.d[k] = static_cast<float>(d) / kSteps;
            if (d != 0) smallest = std::min(smallest, std::abs(d));
        }
        if (unit.d == Vec3f(0)) return;
        constexpr int kLeast = std::numeric_limits<float>::min_exponent - 1;
        constexpr int kMost = std::numeric_limits<float>::max_exponent - 1;
        const int least = kLeast - std::ilogb(static_cast<float>(smallest) / kSteps);
        const int exponent = rng.below(4) == 0 ? least : rng.between(least, kMost);
        Ray ray = unit;
        for (int k = 0; k < 3; ++k) ray.d[k] = std::ldexp(unit.d[k], exponent);
        Hit expected;
        Hit hit;
        bool expect = accel->closest(unit, expected);
        if (expect) {
            const double t = std::ldexp(static_cast<double>(expected.t), -exponent);
            // Where the nearest one is too near for a number, another may come.
            if (t < std::numeric_limits<float>::min()) return;
            expect = t <= std::numeric_limits<float>::max();
            expected.t = static_cast<float>(t);
        }
        const bool found = accel->closest(ray, hit);
        const bool own = found != expect || (found && !same_hit(hit, expected));
        float t[2] = {0, 0};
        const bool met = naive_sphere(unit, Vec3f(0.5f), 1, t);
        failures.see(met && !(naive_sphere(ray, Vec3f(0.5f), 1, t) && is_finite(t[0])), own,
                     [&] { return hex(ray); });
    });
}

CaseResult run(Effort effort) {
    CaseResult result;
    const bool full = effort == Effort::full;
    const MeshData good = displaced_sphere(full ? 92 : 16, 0.1f);
    result.measures.push_back(bad_vertices(good, full ? 50000 : 1500)
                                  .measure("rays that a bad vertex elsewhere changes"));
    const Import import = imported(displaced_sphere(full ? 92 : 16, 0.1f));
    result.nonfinite = import.nonfinite;
    result.measures.push_back({"pixels of a file that a bad vertex elsewhere changes",
                               static_cast<double>(import.naive_pixels),
                               static_cast<double>(import.pixels), 0, Gate::at_most, ""});
    result.measures.push_back({"files with a bad vertex that do not load with one warning", NAN,
                               static_cast<double>(import.wrong_warnings + import.refused), 0,
                               Gate::at_most, ""});
    result.measures.push_back(any_rays(inputs(effort, 1e5, 2e6))
                                  .measure("rays of any bits that differ or give no number"));
    result.measures.push_back(any_lengths(inputs(effort, 1e5, 2e6))
                                  .measure("rays 2^-126 to 2^127 long that meet otherwise than "
                                           "unit ones"));
    return result;
}

const bool kAdded =
    add_case({"G05", Priority::p0, "NaN, infinite and huge numbers in vertices and rays",
              "bounds that NaN poisons; textbook sphere test",
              "triangles of bad vertices are dropped and counted at import, bad rays miss",
              "embree and Cycles source", run});

}  // namespace
}  // namespace talbot::hardcases::g05
