// Where points and lines of the world are on the screen, by the model's camera.
#pragma once

#include <optional>

#include "core/scene/camera.h"
#include "ui/display.h"
#include "ui/viewer_model.h"

namespace talbot {

struct ScreenLine {
    Vec2f from;
    Vec2f to;
};

// For one frame: the model's camera, and the place of its image on the screen.
class ScreenMap {
  public:
    ScreenMap(const ViewerModel& model, const PixelRect& image);

    // Empty when the point is behind the camera.
    std::optional<Vec2f> point(const Vec3d& world) const;

    // The part of a segment that is before the camera; empty when none is.
    std::optional<ScreenLine> line(const Vec3d& a, const Vec3d& b) const;

  private:
    Vec2f visible_end(Vec3d visible, Vec3d hidden, Vec2f at) const;

    Vec3d origin_;
    CameraRays rays_;
    Vec2f corner_;
    Vec2f scale_;
};

}  // namespace talbot
