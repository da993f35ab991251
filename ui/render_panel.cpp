// Render settings, effects with their witnesses, and the controls of the session.
#include <imgui.h>

#include "ui/panels.h"
#include "ui/parameter_widgets.h"

namespace talbot {
namespace {

// Every effect: lit when active, with who asks for it; a check box forces an inactive one on.
bool draw_effects(RenderSettings& settings, const Snapshot& snapshot) {
    bool changed = false;
    const EffectReport& effects = snapshot.effects;
    if (!snapshot.kernel.empty()) text_row("Kernel", "%s", snapshot.kernel.c_str());
    for (const EffectInfo& info : kEffects) {
        const bool active = effects.active.has(info.effect);
        bool on = active || settings.forced_on.has(info.effect);
        ImGui::PushID(static_cast<int>(info.effect));
        ImGui::PushStyleColor(ImGuiCol_Text, ImGui::GetStyleColorVec4(
                                                 active ? ImGuiCol_Text : ImGuiCol_TextDisabled));
        if (ImGui::Checkbox(info.label.data(), &on) && !active) {
            if (on) {
                settings.forced_on.add(info.effect);
            } else {
                settings.forced_on.remove(info.effect);
            }
            changed = true;
        }
        ImGui::PopStyleColor();
        if (ImGui::IsItemHovered()) {
            const std::string& witness = effects.witness[static_cast<std::size_t>(info.effect)];
            if (active) {
                ImGui::SetTooltip("Asked for by %s",
                                  witness.empty() ? "the scene" : witness.c_str());
            } else {
                ImGui::SetTooltip(
                    "Not in this scene. Forced on it costs time and changes nothing.");
            }
        }
        ImGui::PopID();
    }
    return changed;
}

}  // namespace

bool draw_render_panel(ViewerModel& model, const Snapshot* snapshot, unsigned threads) {
    bool changed = false;
    for (const Parameter<RenderSettings>& parameter : render_parameters()) {
        const std::string_view name = parameter.info.name;
        const bool is_size = name == "width" || name == "height";
        if (is_size && model.look.fit_window) continue;
        changed |= edit_parameter(parameter, model.settings);
    }
    if (model.look.fit_window) {
        text_row("Size", "%u \xC3\x97 %u px", model.settings.width, model.settings.height);
    }
    edit_named(display_parameters(), "fit_window", model);
    text_row("Threads", "%u", threads);
    if (snapshot && ImGui::TreeNodeEx("Effects", ImGuiTreeNodeFlags_SpanAvailWidth)) {
        changed |= draw_effects(model.settings, *snapshot);
        ImGui::TreePop();
    }
    return changed;
}

bool draw_session_panel(ViewerModel& model, Edits& edits, const Snapshot* snapshot) {
    bool changed = false;
    const float half = 0.5f * (ImGui::GetContentRegionAvail().x - ImGui::GetStyle().ItemSpacing.x);
    if (ImGui::Button(model.paused ? "Resume" : "Pause", ImVec2(half, 0))) {
        model.paused = !model.paused;
        edits.paused = true;
        changed = true;
    }
    ImGui::SameLine();
    if (ImGui::Button("Restart", ImVec2(half, 0))) {
        edits.restart = true;
        changed = true;
    }
    if (edit_named(session_parameters(), "pass_limit", model)) {
        edits.pass_limit = true;
        changed = true;
    }
    if (model.pass_limit > 0 && snapshot) {
        const float done =
            static_cast<float>(snapshot->passes) / static_cast<float>(model.pass_limit);
        ImGui::ProgressBar(std::min(done, 1.0f), ImVec2(-1, 4 * ImGui::GetFontSize() / 14), "");
    }
    return changed;
}

}  // namespace talbot
