// The estimated error: how large, how sure, how it fell, and when it will reach a target.
#include <imgui.h>

#include <algorithm>
#include <cmath>

#include "ui/error_plot.h"
#include "ui/number_text.h"
#include "ui/panels.h"
#include "ui/parameter_widgets.h"

namespace talbot {
namespace {

ImVec4 trust_color(Trust trust) {
    switch (trust) {
        case Trust::green:
            return ImVec4(0.36f, 0.78f, 0.42f, 1);
        case Trust::amber:
            return ImVec4(0.95f, 0.72f, 0.22f, 1);
        case Trust::red:
            return ImVec4(0.92f, 0.34f, 0.30f, 1);
        case Trust::unknown:
            break;
    }
    return ImVec4(0.5f, 0.5f, 0.5f, 1);
}

void draw_trust(const ErrorEstimate& error) {
    begin_row("Trust", error.why);
    const ImVec2 corner = ImGui::GetCursorScreenPos();
    const float size = ImGui::GetFrameHeight();
    ImGui::GetWindowDrawList()->AddCircleFilled(
        ImVec2(corner.x + 0.35f * size, corner.y + 0.5f * size), 0.26f * size,
        ImGui::GetColorU32(trust_color(error.trust)));
    ImGui::Dummy(ImVec2(0.8f * size, size));
    ImGui::SameLine(0, 0);
    ImGui::AlignTextToFramePadding();
    const std::string_view name = trust_name(error.trust);
    ImGui::TextUnformatted(name.data(), name.data() + name.size());
    if (!error.why.empty()) {
        ImGui::PushStyleColor(ImGuiCol_Text, ImGui::GetStyleColorVec4(ImGuiCol_TextDisabled));
        ImGui::TextWrapped("%s", error.why.c_str());
        ImGui::PopStyleColor();
    }
}

bool draw_target(const ErrorEstimate& error, ViewSettings& look) {
    begin_row("Target error", "Relative RMS error of the image, in per cent.");
    const double smallest = 0x1p-20;
    const double largest = 1000;
    double target = look.target_error_percent;
    const bool changed = ImGui::InputDouble("##target", &target, 0, 0, "%.3g %%");
    if (changed) look.target_error_percent = std::clamp(target, smallest, largest);
    const ErrorEstimate::Prediction prediction = error.seconds_to(look.target_error_percent);
    begin_row("Time to target");
    if (!prediction.valid) {
        ImGui::TextDisabled("not known yet");
    } else if (prediction.seconds <= 0) {
        ImGui::TextUnformatted("reached");
    } else {
        ImGui::Text("%s", duration_text(prediction.seconds).c_str());
        text_row("", "%s to %s", duration_text(prediction.lo95).c_str(),
                 duration_text(prediction.hi95).c_str());
    }
    return changed;
}

}  // namespace

bool draw_accuracy_panel(const Snapshot* snapshot, ViewSettings& look) {
    static const ErrorEstimate kNone;
    const ErrorEstimate& error = snapshot ? snapshot->error : kNone;
    begin_row("Relative error", "Root of the mean squared error relative to brightness (relRMSE).");
    if (error.valid) {
        ImGui::Text("%s", percent_text(error.relrmse_percent).c_str());
        text_row("95 % interval", "%s to %s", percent_text(error.lo95).c_str(),
                 percent_text(error.hi95).c_str());
    } else {
        ImGui::TextDisabled("from 2 samples on");
    }
    draw_trust(error);
    const float height = 11 * ImGui::GetFontSize();
    draw_error_plot(error, snapshot ? snapshot->render_seconds : 0, look.target_error_percent,
                    ImVec2(ImGui::GetContentRegionAvail().x, height));
    return draw_target(error, look);
}

}  // namespace talbot
