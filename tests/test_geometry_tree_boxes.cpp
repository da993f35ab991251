// The boxes of a level, as debug views draw them: they hold all that can be hit, each level inside
// the one above it, moved instances where they are.
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "core/geometry/tree_boxes.h"
#include "geometry_scenes.h"

namespace talbot::test {
namespace {

constexpr size_t kAll = 1000000;

// Coordinates along the edges of a box that may stand askew: 0 to 1 inside. `slack` is for boxes of
// instances, which went through a transform and back.
bool is_inside(const TreeBox& box, const Vec3d& point, double slack) {
    const Vec3d& base = box.corners[0];
    const Vec3d from_base = point - base;
    for (size_t axis = 0; axis < 3; ++axis) {
        const Vec3d edge = box.corners[size_t{1} << axis] - base;
        // Off the plane of the two other edges, which may be no longer than nothing.
        const Vec3d a = box.corners[size_t{1} << (axis + 1) % 3] - base;
        const Vec3d b = box.corners[size_t{1} << (axis + 2) % 3] - base;
        Vec3d n = cross(a, b);
        if (dot(n, n) == 0) n = edge;
        n = dot(n, edge) < 0 ? -n : n;
        const double size = length(n);
        const double d = dot(n, from_base);
        if (!(d >= -slack * size && d <= dot(n, edge) + slack * size)) return false;
    }
    return true;
}

bool is_in_any(const TreeBoxes& boxes, const Vec3d& point, double slack) {
    return std::any_of(boxes.boxes.begin(), boxes.boxes.end(),
                       [&](const TreeBox& box) { return is_inside(box, point, slack); });
}

Mat4d turned(const Vec3d& offset, double scale) {
    Mat4d m(1.0);
    m[0] = Vec4d(0.36 * scale, 0.48 * scale, -0.8 * scale, 0);
    m[1] = Vec4d(-0.8 * scale, 0.6 * scale, 0, 0);
    m[2] = Vec4d(0.48 * scale, 0.64 * scale, 0.6 * scale, 0);
    m[3] = Vec4d(offset, 1);
    return m;
}

// Merged triangles, spheres, and a mesh under five transforms.
SceneData mixed_scene() {
    SceneData scene;
    scene.show(displaced_sphere(8, 0.3f));
    MeshData long_ones;
    Rng rng(7);
    for (int i = 0; i < 60; ++i) {
        const Vec3f p = rng.in_box(-2, 2);
        long_ones.add_triangle(p, p + Vec3f(0.1f, 0, 0.05f), -p);
    }
    scene.meshes.push_back(std::move(long_ones));
    for (int i = 0; i < 5; ++i) scene.place(1, turned(Vec3d(5 * i, 3, -2), i % 2 == 0 ? 0.5 : -1));
    for (int i = 0; i < 3; ++i) scene.spheres.push_back({Vec3d(-4, i, 0), 0.25});
    return scene;
}

// Points of all triangles and spheres, in the world.
std::vector<Vec3d> points_of(const SceneData& scene) {
    std::vector<Vec3d> points;
    for (const AccelInstance& instance : scene.instances) {
        const MeshData& mesh = scene.meshes[instance.mesh];
        for (size_t i = 0; i < mesh.triangles(); ++i) {
            const auto tri = mesh.triangle(i);
            const Vec3d a(tri[0]), b(tri[1]), c(tri[2]);
            for (const Vec3d& p : {a, b, c, (a + b + c) / 3.0, 0.9 * a + 0.1 * c, 0.5 * (b + c)})
                points.push_back(Vec3d(instance.world_from_object * Vec4d(p, 1)));
        }
    }
    for (const AccelSphere& sphere : scene.spheres) {
        for (int axis = 0; axis < 3; ++axis) {
            Vec3d to(0);
            to[axis] = sphere.radius;
            points.push_back(sphere.center + to);
            points.push_back(sphere.center - to);
        }
    }
    return points;
}

uint64_t count_outside(const std::vector<Vec3d>& points, const TreeBoxes& boxes) {
    uint64_t outside = 0;
    for (const Vec3d& p : points) outside += is_in_any(boxes, p, 1e-12) ? 0 : 1;
    return outside;
}

TEST(TreeBoxes, HoldAllThatCanBeHitAtEveryLevel) {
    const SceneData scene = mixed_scene();
    const std::vector<Vec3d> points = points_of(scene);
    for (const BuildQuality quality : {BuildQuality::fast, BuildQuality::high}) {
        const auto accel = build(scene, quality);
        const uint32_t levels = accel->stats().depth + 3;
        size_t before = 0;
        for (uint32_t level = 0; level <= levels; ++level) {
            const TreeBoxes boxes = tree_boxes(*accel, level, kAll);
            EXPECT_FALSE(boxes.is_cut);
            EXPECT_GE(boxes.boxes.size(), before);
            before = boxes.boxes.size();
            if (level == 0) {
                EXPECT_EQ(before, 1u);
            }
            EXPECT_EQ(count_outside(points, boxes), 0u) << level;
        }
        const TreeBoxes leaves = tree_boxes(*accel, levels, kAll);
        for (const TreeBox& box : leaves.boxes) EXPECT_TRUE(box.is_leaf);
        EXPECT_EQ(tree_boxes(*accel, 4000000000u, kAll).boxes.size(), leaves.boxes.size());

        // Control: boxes that stand beside their triangles do not hold them.
        TreeBoxes shifted = leaves;
        for (TreeBox& box : shifted.boxes) {
            for (Vec3d& corner : box.corners) corner += Vec3d(1, 0, 0);
        }
        EXPECT_GT(count_outside(points, shifted), points.size() / 4);
    }
}

TEST(TreeBoxes, AreInsideTheLevelAbove) {
    const auto accel = build(mixed_scene());
    for (uint32_t level = 1; level <= accel->stats().depth + 3; ++level) {
        const TreeBoxes parents = tree_boxes(*accel, level - 1, kAll);
        for (const TreeBox& box : tree_boxes(*accel, level, kAll).boxes) {
            const auto holds = [&](const TreeBox& parent) {
                return std::all_of(box.corners.begin(), box.corners.end(),
                                   [&](const Vec3d& p) { return is_inside(parent, p, 1e-12); });
            };
            EXPECT_TRUE(std::any_of(parents.boxes.begin(), parents.boxes.end(), holds)) << level;
        }
    }
}

TEST(TreeBoxes, OfAMovedInstanceStandWhereItIs) {
    SceneData scene;
    MeshData mesh;
    mesh.add_triangle({1, 2, 3}, {2, 2, 3}, {1, 4, 7});
    scene.meshes.push_back(mesh);
    const Mat4d m = turned(Vec3d(100, -50, 3), 2);
    scene.place(0, m);
    const auto accel = build(scene);
    const TreeBoxes boxes = tree_boxes(*accel, 1, kAll);
    ASSERT_EQ(boxes.boxes.size(), 1u);
    EXPECT_TRUE(boxes.boxes[0].is_leaf);
    for (size_t k = 0; k < 8; ++k) {
        const Vec3d local((k & 1) != 0 ? 2 : 1, (k & 2) != 0 ? 4 : 2, (k & 4) != 0 ? 7 : 3);
        const Vec3d expected(m * Vec4d(local, 1));
        EXPECT_LT(length(boxes.boxes[0].corners[k] - expected), 1e-11) << k;
    }
    EXPECT_FALSE(tree_boxes(*accel, 0, kAll).boxes[0].is_leaf);
}

TEST(TreeBoxes, OfNothingOneAndTwo) {
    EXPECT_TRUE(tree_boxes(*build(SceneData{}), 0, kAll).boxes.empty());
    EXPECT_TRUE(tree_boxes(*build(SceneData{}), 5, kAll).boxes.empty());
    MeshData mesh;
    for (int count = 1; count <= 2; ++count) {
        const float x = static_cast<float>(count);
        mesh.add_triangle({x, 0, 0}, {x + 1, 0, 0}, {x, 1, 2});
        const auto accel = build(scene_of(mesh));
        for (uint32_t level = 0; level < 3; ++level) {
            const TreeBoxes boxes = tree_boxes(*accel, level, kAll);
            ASSERT_EQ(boxes.boxes.size(), 1u);
            EXPECT_TRUE(boxes.boxes[0].is_leaf);
            EXPECT_EQ(boxes.boxes[0].corners[0], Vec3d(1, 0, 0));
            EXPECT_EQ(boxes.boxes[0].corners[7], Vec3d(x + 1, 1, 2));
        }
    }
    SceneData sphere;
    sphere.spheres.push_back({Vec3d(1, 2, 3), 0.5});
    const TreeBoxes boxes = tree_boxes(*build(sphere), 1, kAll);
    ASSERT_EQ(boxes.boxes.size(), 1u);
    EXPECT_TRUE(boxes.boxes[0].is_leaf);
    EXPECT_EQ(boxes.boxes[0].corners[0], Vec3d(0.5, 1.5, 2.5));
    EXPECT_TRUE(tree_boxes(*build_brute_force(sphere.input()), 0, kAll).boxes.empty());
}

double half_area(const TreeBox& box) {
    const Vec3d size = box.corners[7] - box.corners[0];
    return size.x * size.y + size.y * size.z + size.z * size.x;
}

TEST(TreeBoxes, BeyondTheBoundTheLargestAreKept) {
    const auto accel = build(scene_of(displaced_sphere(40, 0.2f)));
    for (const uint32_t level : {1u, 3u}) {
        const TreeBoxes whole = tree_boxes(*accel, level, kAll);
        const TreeBoxes few = tree_boxes(*accel, level, 5);
        ASSERT_GT(whole.boxes.size(), 5u);
        ASSERT_EQ(few.boxes.size(), 5u);
        EXPECT_TRUE(few.is_cut);
        if (level != 1) continue;
        std::vector<double> areas;
        for (const TreeBox& box : whole.boxes) areas.push_back(half_area(box));
        std::sort(areas.begin(), areas.end());
        for (const TreeBox& box : few.boxes) EXPECT_GE(half_area(box), areas[areas.size() - 5]);
    }
    EXPECT_FALSE(tree_boxes(*accel, 1, 8).is_cut);
}

// Refitted trees have boxes round the triangles as they are now.
TEST(TreeBoxes, FollowARefit) {
    SceneData scene = scene_of(displaced_sphere(10, 0.2f));
    WorkerPool pool(1);
    const auto before = build_accel(scene.input(BuildQuality::fast), pool);
    for (Vec3f& p : scene.meshes[0].positions) p += Vec3f(10, 0, 0);
    const auto after = refit_accel(*before, scene.input(BuildQuality::fast), pool);
    ASSERT_TRUE(after);
    const std::vector<Vec3d> points = points_of(scene);
    EXPECT_EQ(count_outside(points, tree_boxes(*after, 2, kAll)), 0u);
    EXPECT_EQ(count_outside(points, tree_boxes(*before, 2, kAll)), points.size());
}

}  // namespace
}  // namespace talbot::test
