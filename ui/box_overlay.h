// The boxes of the acceleration structure drawn over the image.
#pragma once

#include <memory>

#include "core/geometry/tree_boxes.h"
#include "ui/display.h"
#include "ui/viewer_model.h"

namespace talbot {

class BoxOverlay {
  public:
    // Behind all panels of the current ImGui frame: the level that the model asks for, hidden
    // edges too, and a line that says how many there are.
    void draw(const ViewerModel& model, const PixelRect& image);

  private:
    void follow(const ViewerModel& model);

    // What the boxes are of.
    std::weak_ptr<const Scene> scene_;
    int level_ = -1;
    TreeBoxes boxes_;
};

}  // namespace talbot
