// A comparison of two settings in the window: the image is A on the left of a line and B on its
// right.
#pragma once

#include <memory>

#include "core/session/ab_comparison.h"
#include "ui/display.h"
#include "ui/viewer_model.h"

namespace talbot {

class AbView {
  public:
    explicit AbView(const GlFunctions& gl) : display_(gl) {}

    Status load() { return display_.load(); }

    // Compares the model's settings with its rival's for the view on show.
    void start(const ViewerModel& model, const Snapshot& shown, unsigned threads);
    void stop();
    // Forgets the result, too.
    void close();

    bool is_open() const { return open_; }
    bool is_running() const;
    // Null until there is something to show.
    std::shared_ptr<const AbSnapshot> latest() const {
        return open_ ? comparison_.latest() : nullptr;
    }

    // The line between the two, which can be dragged; in the current ImGui frame.
    void draw_line(ViewerModel& model, const PixelRect& image) const;
    // Both images into the bound framebuffer. False before there are any.
    bool draw(const GlFunctions& gl, Display& first, const PixelRect& rect, PixelSize framebuffer,
              const ViewerModel& model, const DisplayOverlay& overlay);

  private:
    AbComparison comparison_;
    Display display_;
    bool open_ = false;
};

}  // namespace talbot
