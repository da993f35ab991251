// Cameras: perspective with thin lens and lens shift, and orthographic; as data and as a maker of
// rays.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <tuple>

#include "core/geometry/accel.h"
#include "core/math/ray.h"
#include "core/math/ray_cone.h"
#include "core/math/vec.h"

namespace talbot {

enum class CameraKind : uint8_t { perspective, orthographic };

struct Resolution {
    uint32_t width = 0;
    uint32_t height = 0;

    bool operator==(const Resolution&) const = default;
};

// Looks along -Z of its frame, +Y up, +X right. The frame's axes are orthonormal (node scale is
// ignored, as glTF asks).
struct Camera {
    std::string name;
    CameraKind kind = CameraKind::perspective;
    Vec3d position{0};
    Vec3d right{1, 0, 0};
    Vec3d up{0, 1, 0};
    Vec3d backward{0, 0, 1};
    double yfov = 0.8;  // full vertical angle in radians, in (0, pi)
    std::optional<double>
        aspect_ratio;  // of the file; an image of another shape is extended, never cropped
    double xmag = 1;   // orthographic half-extents in metres
    double ymag = 1;
    Vec2d lens_shift{0};         // view window's centre, in units of the window's height
    double aperture_radius = 0;  // metres; 0 is a pinhole
    double focus_distance = 0;   // metres along the axis; 0 with an aperture means pinhole
    std::optional<Resolution> resolution;  // camera.extras.resolution

    Vec3d forward() const { return -backward; }
};

// Place and window of a camera, which animations move: to be compared, assigned or taken apart
// whole.
template <typename AnyCamera>
auto view_of(AnyCamera& camera) {
    return std::tie(camera.kind, camera.position, camera.right, camera.up, camera.backward,
                    camera.yfov, camera.xmag, camera.ymag);
}

// A camera at target + radius (sin phi sin theta, cos phi, sin phi cos theta), looking at the
// target, +Y up; at the poles the up vector falls back to the heading given by theta. Angles and
// fov in degrees.
struct Orbit {
    Vec3d target{0};
    double theta_degrees = 0;
    double phi_degrees = 90;
    double radius = 1;
    double yfov_degrees = 45;
};
Camera make_orbit_camera(const Orbit& orbit);

// An orthonormal frame that looks from eye to target; falls back to another up when it is parallel
// to the view.
void look_at(Camera& camera, const Vec3d& eye, const Vec3d& target,
             const Vec3d& up = Vec3d(0, 1, 0));

// A camera made ready for one image size in re-centred coordinates.
class CameraRays {
  public:
    // `bounds`, re-centred, of all that rays can hit: rays of a far camera begin near it, so that
    // their rounding is that of the scene's coordinates, not of the camera's. Empty: rays begin at
    // the camera.
    CameraRays(const Camera& camera, const Vec3d& scene_origin, uint32_t width, uint32_t height,
               const Bounds& bounds);

    // The ray through image position (px, py), pixels from the top left corner; lens in [0,1)^2. d
    // has unit length. Everything is calculated in double and rounded once.
    Ray ray(float px, float py, const Vec2f& lens) const;

    // The cone of one pixel about a ray of it, at the ray's origin: its solid angle, for an
    // orthographic camera its area.
    RayCone cone(const Ray& ray) const;

    // Metres from the camera's middle (an orthographic one: its plane) to the point at t of a ray.
    float distance_to(const Ray& ray, float t) const;

    bool has_lens() const { return aperture_radius_ > 0; }

    // Image position of a re-centred world point; empty when it is behind the camera.
    std::optional<Vec2f> project(const Vec3f& point) const;

  private:
    CameraKind kind_;
    float width_;
    float height_;
    double scale_x_;  // half-extents of the view window at distance 1 (perspective) or in metres
                      // (orthographic)
    double scale_y_;
    Vec2d shift_;  // in half-extents
    Vec3d position_;
    Vec3d center_{0};  // of a sphere round the scene
    float aperture_radius_;
    float focus_distance_;
    double reach_;  // the sphere's diameter
    Mat3d axes_;    // columns: right, up, backward
};

}  // namespace talbot
