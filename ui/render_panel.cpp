// Render settings and the controls of the session.
#include <imgui.h>

#include "ui/panels.h"
#include "ui/parameter_widgets.h"

namespace talbot {
bool draw_render_panel(ViewerModel& model, unsigned threads) {
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
