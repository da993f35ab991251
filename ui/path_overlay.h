// A traced path drawn over the image: its vertices where the camera sees them, hidden parts too.
#pragma once

#include "core/integrate/replay.h"
#include "ui/display.h"
#include "ui/viewer_model.h"

namespace talbot {

// Behind all panels of the current ImGui frame.
void draw_path(const ReplayedPath& path, const ViewerModel& model, const PixelRect& image);

}  // namespace talbot
