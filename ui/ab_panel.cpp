// Two settings against each other: what B is, the error of each, and a verdict.
#include <imgui.h>

#include <algorithm>
#include <string>

#include "ui/number_text.h"
#include "ui/panels.h"
#include "ui/parameter_widgets.h"

namespace talbot {
namespace {

void draw_side(const char* name, const AbSide& side) {
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    ImGui::TextUnformatted(name);
    ImGui::TableNextColumn();
    if (side.relrmse_percent > 0) {
        ImGui::TextUnformatted(percent_text(side.relrmse_percent).c_str());
        if (ImGui::IsItemHovered()) {
            ImGui::SetTooltip("95 %% interval: %s to %s", percent_text(side.lo95).c_str(),
                              percent_text(side.hi95).c_str());
        }
    } else {
        ImGui::TextDisabled("-");
    }
    ImGui::TableNextColumn();
    ImGui::TextUnformatted(count_text(static_cast<double>(side.samples)).c_str());
    ImGui::TableNextColumn();
    ImGui::TextUnformatted(duration_text(side.seconds).c_str());
}

void draw_result(const AbSnapshot& ab) {
    if (ImGui::BeginTable("sides", 4, ImGuiTableFlags_SizingStretchProp)) {
        ImGui::TableSetupColumn("");
        ImGui::TableSetupColumn("Error");
        ImGui::TableSetupColumn("spp");
        ImGui::TableSetupColumn("Time");
        ImGui::TableHeadersRow();
        draw_side("A", ab.a);
        draw_side("B", ab.b);
        ImGui::EndTable();
    }
    const std::string& text = ab.verdict.text;
    ImGui::TextWrapped("%s", text.empty() ? "No verdict yet." : text.c_str());
}

}  // namespace

void draw_ab_panel(ViewerModel& model, const AbSnapshot* ab, bool comparing, AbRequest& request) {
    ImGui::TextWrapped("A is what is set under Render. B:");
    if (ImGui::Button("Copy A", ImVec2(-1, 0))) model.rival = model.settings;
    ImGui::PushID("rival");
    for (const Parameter<RenderSettings>& parameter : render_parameters()) {
        const std::string_view name = parameter.info.name;
        if (name == "width" || name == "height" || name == "tile_size") continue;
        edit_parameter(parameter, model.rival);
    }
    ImGui::PopID();
    model.rival.width = model.settings.width;
    model.rival.height = model.settings.height;
    const float third =
        (ImGui::GetContentRegionAvail().x - 2 * ImGui::GetStyle().ItemSpacing.x) / 3;
    request.start = ImGui::Button(comparing ? "Again" : "Compare", ImVec2(third, 0));
    ImGui::SameLine();
    request.stop = ImGui::Button("Stop", ImVec2(third, 0)) && comparing;
    ImGui::SameLine();
    request.close = ImGui::Button("Close", ImVec2(third, 0));
    if (ab) {
        draw_result(*ab);
    } else if (comparing) {
        ImGui::TextDisabled("Measuring ...");
    }
}

}  // namespace talbot
