// Both qualities against brute force in long double, which shares no code with them: the same
// primitive on every ray for which the reference can tell, and a distance within its rounding.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "geometry_scenes.h"

namespace talbot::test {
namespace {

using Real = long double;

struct Point {
    Real x, y, z;
};

Point operator-(const Point& a, const Point& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
Point cross_of(const Point& a, const Point& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
Real dot_of(const Point& a, const Point& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
Real size_of(const Point& a) {
    return std::sqrt(dot_of(a, a));
}
Point point(const Vec3f& v) {
    return {v.x, v.y, v.z};
}

// Nearest hit in (0, infinity), or none; `clear` is false where rounding decides.
struct Answer {
    bool found = false;
    bool clear = true;
    uint32_t primitive = 0;
    Real t = std::numeric_limits<Real>::infinity();
};

// By volumes of tetrahedra over the ray's line.
Answer nearest(const MeshData& mesh, const Ray& ray, Real unsure) {
    Answer best;
    Real second = best.t;
    bool doubtful = false;
    const Point d = point(ray.d);
    for (uint32_t i = 0; i < mesh.triangles(); ++i) {
        const auto corners = mesh.triangle(i);
        const Point a = point(corners[0]) - point(ray.o);
        const Point b = point(corners[1]) - point(ray.o);
        const Point c = point(corners[2]) - point(ray.o);
        const Real volumes[3] = {dot_of(d, cross_of(b, c)), dot_of(d, cross_of(c, a)),
                                 dot_of(d, cross_of(a, b))};
        const Real reach = size_of(a) + size_of(b) + size_of(c);
        const Real doubt = unsure * size_of(d) * reach * reach;
        Real least = volumes[0];
        Real most = volumes[0];
        for (const Real v : volumes) {
            least = std::min(least, v);
            most = std::max(most, v);
        }
        if (least < -doubt && most > doubt) continue;
        const Point normal = cross_of(b - a, c - a);
        const Real slope = dot_of(normal, d);
        const Real t = dot_of(normal, a) / slope;
        const bool sure = (least > doubt || most < -doubt) &&
                          std::abs(slope) > 0x1p-20L * size_of(normal) * size_of(d) &&
                          std::abs(t) * size_of(d) > 0x1p-20L * reach;
        if (!sure) {
            doubtful = true;
            continue;
        }
        if (!(t > 0)) continue;
        if (t < best.t) {
            second = best.t;
            best.t = t;
            best.primitive = i;
            best.found = true;
        } else {
            second = std::min(second, t);
        }
    }
    best.clear = !doubtful && !(best.found && second <= best.t * (1 + 0x1p-22L));
    return best;
}

struct Counts {
    uint64_t wrong = 0;
    uint64_t unclear = 0;
    uint64_t hits = 0;
};

Counts compare(const SceneData& scene, uint64_t rays, Real unsure) {
    const auto fast = build(scene, BuildQuality::fast);
    const auto high = build(scene, BuildQuality::high);
    const Bounds box = fast->bounds();
    Rng rng(23);
    Counts counts;
    for (uint64_t i = 0; i < rays; ++i) {
        Ray ray;
        ray.o = 0.5f * (box.lower + box.upper) + rng.in_box(-0.8f, 0.8f) * (box.upper - box.lower);
        ray.d = rng.direction();
        const Answer answer = nearest(scene.meshes[0], ray, unsure);
        counts.unclear += !answer.clear;
        if (!answer.clear) continue;
        counts.hits += answer.found;
        for (const Accel* accel : {fast.get(), high.get()}) {
            Hit hit;
            const bool found = accel->closest(ray, hit);
            if (found != answer.found || accel->occluded(ray) != found) {
                ++counts.wrong;
            } else if (found) {
                const Real error = std::abs(hit.t - answer.t) / answer.t;
                counts.wrong += hit.id.primitive != answer.primitive || error > 0x1p-23L;
            }
        }
    }
    return counts;
}

TEST(LongDouble, GivesTheSameHits) {
    MeshData sizes = displaced_sphere(8, 0.3f);
    sizes.add_quad({-3, -1, -3}, {3, -1.2f, -3}, {3, -1, 3}, {-3, -0.8f, 3});
    const std::vector<std::pair<std::string, SceneData>> scenes = {
        {"soup", scene_of(soup(500, 0.4f, 1))},
        {"sphere", scene_of(displaced_sphere(8, 0.3f))},
        {"sizes", scene_of(sizes)},
        {"far", scene_of(displaced_sphere(8, 0.3f).moved({1000, -3000, 70}))}};
    const uint64_t rays = 5000 * test_scale();
    for (const auto& [name, scene] : scenes) {
        const Counts counts = compare(scene, rays, 0x1p-50L);
        EXPECT_EQ(counts.wrong, 0u) << name;
        EXPECT_LT(counts.unclear, rays / 100) << name;
        EXPECT_GT(counts.hits, rays / 10) << name;
    }
}

}  // namespace
}  // namespace talbot::test
