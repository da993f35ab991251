// The panels: each draws into the current ImGui window, edits values in place and returns whether
// it did. None of them knows the session; what they ask for beyond values comes back as a request.
#pragma once

#include <optional>
#include <string>

#include "core/session/snapshot.h"
#include "ui/viewer_model.h"

namespace talbot {

// Cameras of the file, pose, lens. True when the camera moved or changed.
bool draw_camera_panel(ViewerModel& model);

// The open material: every factor, the textures by name. True when materials[model.material]
// changed.
bool draw_material_panel(ViewerModel& model);

// Environment and punctual lights; notes what changed in the edits.
bool draw_lights_panel(ViewerModel& model, Edits& edits);

// Size, depth, sampler and so on. True when the settings changed.
bool draw_render_panel(ViewerModel& model, unsigned threads);

// Every effect with who asks for it, its switch and its prices. True when the settings changed.
bool draw_effects_panel(ViewerModel& model, const Snapshot* snapshot);

// Pause, restart, sample limit; notes what changed in the edits.
bool draw_session_panel(ViewerModel& model, Edits& edits, const Snapshot* snapshot);

// Exposure, tone map, channel. True when something changed; never restarts a render.
bool draw_display_panel(ViewerModel& model);

// Error with its interval and trust, its course over the seconds, and the time to a target. True
// when the target changed.
bool draw_accuracy_panel(const Snapshot* snapshot, ViewSettings& look);

// What the file panel asks for.
struct FileRequest {
    std::optional<std::string> open;
    std::optional<std::string> save;
};
// The texts that the user types into the file panel.
struct FileForm {
    std::string open_path;
    std::string save_path = "talbot.png";
    bool focus_open_path = false;
};
bool draw_file_panel(const ViewerModel& model, FileForm& form, FileRequest& request);

// One line at the bottom: state, samples, seconds, samples/s, size, error.
struct StatusLine {
    std::string busy;  // e.g. "loading ToyCar.gltf 40 %"; empty when nothing runs in the background
    double frames_per_second = 0;
};
void draw_status_bar(const ViewerModel& model, const Snapshot* snapshot, const StatusLine& status);

// Keys and mouse, over the image. False once the user closes it.
bool draw_help_overlay();

}  // namespace talbot
