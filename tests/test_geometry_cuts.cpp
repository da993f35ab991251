// Trees that cut triangles at planes: the same hits as without, within the memory that they may
// take, and boxes of parts that hold all of the triangle.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "core/geometry/bvh_accel.h"
#include "core/geometry/spatial_split.h"
#include "geometry_scenes.h"

namespace talbot::test {
namespace {

// Long thin triangles in all directions, each of them twice: every hit is a tie.
MeshData sticks(int count, float width) {
    Rng rng(3);
    MeshData mesh;
    for (int i = 0; i < count; ++i) {
        const Vec3f p = rng.in_box(0, 1);
        const Vec3f d = rng.uniform(0.1f, 0.4f) * rng.direction();
        const Vec3f w = width * rng.direction();
        mesh.add_triangle(p, p + d, p + w);
        mesh.add_triangle(p + d, p + w, p);
    }
    return mesh;
}

// Large and small next to each other.
MeshData mixed_sizes() {
    MeshData mesh = displaced_sphere(12, 0.3f);
    mesh.add_quad({-3, -1, -3}, {3, -1.2f, -3}, {3, -1, 3}, {-3, -0.8f, 3});
    mesh.add_quad({-3, -3, -3}, {3, 3, -3}, {3, 3, 3}, {-3, -3, 3});
    mesh.add(soup(300, 1.5f, 4));
    return mesh;
}

std::vector<std::pair<std::string, SceneData>> scenes() {
    SceneData instances = scene_of(mixed_sizes());
    instances.meshes.push_back(sticks(100, 0.02f));
    for (int i = 0; i < 3; ++i) {
        Mat4d m(0.7);
        m[3] = Vec4d(0.4 * i - 1, 0.1, 0.3 * i, 1);
        instances.place(1, m);
    }
    instances.spheres.push_back({Vec3d(0.5, 0.5, 0.5), 0.3, false});
    MeshData far = mixed_sizes().moved({100000, -3000, 5});
    return {{"sticks", scene_of(sticks(1000, 0.02f))},
            {"needles", scene_of(sticks(1000, 1e-5f))},
            {"sizes", scene_of(mixed_sizes())},
            {"far", scene_of(far)},
            {"instances", instances}};
}

// Towards points of triangles, from anywhere or from a point of another one.
Ray ray_at(const SceneData& scene, Rng& rng) {
    const auto point = [&] {
        const MeshData& mesh = scene.meshes[0];
        const auto t = mesh.triangle(rng.below(static_cast<uint32_t>(mesh.triangles())));
        const float u = rng.uniform();
        const float v = rng.uniform() * (1 - u);
        return t[0] + u * (t[1] - t[0]) + v * (t[2] - t[0]);
    };
    Ray ray;
    ray.o = rng.below(2) != 0 ? point() : point() + rng.in_box(-2, 2);
    ray.d = rng.below(4) != 0 ? point() - ray.o : rng.direction();
    return ray;
}

// Parts of the ground of a city would fill the leaves of its boxes and save no surface. Turned a
// little, it is cut.
TEST(Cuts, GroundStaysWhole) {
    const MeshData straight = city(400, 2);
    MeshData turned = straight;
    for (Vec3f& p : turned.positions) {
        const Vec3f q(p.x + 0.3f * p.y, p.y - 0.3f * p.x, p.z);
        p = Vec3f(q.x, q.y + 0.2f * q.z, q.z - 0.2f * q.y);
    }
    const auto whole = build(scene_of(straight), BuildQuality::high);
    EXPECT_EQ(whole->stats().references, whole->stats().triangles);
    const auto cut = build(scene_of(turned), BuildQuality::high);
    EXPECT_GT(cut->stats().references, cut->stats().triangles);
}

// Searches that any hit ends look at the last child first: that must be the one with the least
// below it.
TEST(Cuts, SmallChildrenComeLast) {
    for (const BuildQuality quality : {BuildQuality::fast, BuildQuality::high}) {
        const SceneData scene = scene_of(mixed_sizes());
        const auto accel = build(scene, quality);
        const Tree& tree = dynamic_cast<const BvhAccel&>(*accel).scene.top;
        uint64_t nodes = 0;
        const auto below = [&](const auto& self, uint32_t ref) -> uint64_t {
            if (ChildRef::is_leaf(ref)) {
                uint64_t count = 0;
                for (uint32_t k = 0; k < ChildRef::count(ref); ++k) {
                    for (const uint32_t id : tree.blocks[ChildRef::first(ref) + k].number)
                        count += id != kNoId ? 1 : 0;
                }
                return count;
            }
            ++nodes;
            const WideNode& node = tree.nodes[ref];
            uint64_t total = 0;
            uint64_t last = kNoId;
            for (size_t i = 0; i < kNodeWidth; ++i) {
                if (!(node.plane[0][i] <= node.plane[1][i])) continue;
                const uint64_t count = self(self, node.child[i]);
                // Parts that were cut below a child count more than once.
                if (quality == BuildQuality::fast) {
                    EXPECT_LE(count, last);
                }
                last = count;
                total += count;
            }
            return total;
        };
        EXPECT_EQ(below(below, tree.root), tree.references);
        EXPECT_EQ(nodes, tree.nodes.size());
    }
}

TEST(Cuts, HitsAreThoseOfBruteForce) {
    for (const auto& [name, scene] : scenes()) {
        const auto accel = build(scene, BuildQuality::high);
        const auto fast = build(scene, BuildQuality::fast);
        const auto oracle = build_brute_force(scene.input());
        const AccelStats& stats = accel->stats();
        // Without cuts the rest would show nothing.
        EXPECT_GT(stats.references, stats.triangles) << name;
        EXPECT_LE(static_cast<double>(stats.references),
                  kMostReferences * static_cast<double>(stats.triangles))
            << name;
        EXPECT_EQ(stats.triangles, fast->stats().triangles) << name;
        EXPECT_EQ(fast->stats().references, fast->stats().triangles) << name;
        Rng rng(11);
        uint64_t wrong = 0;
        uint64_t hits = 0;
        for (uint64_t i = 0; i < 4000 * test_scale(); ++i) {
            Ray ray = ray_at(scene, rng);
            Hit expected;
            Hit hit;
            Hit hit_fast;
            // All layers that the ray meets, in the order of distance and name.
            for (int layer = 0; layer < 3; ++layer) {
                const bool found = oracle->closest(ray, expected);
                hits += found;
                wrong += accel->closest(ray, hit) != found || fast->closest(ray, hit_fast) != found;
                wrong += accel->occluded(ray) != found || fast->occluded(ray) != found;
                if (!found) break;
                wrong += !same_hit(hit, expected) || !same_hit(hit_fast, expected);
                LeafPlace place;
                wrong += !accel->find_leaf(ray, hit, place) || place.depth >= stats.depth + 1;
                ray.skip_to = ray.skip_from;
                ray.skip_from = expected.id;
            }
        }
        EXPECT_EQ(wrong, 0u) << name;
        EXPECT_GT(hits, 1000u) << name;
    }
}

TEST(Cuts, TreeDoesNotDependOnThreads) {
    const SceneData scene = scene_of(sticks(20000, 0.01f));
    const auto one = build(scene, BuildQuality::high, 1);
    const auto three = build(scene, BuildQuality::high, 3);
    EXPECT_GT(one->stats().references, one->stats().triangles);
    EXPECT_EQ(one->stats().references, three->stats().references);
    EXPECT_EQ(one->stats().nodes, three->stats().nodes);
    Rng rng(2);
    for (int i = 0; i < 5000; ++i) {
        const Ray ray = ray_at(scene, rng);
        Hit hit;
        uint32_t steps = 0;
        uint32_t other = 0;
        one->closest_counting(ray, hit, steps);
        three->closest_counting(ray, hit, other);
        ASSERT_EQ(steps, other);
    }
}

// Points of the triangle lie in the box of their side, well inside unless earlier cuts end there.
TEST(Cuts, PartsHoldTheirSide) {
    Rng rng(5);
    uint64_t outside = 0;
    uint64_t smaller = 0;
    uint64_t crossings = 0;
    constexpr int kRuns = 20000;
    for (int run = 0; run < kRuns; ++run) {
        const float size = std::exp2(rng.uniform(-20, 20));
        const Vec3f at = rng.in_box(-100, 100) * rng.uniform();
        const auto corner = [&] { return size * (at + rng.in_box(-1, 1)); };
        const MeshData mesh{{corner(), corner(), corner()}, {0, 1, 2}};
        StoredTriangle t;
        if (!load_triangle({mesh.positions, mesh.indices}, 0, t)) continue;
        // What rounding may shift a hit.
        const double margin = 0x1p-22 * t.extent;
        Box box;
        for (const Vec3f& p : mesh.positions) {
            const Float4 corner_of{p.x, p.y, p.z, 0};
            box.add(corner_of, corner_of);
        }
        for (int cut = 0; cut < 3; ++cut) {
            const int axis = rng.between(0, 2);
            const float plane =
                box.lower[axis] + rng.uniform() * (box.upper[axis] - box.lower[axis]);
            Box parts[2];
            cut_triangle(t, box, axis, plane, parts[0], parts[1]);
            const auto check = [&](const Vec3d& p, const Box& part) {
                for (int i = 0; i < 3; ++i) {
                    if (p[i] < box.lower[i] || p[i] > box.upper[i]) return;
                }
                for (int i = 0; i < 3; ++i) {
                    outside += part.lower[i] > std::max<double>(box.lower[i], p[i] - margin) ||
                               part.upper[i] < std::min<double>(box.upper[i], p[i] + margin);
                }
            };
            const Vec3d corners[3] = {Vec3d(t.a), Vec3d(t.b), Vec3d(t.c)};
            for (int k = 0; k < 10; ++k) {
                const double u = rng.uniform();
                const double v = rng.uniform() * (1 - u);
                const Vec3d p =
                    corners[0] + u * (corners[1] - corners[0]) + v * (corners[2] - corners[0]);
                check(p, parts[p[axis] <= plane ? 0 : 1]);
            }
            // The outermost points of the parts: corners, and where edges meet the plane.
            for (int k = 0; k < 3; ++k) {
                const Vec3d& a = corners[k];
                const Vec3d e = corners[(k + 1) % 3] - a;
                if (a[axis] <= plane) check(a, parts[0]);
                if (a[axis] >= plane) check(a, parts[1]);
                const double share = (plane - a[axis]) / e[axis];
                if (!(share > 0 && share < 1)) continue;
                check(a + share * e, parts[0]);
                check(a + share * e, parts[1]);
                ++crossings;
            }
            smaller += parts[0].half_area() < box.half_area();
            const Box& next = parts[rng.below(2)];
            if (!(next.lower[0] <= next.upper[0])) break;
            box = next;
        }
    }
    EXPECT_EQ(outside, 0u);
    EXPECT_GT(crossings, static_cast<uint64_t>(kRuns));
    EXPECT_GT(smaller, static_cast<uint64_t>(kRuns));
}

}  // namespace
}  // namespace talbot::test
