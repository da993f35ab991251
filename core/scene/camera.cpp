#include "core/scene/camera.h"

#include <cmath>
#include <limits>
#include <numbers>

#include "core/math/robust.h"
#include "core/math/warp.h"
#include "core/scene/compiled_effects.h"

namespace talbot {
namespace {

double radians(double degrees) {
    return degrees * (std::numbers::pi / 180);
}

}  // namespace

void look_at(Camera& camera, const Vec3d& eye, const Vec3d& target, const Vec3d& up) {
    camera.position = eye;
    Vec3d backward = eye - target;
    const double distance = length(backward);
    backward = distance > 0 ? backward / distance : Vec3d(0, 0, 1);
    Vec3d right = cross(up, backward);
    if (!(dot(right, right) > kParallelSine * kParallelSine * dot(up, up))) {
        // The view is along `up`: keep a right vector that is least aligned with it.
        right = cross(std::abs(backward.x) < std::abs(backward.z) ? Vec3d(1, 0, 0) : Vec3d(0, 0, 1),
                      backward);
    }
    camera.right = normalize(right);
    camera.backward = backward;
    camera.up = cross(backward, camera.right);
}

Camera make_orbit_camera(const Orbit& orbit) {
    const double theta = radians(orbit.theta_degrees);
    const double phi = radians(orbit.phi_degrees);
    Camera camera;
    camera.name = "orbit";
    camera.yfov = radians(orbit.yfov_degrees);
    camera.backward =
        Vec3d(std::sin(phi) * std::sin(theta), std::cos(phi), std::sin(phi) * std::cos(theta));
    camera.position = orbit.target + orbit.radius * camera.backward;
    // The derivative of the position by theta, which is defined at the poles too.
    const double side = std::sin(phi) < 0 ? -1.0 : 1.0;
    camera.right = side * Vec3d(std::cos(theta), 0, -std::sin(theta));
    camera.up = cross(camera.backward, camera.right);
    return camera;
}

CameraRays::CameraRays(const Camera& camera, const Vec3d& scene_origin, uint32_t width,
                       uint32_t height, const Bounds& bounds)
    : kind_(camera.kind),
      width_(static_cast<float>(width)),
      height_(static_cast<float>(height)),
      position_(camera.position - scene_origin),
      reach_(std::numeric_limits<double>::infinity()),
      axes_(camera.right, camera.up, camera.backward) {
    if (!bounds.is_empty()) {
        center_ = 0.5 * (Vec3d(bounds.lower) + Vec3d(bounds.upper));
        reach_ = length(Vec3d(bounds.upper) - Vec3d(bounds.lower));
    }
    const double image_aspect = static_cast<double>(width) / height;
    if (kind_ == CameraKind::perspective) {
        scale_y_ = std::tan(camera.yfov / 2);
        // A window narrower than the file's shows the file's whole width, so nothing of the view is
        // cropped.
        if (camera.aspect_ratio && image_aspect < *camera.aspect_ratio)
            scale_y_ *= *camera.aspect_ratio / image_aspect;
        scale_x_ = scale_y_ * image_aspect;
    } else {
        scale_x_ = camera.xmag;
        scale_y_ = camera.ymag;
        if (scale_x_ > scale_y_ * image_aspect) {
            scale_y_ = scale_x_ / image_aspect;
        } else {
            scale_x_ = scale_y_ * image_aspect;
        }
    }
    // A shift of 1 is one window height, two half-extents in y.
    shift_ = 2.0 * camera.lens_shift * Vec2d(scale_y_, scale_y_);
    const bool lens = camera.aperture_radius > 0 && camera.focus_distance > 0;
    aperture_radius_ = lens ? static_cast<float>(camera.aperture_radius) : 0.0f;
    focus_distance_ = static_cast<float>(camera.focus_distance);
}

Ray CameraRays::ray(float px, float py, const Vec2f& lens) const {
    const double x = (2.0 * px / width_ - 1) * scale_x_ + shift_.x;
    const double y = (1 - 2.0 * py / height_) * scale_y_ + shift_.y;
    Vec3d direction(0, 0, -1);
    Vec3d origin(0);
    if (kind_ == CameraKind::orthographic) {
        origin = Vec3d(x, y, 0);
    } else {
        direction = Vec3d(x, y, -1);
        if (kCompiledEffects.has(Effect::depth_of_field) && aperture_radius_ > 0) {
            const Vec2f disk = aperture_radius_ * sample_concentric_disk(lens);
            origin = Vec3d(disk.x, disk.y, 0);
            // Divided, not multiplied: a focus at infinity makes rays parallel.
            direction -= origin / static_cast<double>(focus_distance_);
        }
        direction = normalize(direction);
    }
    origin = position_ + axes_ * origin;
    direction = axes_ * direction;
    // Nothing lies nearer than half the sphere's diameter before its middle; the other half is
    // room for rounding.
    const double start = dot(center_ - origin, direction) - reach_;
    if (start > 0) origin += start * direction;
    Ray ray;
    ray.o = Vec3f(origin);
    ray.d = Vec3f(direction);
    return ray;
}

RayCone CameraRays::cone(const Ray& ray) const {
    const double side =
        2 * std::sqrt(scale_x_ * scale_y_ / (static_cast<double>(width_) * height_));
    if (kind_ == CameraKind::orthographic) return {static_cast<float>(side), 0};
    // The window at distance 1 is seen from further away and aslant.
    const double cosine = -dot(Vec3d(ray.d), axes_[2]);
    const double spread = side * cosine * std::sqrt(cosine);
    const double depth = dot(position_ - Vec3d(ray.o), axes_[2]);
    return {static_cast<float>(spread * depth / cosine), static_cast<float>(spread)};
}

float CameraRays::distance_to(const Ray& ray, float t) const {
    const Vec3d to = Vec3d(ray.o) + static_cast<double>(t) * Vec3d(ray.d) - position_;
    return static_cast<float>(kind_ == CameraKind::orthographic ? -dot(to, axes_[2]) : length(to));
}

std::optional<Vec2f> CameraRays::project(const Vec3f& point) const {
    const Vec3d local = glm::transpose(axes_) * (Vec3d(point) - position_);
    double x = local.x;
    double y = local.y;
    if (kind_ == CameraKind::perspective) {
        if (!(local.z < 0)) return std::nullopt;
        x /= -local.z;
        y /= -local.z;
    }
    return Vec2f(Vec2d((x - shift_.x) / scale_x_ + 1, 1 - (y - shift_.y) / scale_y_) * 0.5 *
                 Vec2d(width_, height_));
}

}  // namespace talbot
