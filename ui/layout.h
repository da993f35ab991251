// Where the panels stand: a fixed column on either side, the image between them, the status bar
// below.
#pragma once

#include "ui/display.h"
#include "ui/panels.h"

namespace talbot {

// The part of the framebuffer that the image gets.
PixelRect image_area(PixelSize framebuffer, float scale, bool show_panels);

// Draws all panels; what they change goes into model, edits and request.
void draw_panels(PixelSize framebuffer, float scale, ViewerModel& model, Edits& edits,
                 const Snapshot* snapshot, unsigned threads, const StatusLine& status,
                 FileForm& form, FileRequest& request);

// A message over the lower part of the image.
void draw_notice(const PixelRect& area, const std::string& text, bool is_error);

}  // namespace talbot
