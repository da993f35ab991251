// The camera controller: frames stay orthonormal and continuous through the poles, drags have the
// right sense, framing shows every corner of the box.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>

#include "ui/camera_controller.h"

namespace talbot {
namespace {

constexpr double kEpsilon = 1e-12;

Camera look_along(const Vec3d& eye, const Vec3d& target) {
    Camera camera;
    look_at(camera, eye, target);
    return camera;
}

void expect_orthonormal(const Camera& c) {
    EXPECT_NEAR(length(c.right), 1, kEpsilon);
    EXPECT_NEAR(length(c.up), 1, kEpsilon);
    EXPECT_NEAR(length(c.backward), 1, kEpsilon);
    EXPECT_NEAR(dot(c.right, c.up), 0, kEpsilon);
    EXPECT_NEAR(dot(c.right, c.backward), 0, kEpsilon);
    EXPECT_NEAR(length(cross(c.right, c.up) - c.backward), 0, kEpsilon);
}

double largest_axis_change(const Camera& a, const Camera& b) {
    return std::max(
        {length(a.right - b.right), length(a.up - b.up), length(a.backward - b.backward)});
}

// Where a world point lies in the image: x to the right and y up, in half-extents.
Vec2d project(const Camera& camera, const Vec3d& point, double aspect) {
    const Vec3d offset = point - camera.position;
    const double depth = -dot(offset, camera.backward);
    const Vec2d half = view_half_extents(camera, aspect);
    const double scale = camera.kind == CameraKind::perspective ? depth : 1;
    return Vec2d(dot(offset, camera.right) / (half.x * scale),
                 dot(offset, camera.up) / (half.y * scale));
}

TEST(CameraController, TakesOverAnyFrameUnchanged) {
    std::mt19937 random(7);
    std::normal_distribution<double> normal;
    for (int i = 0; i < 200; ++i) {
        Camera camera;
        camera.position = Vec3d(normal(random), normal(random), normal(random));
        camera.backward = normalize(Vec3d(normal(random), normal(random), normal(random)));
        const Vec3d other(normal(random), normal(random), normal(random));
        camera.right = normalize(cross(other, camera.backward));
        camera.up = cross(camera.backward, camera.right);
        CameraController controller;
        controller.set_camera(camera, 3);
        EXPECT_LT(largest_axis_change(controller.camera(), camera), 1e-9);
        EXPECT_LT(length(controller.camera().position - camera.position), 1e-9);
    }
}

TEST(CameraController, TakesOverViewsStraightUpAndDown) {
    for (const double sign : {1.0, -1.0}) {
        for (const double heading : {0.0, 0.7, 2.5, -3.0}) {
            Camera camera;
            camera.backward = Vec3d(0, sign, 0);
            camera.right = Vec3d(std::cos(heading), 0, -std::sin(heading));
            camera.up = cross(camera.backward, camera.right);
            CameraController controller;
            controller.set_camera(camera, 2);
            EXPECT_LT(largest_axis_change(controller.camera(), camera), 1e-9);
        }
    }
}

TEST(CameraController, OrbitStopsAtThePolesAndStaysContinuous) {
    CameraController controller;
    controller.set_camera(look_along(Vec3d(3, 1, 4), Vec3d(0, 0, 0)), length(Vec3d(3, 1, 4)));
    constexpr double kStep = 0.01;
    for (const double sense : {1.0, -1.0}) {
        for (int i = 0; i < 700; ++i) {
            const Camera before = controller.camera();
            controller.orbit(0.3 * kStep, sense * kStep);
            const Camera& after = controller.camera();
            expect_orthonormal(after);
            EXPECT_LT(largest_axis_change(before, after), 2 * kStep);
            EXPECT_NEAR(length(after.position), length(Vec3d(3, 1, 4)), 1e-9);
            // Never upside down.
            EXPECT_GE(after.up.y, -kEpsilon);
        }
        // The scene follows the pointer upwards, so the eye goes down.
        EXPECT_NEAR(controller.camera().backward.y, -sense, 1e-9);
    }
}

// Starting exactly over the pole, the heading decides; tiny moves make tiny changes.
TEST(CameraController, LeavesThePoleContinuously) {
    CameraController controller;
    controller.set_camera(look_along(Vec3d(0, 5, 0), Vec3d(0, 0, 0)), 5);
    for (double angle = 1e-8; angle < 1e-1; angle *= 10) {
        const Camera before = controller.camera();
        controller.orbit(0, -angle);
        EXPECT_LT(largest_axis_change(before, controller.camera()), 2 * angle);
        expect_orthonormal(controller.camera());
    }
}

TEST(CameraController, SceneFollowsThePointer) {
    CameraController controller;
    const Vec3d pivot(1, 2, 3);
    controller.set_camera(look_along(Vec3d(1, 2, 8), pivot), 5);
    const Vec3d front = pivot + 0.5 * normalize(controller.camera().backward);
    controller.orbit(0.1, 0);
    EXPECT_GT(project(controller.camera(), front, 1).x, 0);
    controller.orbit(-0.1, 0.1);
    EXPECT_GT(project(controller.camera(), front, 1).y, 0);

    controller.set_camera(look_along(Vec3d(1, 2, 8), pivot), 5);
    controller.pan(0.25, -0.125, 1.5);
    const Vec2d where = project(controller.camera(), pivot, 1.5);
    EXPECT_NEAR(where.x, 2 * 0.25 / 1.5, 1e-9);
    EXPECT_NEAR(where.y, -2 * 0.125, 1e-9);
}

TEST(CameraController, LookKeepsTheEye) {
    CameraController controller;
    controller.set_camera(look_along(Vec3d(3, 1, 4), Vec3d(0, 0, 0)), 5);
    const Vec3d eye = controller.camera().position;
    for (int i = 0; i < 50; ++i) controller.look(0.05, 0.03);
    EXPECT_LT(length(controller.camera().position - eye), 1e-9);
    expect_orthonormal(controller.camera());
}

TEST(CameraController, FlyMovesAlongTheView) {
    CameraController controller;
    controller.set_camera(look_along(Vec3d(0, 0, 5), Vec3d(0, 0, 0)), 5);
    controller.fly(Vec3d(1, 2, 3));
    EXPECT_LT(length(controller.camera().position - Vec3d(1, 2, 2)), 1e-12);
    EXPECT_LT(length(controller.target() - Vec3d(1, 2, -3)), 1e-12);
}

TEST(CameraController, DollyKeepsThePivotAndNeverReachesIt) {
    CameraController controller;
    controller.set_camera(look_along(Vec3d(0, 0, 5), Vec3d(0, 0, 0)), 5);
    controller.dolly(0.5);
    EXPECT_NEAR(controller.camera().position.z, 2.5, 1e-12);
    for (int i = 0; i < 1000; ++i) controller.dolly(0.5);
    EXPECT_GT(controller.distance(), 0);
    for (int i = 0; i < 2000; ++i) controller.dolly(2);
    EXPECT_TRUE(std::isfinite(controller.distance()));
    controller.dolly(0);
    controller.dolly(std::nan(""));
    EXPECT_GT(controller.distance(), 0);
}

TEST(CameraController, FrameShowsEveryCorner) {
    const Vec3d lower(-3, 0, -1);
    const Vec3d upper(5, 2, 7);
    for (const CameraKind kind : {CameraKind::perspective, CameraKind::orthographic}) {
        for (const double aspect : {0.3, 1.0, 2.4}) {
            for (const double theta : {0.0, 1.0, 2.0, 4.0}) {
                for (const double height : {-8.0, 0.0, 8.0}) {
                    Camera camera = look_along(
                        Vec3d(9 * std::sin(theta), height, 9 * std::cos(theta)), Vec3d(0));
                    camera.kind = kind;
                    camera.yfov = 0.6;
                    CameraController controller;
                    controller.set_scene_bounds(lower, upper);
                    controller.set_camera(camera, 9);
                    const Vec3d direction = controller.camera().backward;
                    controller.frame(lower, upper, aspect);
                    EXPECT_LT(length(controller.camera().backward - direction), 1e-12);
                    double widest = 0;
                    for (int corner = 0; corner < 8; ++corner) {
                        const Vec3d p((corner & 1) ? lower.x : upper.x,
                                      (corner & 2) ? lower.y : upper.y,
                                      (corner & 4) ? lower.z : upper.z);
                        const Vec2d where = project(controller.camera(), p, aspect);
                        widest = std::max({widest, std::abs(where.x), std::abs(where.y)});
                    }
                    EXPECT_LE(widest, 1);
                    EXPECT_GT(widest, 0.2);
                }
            }
        }
    }
}

TEST(CameraController, FrameOfAPointIsFinite) {
    CameraController controller;
    controller.set_camera(look_along(Vec3d(0, 0, 5), Vec3d(0)), 5);
    controller.frame(Vec3d(1), Vec3d(1), 1.5);
    EXPECT_GT(controller.distance(), 0);
    expect_orthonormal(controller.camera());
}

TEST(CameraController, FramingFocusesTheLens) {
    Camera camera = look_along(Vec3d(0, 0, 5), Vec3d(0));
    camera.aperture_radius = 0.1;
    CameraController controller;
    controller.set_camera(camera, 5);
    controller.frame(Vec3d(-1), Vec3d(1), 1.5);
    EXPECT_DOUBLE_EQ(controller.camera().focus_distance, controller.distance());
}

TEST(CameraController, EyeAtTheTargetChangesNothing) {
    CameraController controller;
    controller.set_camera(look_along(Vec3d(0, 0, 5), Vec3d(0)), 5);
    const Camera before = controller.camera();
    controller.look_from(Vec3d(1), Vec3d(1));
    EXPECT_EQ(largest_axis_change(before, controller.camera()), 0);
}

TEST(CameraController, NumericEntryLooksFromEyeToTarget) {
    CameraController controller;
    controller.look_from(Vec3d(4, 3, 0), Vec3d(0, 3, 0));
    EXPECT_LT(length(controller.camera().forward() - Vec3d(-1, 0, 0)), 1e-12);
    EXPECT_LT(length(controller.camera().up - Vec3d(0, 1, 0)), 1e-12);
    controller.look_from(Vec3d(0, 9, 0), Vec3d(0, 3, 0));
    expect_orthonormal(controller.camera());
    EXPECT_NEAR(controller.camera().backward.y, 1, 1e-12);
}

TEST(ViewHalfExtents, ExtendsNeverCrops) {
    Camera camera;
    camera.yfov = 2 * std::atan(0.5);
    camera.aspect_ratio = 2;
    EXPECT_NEAR(view_half_extents(camera, 3).y, 0.5, 1e-12);
    EXPECT_NEAR(view_half_extents(camera, 1).x, 1, 1e-12);
    EXPECT_NEAR(view_half_extents(camera, 1).y, 1, 1e-12);
}

}  // namespace
}  // namespace talbot
