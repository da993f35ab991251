// Where the panels stand: a fixed column on either side, the image between them, the status bar
// below.
#pragma once

#include "ui/display.h"
#include "ui/panels.h"

namespace talbot {

// The part of the framebuffer that the image gets.
PixelRect image_area(PixelSize framebuffer, float scale, bool show_panels);

// What the panels show beyond the model.
struct PanelView {
    const Snapshot* snapshot = nullptr;  // null before the first image
    unsigned threads = 0;
    StatusLine status;
    std::optional<PixelReading> reading;  // under the pointer
    const ReplayedPath* path = nullptr;   // on show
    Diagnosis diagnosis;
    const AbSnapshot* ab = nullptr;  // null until there is something to show
    bool comparing = false;
};
// What they ask for beyond edits.
struct PanelRequests {
    FileRequest file;
    std::optional<NotedSample> retrace;
    bool hide_path = false;
    DiagnosisRequest diagnosis;
    AbRequest ab;
};

// Draws all panels; what they change goes into model, edits and requests.
void draw_panels(PixelSize framebuffer, float scale, ViewerModel& model, Edits& edits,
                 const PanelView& view, FileForm& form, PanelRequests& requests);

// A message over the lower part of the image.
void draw_notice(const PixelRect& area, const std::string& text, bool is_error);

}  // namespace talbot
