// Which scene, variant and moment of the file is on show.
#include <imgui.h>

#include <algorithm>
#include <cmath>

#include "ui/panels.h"
#include "ui/parameter_widgets.h"

namespace talbot {
namespace {

// A combo box of names; true when another one was chosen.
bool choose(const char* label, const std::vector<std::string>& names, std::size_t& index) {
    begin_row(label);
    bool chosen = false;
    ImGui::PushID(label);
    if (ImGui::BeginCombo("##choice", index < names.size() ? names[index].c_str() : "")) {
        for (std::size_t i = 0; i < names.size(); ++i) {
            ImGui::PushID(static_cast<int>(i));
            if (ImGui::Selectable(names[i].c_str(), i == index) && i != index) {
                index = i;
                chosen = true;
            }
            ImGui::PopID();
        }
        ImGui::EndCombo();
    }
    ImGui::PopID();
    return chosen;
}

void draw_variants(ViewerModel& model, const std::vector<std::string>& variants) {
    std::vector<std::string> names{"The file's own"};
    names.insert(names.end(), variants.begin(), variants.end());
    std::size_t index = model.choice.variant ? *model.choice.variant + 1 : 0;
    if (!choose("Variant", names, index)) return;
    model.choice.variant.reset();
    if (index > 0) model.choice.variant = index - 1;
}

void draw_animations(ViewerModel& model, const GltfChoices& choices) {
    const double length = choices.last_key();
    const float half = 0.5f * (ImGui::GetContentRegionAvail().x - ImGui::GetStyle().ItemSpacing.x);
    if (ImGui::Button(model.playing ? "Stop" : "Play", ImVec2(half, 0)))
        model.playing = !model.playing;
    ImGui::SameLine();
    if (ImGui::Button("Rest pose", ImVec2(half, 0))) {
        model.playing = false;
        model.choice.seconds.reset();
    }
    begin_row("Time", "All animations of the file, at this time.");
    double seconds = model.choice.seconds.value_or(0);
    const double start = 0;
    const char* format = model.choice.seconds ? "%.2f s" : "rest pose";
    if (ImGui::SliderScalar("##time", ImGuiDataType_Double, &seconds, &start, &length, format)) {
        model.choice.seconds = std::clamp(seconds, start, length);
        model.playing = false;
    }
    begin_row("Shutter", "Motion blur: how long of the animations the shutter is open.");
    const double closed = 0;
    ImGui::SliderScalar("##shutter", ImGuiDataType_Double, &model.choice.shutter, &closed, &length,
                        model.choice.shutter > 0 ? "%.3f s" : "no motion blur",
                        ImGuiSliderFlags_Logarithmic);
    for (const GltfAnimation& animation : choices.animations)
        ImGui::TextDisabled("%s, %.3g s", animation.name.c_str(), animation.seconds);
}

}  // namespace

bool has_choices(const ViewerModel& model) {
    const GltfChoices& choices = model.choices();
    return choices.scenes.size() > 1 || !choices.variants.empty() || choices.last_key() > 0;
}

void draw_scene_panel(ViewerModel& model) {
    const GltfChoices& choices = model.choices();
    if (choices.scenes.size() > 1) choose("Scene", choices.scenes, model.choice.scene);
    if (!choices.variants.empty()) draw_variants(model, choices.variants);
    if (choices.last_key() > 0) draw_animations(model, choices);
}

}  // namespace talbot
