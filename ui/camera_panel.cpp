// Cameras of the file, pose, lens.
#include <imgui.h>

#include "ui/panels.h"
#include "ui/parameter_widgets.h"

namespace talbot {
namespace {

std::string camera_name(const std::vector<Camera>& cameras, int index) {
    if (index < 0) return "Free view";
    const std::string& name = cameras[static_cast<std::size_t>(index)].name;
    return name.empty() ? "Camera " + std::to_string(index) : name;
}

// The file's cameras as a combo; true when one was chosen.
bool draw_camera_list(ViewerModel& model) {
    static const std::vector<Camera> kNone;
    const std::vector<Camera>& cameras = model.scene ? model.scene->cameras() : kNone;
    begin_row("View");
    bool chosen = false;
    if (ImGui::BeginCombo("##view", camera_name(cameras, model.camera).c_str())) {
        for (int i = 0; i < static_cast<int>(cameras.size()); ++i) {
            ImGui::PushID(i);
            if (ImGui::Selectable(camera_name(cameras, i).c_str(), i == model.camera)) {
                model.camera = i;
                chosen = true;
            }
            ImGui::PopID();
        }
        if (cameras.empty()) ImGui::TextDisabled("The file has no camera.");
        ImGui::EndCombo();
    }
    if (chosen) use_file_camera(model, model.camera);
    return chosen;
}

}  // namespace

bool draw_camera_panel(ViewerModel& model) {
    bool changed = draw_camera_list(model);
    const bool perspective = model.view.camera().kind == CameraKind::perspective;
    bool moved = false;
    for (const Parameter<CameraController>& parameter : camera_parameters()) {
        const std::string_view name = parameter.info.name;
        if (name == "yfov" || (perspective ? name == "ymag" : name == "yfov_degrees")) continue;
        moved |= edit_parameter(parameter, model.view);
    }
    if (moved) model.camera = -1;
    changed |= moved;

    const float half = 0.5f * (ImGui::GetContentRegionAvail().x - ImGui::GetStyle().ItemSpacing.x);
    if (ImGui::Button("Frame all", ImVec2(half, 0))) changed |= frame_all(model);
    ImGui::SameLine();
    if (ImGui::Button("Frame selected", ImVec2(half, 0))) changed |= frame_selected(model);
    return changed;
}

}  // namespace talbot
