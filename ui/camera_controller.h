// Moves a camera by hand: orbit, look, pan, dolly, fly, frame. Pure arithmetic without clock or
// window. The pose is kept as heading, inclination and roll, which stay defined when the view is
// straight up or down.
#pragma once

#include "core/scene/camera.h"

namespace talbot {

// Half the width and height of what an image of this shape shows: at distance 1 (perspective) or in
// metres (orthographic). The file's own view is extended to the image's shape, never cropped.
Vec2d view_half_extents(const Camera& camera, double aspect);

class CameraController {
  public:
    // The scene's size sets the speed of flying and the limits of the distance.
    void set_scene_bounds(const Vec3d& lower, const Vec3d& upper);

    // Takes over the camera; the pivot is the point at this distance on its axis.
    void set_camera(const Camera& camera, double pivot_distance);
    // Takes over everything but the pose.
    void set_optics(const Camera& camera);
    // Moves the eye to a place and turns it to a target; does nothing when they are the same point.
    void look_from(const Vec3d& position, const Vec3d& target);

    const Camera& camera() const { return camera_; }
    Vec3d target() const { return target_; }
    double distance() const { return distance_; }
    double scene_radius() const { return scene_radius_; }

    // Turns the eye round the pivot: the scene follows a pointer that moves by these angles to the
    // right and up (radians).
    void orbit(double right, double up);

    // Turns the view about the eye, towards the right and up (radians).
    void look(double right, double up);

    // Shifts eye and pivot so that the pivot follows a pointer that moves by these fractions of the
    // image's height.
    void pan(double right, double up, double aspect);

    // Multiplies the distance to the pivot (orthographic: also the size of the view).
    void dolly(double factor);

    // Moves eye and pivot along the camera's right, up and forward axes, in metres.
    void fly(const Vec3d& move);

    // Makes a point the pivot and turns the view to it; the eye stays.
    void aim_at(const Vec3d& point);

    // Moves back or forth, without turning, until the box fills the image; a lens is focused on its
    // centre.
    void frame(const Vec3d& lower, const Vec3d& upper, double aspect);

  private:
    void update_pose();

    Camera camera_;
    Vec3d target_{0};
    double distance_ = 1;
    double theta_ = 0;  // heading: backward = (sin phi sin theta, cos phi, sin phi cos theta)
    double phi_ = 0.5 * std::numbers::pi;
    double roll_ = 0;
    double scene_radius_ = 1;
};

}  // namespace talbot
