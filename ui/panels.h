// The panels: each draws into the current ImGui window, edits values in place and returns whether
// it did. None of them knows the session; what they ask for beyond values comes back as a request.
#pragma once

#include <optional>
#include <string>

#include "core/integrate/replay.h"
#include "core/session/ab_comparison.h"
#include "core/session/bias_ledger.h"
#include "core/session/error_shares.h"
#include "core/session/snapshot.h"
#include "ui/inspector.h"
#include "ui/viewer_model.h"

namespace talbot {

// Scenes, variants and animations of the file, and whether it has any to choose from.
void draw_scene_panel(ViewerModel& model);
bool has_choices(const ViewerModel& model);

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

// What is shown and how, and the pixel under the pointer. Notes in the edits when another variable
// is asked for; never restarts a render.
void draw_display_panel(ViewerModel& model, Edits& edits, const Snapshot* snapshot,
                        const std::optional<PixelReading>& reading);

// What is measured beside the render when it is asked for.
struct Diagnosis {
    bool measuring_bias = false;
    bool measuring_shares = false;
    std::optional<std::vector<BiasEntry>> bias;  // empty before it was measured
    std::optional<ErrorShares> shares;
};
struct DiagnosisRequest {
    bool bias = false;
    bool shares = false;
};

// Error with its interval and trust, its course over the seconds, the time to a target and what a
// time buys, where the error comes from, and the biased switches.
void draw_accuracy_panel(const Snapshot* snapshot, ViewerModel& model, Edits& edits,
                         const Diagnosis& diagnosis, DiagnosisRequest& request);

// Samples to look at. `chosen` is set to one whose path is asked for, `closed` when the path that
// is on show is to go.
void draw_samples_panel(const Snapshot* snapshot, const ReplayedPath* path,
                        std::optional<NotedSample>& chosen, bool& closed);

// What B is, the error of both sides and the verdict. Edits the model's rival.
struct AbRequest {
    bool start = false;
    bool stop = false;
    bool close = false;
};
void draw_ab_panel(ViewerModel& model, const AbSnapshot* ab, bool comparing, AbRequest& request);

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
