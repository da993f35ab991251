// The part of the window that shows the image: mouse and keys there move the camera, clicks pick.
#pragma once

#include <optional>

#include "ui/display.h"
#include "ui/viewer_model.h"

namespace talbot {

struct ViewportResult {
    bool camera_changed = false;
    std::optional<Vec2f> click;  // framebuffer pixels
    std::optional<Vec2f> double_click;
};

// Covers `area` of the current ImGui frame with an invisible widget and applies what the user does
// there; image is where the rendered image lies. Flying takes `seconds` since the last frame.
ViewportResult handle_viewport(ViewerModel& model, const PixelRect& area, const PixelRect& image,
                               double seconds);

}  // namespace talbot
