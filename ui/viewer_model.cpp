#include "ui/viewer_model.h"

#include <algorithm>
#include <cmath>

#include "ui/material_textures.h"

namespace talbot {
namespace {

// Where on its axis a new camera's pivot lies: at the scene's centre, as far as that is in front of
// it.
double pivot_distance(const Camera& camera, const Vec3d& lower, const Vec3d& upper) {
    const Vec3d centre = 0.5 * (lower + upper);
    const double depth = dot(centre - camera.position, camera.forward());
    const double radius = 0.5 * length(upper - lower);
    return std::max(depth, 0.25 * radius);
}

}  // namespace

std::string ViewerModel::material_name(uint32_t index) const {
    if (index >= materials.size()) return "none";
    if (!materials[index].name.empty()) return materials[index].name;
    return index == 0 ? "default material" : "material " + std::to_string(index);
}

double ViewerModel::aspect() const {
    return settings.height > 0 ? static_cast<double>(settings.width) / settings.height : 1.0;
}

bool Edits::any() const {
    return scene || camera || environment || settings || paused || pass_limit || selection || aov ||
           restart || !materials.empty() || !lights.empty();
}

const GltfChoices& ViewerModel::choices() const {
    static const GltfChoices kNone;
    return file ? file->choices() : kNone;
}

void show_scene(ViewerModel& model, LoadedScene loaded, Edits& edits) {
    const Camera& camera = loaded.camera;
    model.scene = std::move(loaded.scene);
    model.file = std::move(loaded.file);
    model.choice = loaded.choice;
    model.shown_choice = loaded.choice;
    model.playing = false;
    model.materials = model.scene->materials();
    model.lights = model.scene->punctual_lights();
    model.environment = model.scene->environment();
    model.selected_object.reset();
    model.material = model.materials.size() > 1 ? 1 : 0;
    model.camera = -1;
    const std::vector<Camera>& cameras = model.scene->cameras();
    for (std::size_t i = 0; i < cameras.size(); ++i) {
        if (cameras[i].position == camera.position && cameras[i].backward == camera.backward) {
            model.camera = static_cast<int>(i);
            break;
        }
    }
    Vec3d lower, upper;
    model.scene->world_bounds(lower, upper);
    model.view.set_scene_bounds(lower, upper);
    model.view.set_camera(camera, pivot_distance(camera, lower, upper));
    edits = Edits();
    edits.scene = true;
    edits.settings = true;
    edits.selection = true;
    edits.aov = true;
    edits.paused = true;
    edits.pass_limit = true;
}

void replace_scene(ViewerModel& model, LoadedScene loaded, Edits& edits) {
    const std::shared_ptr<const Scene> last = std::exchange(model.scene, std::move(loaded.scene));
    model.shown_choice = loaded.choice;
    const std::vector<Material>& materials = model.scene->materials();
    for (std::size_t i = 0; i < std::min(materials.size(), model.materials.size()); ++i) {
        const bool edited =
            i < last->materials().size() && model.materials[i] != last->materials()[i];
        if (edited) {
            // The table of textures may be another one.
            for (const MaterialTexture& texture : kMaterialTextures)
                model.materials[i].*texture.slot = materials[i].*texture.slot;
            edits.materials.insert(static_cast<uint32_t>(i));
        } else {
            model.materials[i] = materials[i];
        }
    }
    model.materials.resize(materials.size());
    const std::vector<PunctualLight>& lights = model.scene->punctual_lights();
    const bool same_lights =
        lights.size() == model.lights.size() && lights.size() == last->punctual_lights().size();
    for (std::size_t i = 0; same_lights && i < lights.size(); ++i) {
        if (model.lights[i] == last->punctual_lights()[i]) {
            model.lights[i] = lights[i];
        } else {
            edits.lights.insert(static_cast<uint32_t>(i));
        }
    }
    if (!same_lights) model.lights = lights;
    if (model.camera >= 0) use_file_camera(model, model.camera);
    edits.scene = true;
    edits.same_objects = true;
}

void advance_animation(ViewerModel& model, double seconds) {
    const double length = model.choices().last_key();
    if (!model.playing || !(length > 0)) return;
    model.choice.seconds = std::fmod(model.choice.seconds.value_or(0) + seconds, length);
}

void select_object(ViewerModel& model, std::optional<uint32_t> object,
                   std::optional<uint32_t> material, Edits& edits) {
    if (model.selected_object != object) edits.selection = true;
    model.selected_object = object;
    if (material && *material < model.materials.size()) model.material = *material;
}

bool frame_all(ViewerModel& model) {
    if (!model.scene) return false;
    Vec3d lower, upper;
    model.scene->world_bounds(lower, upper);
    model.view.frame(lower, upper, model.aspect());
    model.camera = -1;
    return true;
}

bool frame_selected(ViewerModel& model) {
    if (!model.scene || !model.selected_object) return frame_all(model);
    Vec3d lower, upper;
    model.scene->object_bounds(*model.selected_object, lower, upper);
    model.view.frame(lower, upper, model.aspect());
    model.camera = -1;
    return true;
}

bool use_file_camera(ViewerModel& model, int index) {
    if (!model.scene || index < 0 || index >= static_cast<int>(model.scene->cameras().size())) {
        return false;
    }
    const Camera& camera = model.scene->cameras()[static_cast<std::size_t>(index)];
    Vec3d lower, upper;
    model.scene->world_bounds(lower, upper);
    model.view.set_camera(camera, pivot_distance(camera, lower, upper));
    model.camera = index;
    return true;
}

std::vector<Change> take_changes(const ViewerModel& model, Edits& edits) {
    std::vector<Change> changes;
    // Settings come first, so that a new scene starts in its right size.
    if (edits.settings) changes.push_back(SetSettings{model.settings});
    if (edits.pass_limit) changes.push_back(SetPassLimit{model.pass_limit});
    if (edits.paused) changes.push_back(SetPaused{model.paused});
    if (edits.scene) {
        changes.push_back(SetScene{model.scene, model.view.camera(), edits.same_objects});
    } else if (edits.camera) {
        changes.push_back(SetCamera{model.view.camera()});
    }
    for (const uint32_t i : edits.materials) changes.push_back(SetMaterial{i, model.materials[i]});
    for (const uint32_t i : edits.lights) changes.push_back(SetPunctualLight{i, model.lights[i]});
    if (edits.environment) changes.push_back(SetEnvironment{model.environment});
    if (edits.selection) changes.push_back(SetSelection{model.selected_object});
    if (edits.aov) changes.push_back(SetAov{model.look.aov});
    if (edits.restart) changes.push_back(Restart{});
    edits = Edits();
    return changes;
}

}  // namespace talbot
