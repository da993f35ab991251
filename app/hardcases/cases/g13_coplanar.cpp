// G13: surfaces that lie in one another. The winner must not depend on rounding that differs from
// pixel to pixel, nor on threads, builder, instruction set or place. Float corners of their own do
// not lie in one plane once they are turned: there the surfaces really cross, and what is asked is
// that each pixel shows the one that exact arithmetic finds nearer.
#include <cmath>
#include <cstdint>
#include <map>

#include "app/hardcases/cases/case_run.h"
#include "app/hardcases/cases/exact_oracles.h"
#include "app/hardcases/cases/instruction_sets.h"
#include "app/hardcases/cases/mesh_shapes.h"

namespace talbot::hardcases::g13 {
namespace {

using namespace geometry;

// Orthographic rays against a plane, one a pixel, and the instance that each meets first.
struct View {
    Vec3d middle, right, up, forward;
    double size;
};

constexpr uint32_t kPixels = 64;

Ray ray_of(const View& view, uint32_t pixel) {
    const double x = (static_cast<double>(pixel % kPixels) + 0.5) / kPixels - 0.5;
    const double y = (static_cast<double>(pixel / kPixels) + 0.5) / kPixels - 0.5;
    Ray ray;
    ray.o = Vec3f(view.middle + view.size * (x * view.right + y * view.up - 3.0 * view.forward));
    ray.d = Vec3f(view.forward + 0.1 * (x * view.right + y * view.up));
    return ray;
}

std::vector<uint32_t> winners(const Accel& accel, const View& view) {
    std::vector<uint32_t> list(kPixels * kPixels);
    for (uint32_t i = 0; i < list.size(); ++i) {
        Hit hit;
        list[i] = accel.closest(ray_of(view, i), hit) ? hit.id.instance : kNoId;
    }
    return list;
}

// Control: the nearest t of float Moeller-Trumbore, the last one tested among equals.
std::vector<uint32_t> naive_winners(const SceneData& scene, const View& view) {
    std::vector<uint32_t> list(kPixels * kPixels);
    for (uint32_t i = 0; i < list.size(); ++i) {
        const Ray ray = ray_of(view, i);
        float best = kInfinity;
        list[i] = kNoId;
        for (uint32_t k = 0; k < scene.meshes.size(); ++k) {
            for (size_t n = 0; n < scene.meshes[k].triangles(); ++n) {
                const auto tri = scene.meshes[k].triangle(n);
                if (!moeller_trumbore(ray, tri)) continue;
                const Vec3f e1 = tri[1] - tri[0];
                const Vec3f e2 = tri[2] - tri[0];
                const float t = talbot::dot(e2, talbot::cross(ray.o - tri[0], e1)) /
                                talbot::dot(e1, talbot::cross(ray.d, e2));
                if (t <= best) {
                    best = t;
                    list[i] = k;
                }
            }
        }
    }
    return list;
}

// Depth of every instance along the rays of all pixels, in binary128 from the float corners:
// infinity where it is not met.
using Depths = std::vector<std::vector<Quad>>;

Depths exact_depths(const SceneData& scene, const View& view) {
    Depths depth(kPixels * kPixels, std::vector<Quad>(scene.meshes.size(), kInfinity));
    for (uint32_t i = 0; i < depth.size(); ++i) {
        const Ray ray = ray_of(view, i);
        for (uint32_t k = 0; k < scene.meshes.size(); ++k) {
            for (size_t n = 0; n < scene.meshes[k].triangles(); ++n) {
                Quad numerator = 0;
                Quad denominator = 0;
                if (!exact_triangle<Quad>(ray, scene.meshes[k].triangle(n), numerator, denominator))
                    continue;
                const Quad t = numerator / denominator;
                if (t > 0) depth[i][k] = std::min(depth[i][k], t);
            }
        }
    }
    return depth;
}

std::vector<uint32_t> exact_winners(const Depths& depth) {
    std::vector<uint32_t> list;
    for (const std::vector<Quad>& t : depth) {
        const auto nearest = std::min_element(t.begin(), t.end());
        list.push_back(*nearest < static_cast<Quad>(kInfinity)
                           ? static_cast<uint32_t>(nearest - t.begin())
                           : kNoId);
    }
    return list;
}

// Pixels whose winner lies behind another by more than a float t can tell.
uint64_t passed_over(const std::vector<uint32_t>& list, const Depths& depth) {
    uint64_t count = 0;
    for (size_t i = 0; i < list.size(); ++i) {
        const Quad nearest = *std::min_element(depth[i].begin(), depth[i].end());
        const Quad own = list[i] == kNoId ? static_cast<Quad>(kInfinity) : depth[i][list[i]];
        count += static_cast<float>(own) > static_cast<float>(nearest);
    }
    return count;
}

// Pixels whose winner is not the majority's.
uint64_t flips(const std::vector<uint32_t>& list) {
    std::map<uint32_t, uint64_t> count;
    uint64_t all = 0;
    uint64_t most = 0;
    for (const uint32_t winner : list) {
        if (winner == kNoId) continue;
        ++all;
        most = std::max(most, ++count[winner]);
    }
    return all - most;
}

struct Turned {
    Vec3d x, y, z, at;
    Vec3f operator()(double u, double v, double w = 0) const {
        return Vec3f(at + u * x + v * y + w * z);
    }
};

// Squares of side 2 in the plane of x and y: the first of two triangles, the second the same again,
// split along the other diagonal, or a grid of n x n cells.
SceneData squares(const Turned& p, bool other_diagonal, int n) {
    SceneData scene;
    MeshData first;
    first.add_quad(p(-1, -1), p(1, -1), p(1, 1), p(-1, 1));
    MeshData second;
    const auto at = [n](int i) { return -1 + 2.0 * i / n; };
    for (int i = 0; i < n; ++i) {
        for (int j = 0; j < n; ++j) {
            const Vec3f a = p(at(i), at(j));
            const Vec3f b = p(at(i + 1), at(j));
            const Vec3f c = p(at(i + 1), at(j + 1));
            const Vec3f d = p(at(i), at(j + 1));
            if (other_diagonal) {
                second.add_quad(b, c, d, a);
            } else {
                second.add_quad(a, b, c, d);
            }
        }
    }
    scene.show(std::move(first));
    scene.show(std::move(second));
    return scene;
}

// A cube that stands on a larger floor, seen from below: its bottom lies in the floor.
SceneData cube_on_floor(const Turned& p, double size) {
    SceneData scene;
    MeshData floor;
    floor.add_quad(p(-size, -size), p(size, -size), p(size, size), p(-size, size));
    MeshData cube;
    const auto q = [&](int k) {
        return p((k & 1) != 0 ? 1 : -1, (k & 2) != 0 ? 1 : -1, (k & 4) != 0 ? 2 : 0);
    };
    constexpr int kFaces[6][4] = {{0, 2, 6, 4}, {1, 5, 7, 3}, {0, 4, 5, 1},
                                  {2, 3, 7, 6}, {0, 1, 3, 2}, {4, 6, 7, 5}};
    for (const auto& f : kFaces) cube.add_quad(q(f[0]), q(f[1]), q(f[2]), q(f[3]));
    scene.show(std::move(floor));
    scene.show(std::move(cube));
    return scene;
}

struct Fights {
    uint64_t pixels = 0, naive = 0, own = 0, unstable = 0;
    uint64_t exact = 0;  // flips of exact arithmetic
    uint64_t naive_behind = 0, own_behind = 0;
};

void fight(const SceneData& scene, const View& view, Fights& fights) {
    std::vector<uint32_t> first;
    for (const int64_t target : instruction_sets()) {
        const UseInstructionSet use(target);
        for (const BuildQuality quality : {BuildQuality::fast, BuildQuality::high}) {
            for (const unsigned threads : {1u, 3u}) {
                WorkerPool pool(threads);
                const auto accel = build_accel(scene.input(quality), pool);
                const std::vector<uint32_t> list = winners(*accel, view);
                if (first.empty()) first = list;
                fights.unstable += list != first;
            }
        }
    }
    fights.pixels += first.size();
    const std::vector<uint32_t> naive = naive_winners(scene, view);
    fights.own += flips(first);
    fights.naive += flips(naive);
    const Depths depth = exact_depths(scene, view);
    fights.exact += flips(exact_winners(depth));
    fights.own_behind += passed_over(first, depth);
    fights.naive_behind += passed_over(naive, depth);
}

CaseResult run(Effort effort) {
    CaseResult result;
    Fights axis;    // in planes that float holds exactly, any split
    Fights copies;  // turned by odd angles and moved, on the same corners
    Fights splits;  // the same with corners of their own, which float cannot hold in one plane
    Rng rng(3);
    const int turns = effort == Effort::full ? 20 : 4;
    for (int i = 0; i < turns; ++i) {
        Turned turned{};
        turned.z = normalize(Vec3d(rng.direction()));
        turned.x = normalize(talbot::cross(turned.z, Vec3d(rng.direction())));
        turned.y = talbot::cross(turned.z, turned.x);
        turned.at = i % 2 == 0 ? Vec3d(0) : 1e5 * Vec3d(rng.direction());
        const View view{turned.at, turned.x, turned.y, turned.z, 1.8};
        fight(squares(turned, false, 1), view, copies);
        fight(squares(turned, true, 1), view, copies);
        fight(cube_on_floor(turned, 1), view, copies);
        fight(squares(turned, false, 5), view, splits);
        fight(cube_on_floor(turned, 1.5), view, splits);
        Turned plain{Vec3d(1, 0, 0), Vec3d(0, 0, -1), Vec3d(0, 1, 0), Vec3d(0)};
        if (i % 2 != 0) plain.at = glm::round(turned.at);
        const Vec3d tilt = normalize(plain.z + 0.3 * Vec3d(rng.direction()));
        const View slanted{plain.at, plain.x, plain.y, tilt, 1.2};
        fight(squares(plain, false, 1), slanted, axis);
        fight(squares(plain, true, 1), slanted, axis);
        fight(squares(plain, true, 4), slanted, axis);
        fight(cube_on_floor(plain, 4), slanted, axis);
    }
    const auto add = [&](const char* what, const Fights& f) {
        result.measures.push_back({std::string("flipped pixels, ") + what +
                                       line(" (of %.3g)", static_cast<double>(f.pixels)),
                                   static_cast<double>(f.naive), static_cast<double>(f.own), 0,
                                   Gate::at_most, ""});
    };
    add("in planes that float holds", axis);
    add("turned, on the same corners", copies);
    result.measures.push_back(
        {line(
             "turned, on corners of their own: pixels (of %.3g) whose winner is not the nearest in "
             "binary128, where exact arithmetic itself flips %.3g and Talbot %.3g",
             static_cast<double>(splits.pixels), static_cast<double>(splits.exact),
             static_cast<double>(splits.own)),
         static_cast<double>(splits.naive_behind), static_cast<double>(splits.own_behind), 0,
         Gate::at_most, ""});
    result.measures.push_back({"pixels of the other scenes whose winner is not the nearest",
                               static_cast<double>(axis.naive_behind + copies.naive_behind),
                               static_cast<double>(axis.own_behind + copies.own_behind), 0,
                               Gate::at_most, ""});
    result.measures.push_back(
        {"structures that disagree over threads, builder and instruction set", NAN,
         static_cast<double>(axis.unstable + copies.unstable + splits.unstable), 0, Gate::at_most,
         ""});
    return result;
}

const bool kAdded = add_case(
    {"G13", Priority::p1, "coplanar and coincident surfaces", "nearest float t, last among equals",
     "depth in double from the float corners, rounded once; ties by the lower id",
     "powroupi/blender_mmd_tools#214", run});

}  // namespace
}  // namespace talbot::hardcases::g13
