// One line at the bottom of the window.
#include <imgui.h>

#include "ui/number_text.h"
#include "ui/panels.h"

namespace talbot {
namespace {

struct StateText {
    const char* text;
    ImVec4 color;
};

StateText state_of(const ViewerModel& model, const Snapshot* snapshot) {
    if (!model.scene) return {"No scene", ImVec4(0.5f, 0.5f, 0.5f, 1)};
    if (!snapshot) return {"Starting", ImVec4(0.95f, 0.72f, 0.22f, 1)};
    if (model.paused) return {"Paused", ImVec4(0.95f, 0.72f, 0.22f, 1)};
    if (snapshot->finished) return {"Limit reached", ImVec4(0.45f, 0.66f, 0.95f, 1)};
    if (snapshot->preview) return {"Preview", ImVec4(0.95f, 0.72f, 0.22f, 1)};
    return {"Rendering", ImVec4(0.36f, 0.78f, 0.42f, 1)};
}

// A cell of the line: starts at a fixed column, so that changing digits do not make the rest jump.
void cell(float& x, float width, const std::string& text) {
    ImGui::SameLine(x);
    ImGui::TextUnformatted(text.c_str());
    x += width;
}

}  // namespace

void draw_status_bar(const ViewerModel& model, const Snapshot* snapshot, const StatusLine& status) {
    const float em = ImGui::GetFontSize();
    const StateText state = state_of(model, snapshot);
    const ImVec2 corner = ImGui::GetCursorScreenPos();
    ImGui::GetWindowDrawList()->AddCircleFilled(ImVec2(corner.x + 0.4f * em, corner.y + 0.55f * em),
                                                0.3f * em, ImGui::GetColorU32(state.color));
    ImGui::Dummy(ImVec2(em, em));
    float x = ImGui::GetStyle().WindowPadding.x + 1.3f * em;
    cell(x, 7.5f * em, state.text);
    if (snapshot) {
        cell(x, 7 * em, count_text(static_cast<double>(snapshot->passes)) + " spp");
        cell(x, 7 * em, duration_text(snapshot->render_seconds));
        cell(x, 10 * em, count_text(snapshot->samples_per_second) + " samples/s");
        cell(x, 8 * em,
             std::to_string(snapshot->full_width) + " \xC3\x97 " +
                 std::to_string(snapshot->full_height));
        if (snapshot->error.valid)
            cell(x, 9 * em, "error " + percent_text(snapshot->error.relrmse_percent));
        if (snapshot->nonfinite.total() > 0) {
            cell(x, 10 * em,
                 count_text(static_cast<double>(snapshot->nonfinite.total())) + " bad samples");
        }
    }
    if (!status.busy.empty()) cell(x, 20 * em, status.busy);
    const char* hint = "F1 help";
    const float right =
        ImGui::GetWindowWidth() - ImGui::CalcTextSize(hint).x - ImGui::GetStyle().WindowPadding.x;
    if (right > x) {
        ImGui::SameLine(right);
        ImGui::TextDisabled("%s", hint);
    }
}

}  // namespace talbot
