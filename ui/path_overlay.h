// A traced path drawn over the image: its vertices where the camera sees them, hidden parts too.
#pragma once

#include "core/integrate/replay.h"
#include "ui/display.h"
#include "ui/viewer_model.h"

namespace talbot {

// Behind all panels of the current ImGui frame.
void draw_path(const ReplayedPath& path, const ViewerModel& model, const PixelRect& image);

// A point of the world on the screen, by the model's camera; empty when it is behind that.
std::optional<Vec2f> screen_position(const ViewerModel& model, const PixelRect& image,
                                     const Vec3d& point);

}  // namespace talbot
