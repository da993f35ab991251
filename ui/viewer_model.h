// What the window shows and edits, as values; and the way from edits to the session's changes.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/film/tone_map.h"
#include "core/scene/scene.h"
#include "core/session/change.h"
#include "ui/camera_controller.h"
#include "ui/scene_loading.h"

namespace talbot {

// How the image is looked at beyond DisplaySettings.
struct ViewSettings {
    bool false_color = false;
    int bvh_boxes = -1;      // level of the boxes that are drawn over the image; below 0 none are
    bool fit_window = true;  // the image has as many pixels as its part of the window
    bool show_panels = true;
    bool show_help = false;
    double target_error_percent = 1;  // for the prediction
    double budget_seconds = 60;       // of further rendering, for the error that it buys
    bool stop_at_target = false;      // rendering rests when the target is reached
    Aov aov = Aov::beauty;            // what is shown
    float wipe = 0.5f;                // share of the image that shows A of a comparison
};

class EffectPriceJob;

struct ViewerModel {
    std::shared_ptr<const Scene> scene;  // as loaded; null before the first
    std::shared_ptr<GltfFile> file;      // that it came from; null where nothing can be chosen
    SceneChoice choice;                  // of the file's scenes, variants and moments: wanted
    SceneChoice shown_choice;            // what `scene` is
    bool playing = false;                // the animations run
    std::vector<Material> materials;     // with all edits, like everything below
    std::vector<PunctualLight> lights;
    Environment environment;
    CameraController view;
    RenderSettings settings;
    RenderSettings rival;  // that the settings are compared with
    DisplaySettings display;
    ViewSettings look;
    bool paused = false;
    uint64_t pass_limit = 0;
    std::optional<uint32_t> selected_object;
    uint32_t material = 0;                          // the one whose panel is open
    std::shared_ptr<EffectPriceJob> effect_prices;  // once they were asked for
    int camera = -1;  // of the file's list; -1 = moved by hand or none

    // The name that the panels show for a material, never empty.
    std::string material_name(uint32_t index) const;

    // What the file offers; empty without one.
    const GltfChoices& choices() const;

    // Width over height of the image.
    double aspect() const;
};

// What was edited since the last time changes were made of it.
struct Edits {
    bool scene = false;
    bool same_objects = false;  // with scene: it is the last one in another moment
    bool camera = false;
    bool environment = false;
    bool settings = false;
    bool paused = false;
    bool pass_limit = false;
    bool selection = false;
    bool aov = false;
    bool restart = false;
    std::set<uint32_t> materials;
    std::set<uint32_t> lights;

    bool any() const;
};

// Puts a scene on show: its tables become the model's, the camera its view.
void show_scene(ViewerModel& model, LoadedScene loaded, Edits& edits);

// Puts the same scene in another variant or moment on show: camera, selection and all that the user
// edited stay.
void replace_scene(ViewerModel& model, LoadedScene loaded, Edits& edits);

// Moves running animations on, over and over.
void advance_animation(ViewerModel& model, double seconds);

// Selects an object (or nothing) and opens its material.
void select_object(ViewerModel& model, std::optional<uint32_t> object,
                   std::optional<uint32_t> material, Edits& edits);

// Moves the view so that everything, or the selected object (else everything), fills the image;
// false without a scene.
bool frame_all(ViewerModel& model);
bool frame_selected(ViewerModel& model);

// Takes the file's camera of this index; false when there is none.
bool use_file_camera(ViewerModel& model, int index);

// The changes to submit, in order; the edits are empty afterwards.
std::vector<Change> take_changes(const ViewerModel& model, Edits& edits);

}  // namespace talbot
