#include "ui/camera_controller.h"

#include <algorithm>
#include <cmath>

#include "core/math/robust.h"

namespace talbot {
namespace {

// Distances to the pivot, in scene radii: close enough to see single triangles, far enough to see a
// speck.
constexpr double kNearestDistance = 0x1p-20;
constexpr double kFarthestDistance = 0x1p+20;

// Below this the horizontal part of an axis gives no heading.
constexpr double kVertical = 0x1p-40;

// The framed box leaves this much of the image free.
constexpr double kFrameMargin = 1.06;

}  // namespace

Vec2d view_half_extents(const Camera& camera, double aspect) {
    const bool perspective = camera.kind == CameraKind::perspective;
    double y = perspective ? std::tan(0.5 * camera.yfov) : camera.ymag;
    const double own_aspect =
        perspective ? camera.aspect_ratio.value_or(aspect) : camera.xmag / camera.ymag;
    if (own_aspect > aspect) y *= own_aspect / aspect;
    return Vec2d(y * aspect, y);
}

void CameraController::set_scene_bounds(const Vec3d& lower, const Vec3d& upper) {
    const double radius = 0.5 * length(upper - lower);
    scene_radius_ = radius > 0 && is_finite(radius) ? radius : 1;
}

void CameraController::set_camera(const Camera& camera, double pivot_distance) {
    camera_ = camera;
    distance_ = is_finite(pivot_distance)
                    ? std::clamp(pivot_distance, kNearestDistance * scene_radius_,
                                 kFarthestDistance * scene_radius_)
                    : scene_radius_;
    target_ = camera.position - distance_ * camera.backward;

    const Vec3d& b = camera.backward;
    const double horizontal = std::hypot(b.x, b.z);
    phi_ = std::atan2(horizontal, b.y);
    theta_ =
        horizontal > kVertical ? std::atan2(b.x, b.z) : std::atan2(-camera.right.z, camera.right.x);
    const Vec3d level_right(std::cos(theta_), 0, -std::sin(theta_));
    const Vec3d level_up = cross(b, level_right);
    roll_ = std::atan2(dot(camera.right, level_up), dot(camera.right, level_right));
    update_pose();
}

void CameraController::set_optics(const Camera& camera) {
    const Camera pose = camera_;
    camera_ = camera;
    camera_.position = pose.position;
    camera_.right = pose.right;
    camera_.up = pose.up;
    camera_.backward = pose.backward;
}

void CameraController::look_from(const Vec3d& position, const Vec3d& target) {
    const Vec3d offset = position - target;
    const double distance = length(offset);
    if (!(distance > 0) || !is_finite(distance)) return;
    const double horizontal = std::hypot(offset.x, offset.z);
    phi_ = std::atan2(horizontal, offset.y);
    if (horizontal > kVertical * distance) theta_ = std::atan2(offset.x, offset.z);
    roll_ = 0;
    target_ = target;
    distance_ = distance;
    update_pose();
}

void CameraController::orbit(double right, double up) {
    const double level_right = std::cos(roll_) * right - std::sin(roll_) * up;
    const double level_up = std::sin(roll_) * right + std::cos(roll_) * up;
    theta_ = std::remainder(theta_ - level_right, 2 * std::numbers::pi);
    phi_ = std::clamp(phi_ + level_up, 0.0, std::numbers::pi);
    update_pose();
}

void CameraController::look(double right, double up) {
    const Vec3d eye = camera_.position;
    const double level_right = std::cos(roll_) * right - std::sin(roll_) * up;
    const double level_up = std::sin(roll_) * right + std::cos(roll_) * up;
    theta_ = std::remainder(theta_ - level_right, 2 * std::numbers::pi);
    phi_ = std::clamp(phi_ + level_up, 0.0, std::numbers::pi);
    update_pose();
    target_ = eye - distance_ * camera_.backward;
    camera_.position = eye;
}

void CameraController::pan(double right, double up, double aspect) {
    const double height = 2 * view_half_extents(camera_, aspect).y *
                          (camera_.kind == CameraKind::perspective ? distance_ : 1.0);
    target_ -= height * (right * camera_.right + up * camera_.up);
    update_pose();
}

void CameraController::dolly(double factor) {
    if (!(factor > 0) || !is_finite(factor)) return;
    const double wanted = std::clamp(distance_ * factor, kNearestDistance * scene_radius_,
                                     kFarthestDistance * scene_radius_);
    if (camera_.kind == CameraKind::orthographic) {
        camera_.xmag *= wanted / distance_;
        camera_.ymag *= wanted / distance_;
    }
    distance_ = wanted;
    update_pose();
}

void CameraController::fly(const Vec3d& move) {
    if (!is_finite(move)) return;
    target_ += move.x * camera_.right + move.y * camera_.up - move.z * camera_.backward;
    update_pose();
}

void CameraController::aim_at(const Vec3d& point) {
    const double roll = roll_;
    look_from(camera_.position, point);
    roll_ = roll;
    update_pose();
}

void CameraController::frame(const Vec3d& lower, const Vec3d& upper, double aspect) {
    const double extent = 0.5 * length(upper - lower);
    if (!is_finite(extent) || !is_finite(lower)) return;
    const double radius = kFrameMargin * (extent > 0 ? extent : scene_radius_);
    target_ = 0.5 * (lower + upper);
    const Vec2d half = view_half_extents(camera_, aspect);
    const double smaller = std::min(half.x, half.y);
    if (camera_.kind == CameraKind::orthographic) {
        camera_.xmag *= radius / smaller;
        camera_.ymag *= radius / smaller;
        distance_ = 4 * radius;
    } else {
        distance_ = radius / std::sin(std::atan(smaller));
    }
    if (camera_.aperture_radius > 0) camera_.focus_distance = distance_;
    update_pose();
}

void CameraController::update_pose() {
    const double sin_phi = std::sin(phi_);
    camera_.backward =
        Vec3d(sin_phi * std::sin(theta_), std::cos(phi_), sin_phi * std::cos(theta_));
    const Vec3d level_right(std::cos(theta_), 0, -std::sin(theta_));
    const Vec3d level_up = cross(camera_.backward, level_right);
    camera_.right = std::cos(roll_) * level_right + std::sin(roll_) * level_up;
    camera_.up = std::cos(roll_) * level_up - std::sin(roll_) * level_right;
    camera_.position = target_ + distance_ * camera_.backward;
}

}  // namespace talbot
