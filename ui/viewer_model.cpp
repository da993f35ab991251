#include "ui/viewer_model.h"

#include <algorithm>

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
    return scene || camera || environment || settings || paused || pass_limit || selection ||
           restart || !materials.empty() || !lights.empty();
}

void show_scene(ViewerModel& model, std::shared_ptr<const Scene> scene, const Camera& camera,
                Edits& edits) {
    model.scene = std::move(scene);
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
    edits.paused = true;
    edits.pass_limit = true;
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
        changes.push_back(SetScene{model.scene, model.view.camera()});
    } else if (edits.camera) {
        changes.push_back(SetCamera{model.view.camera()});
    }
    for (const uint32_t i : edits.materials) changes.push_back(SetMaterial{i, model.materials[i]});
    for (const uint32_t i : edits.lights) changes.push_back(SetPunctualLight{i, model.lights[i]});
    if (edits.environment) changes.push_back(SetEnvironment{model.environment});
    if (edits.selection) changes.push_back(SetSelection{model.selected_object});
    if (edits.restart) changes.push_back(Restart{});
    edits = Edits();
    return changes;
}

}  // namespace talbot
