// The estimated error: how large, how sure, how it fell, and when it will reach a target.
#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

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
    // Two lines, whatever is said, so that nothing below moves.
    const float below = ImGui::GetCursorPosY() + 2 * ImGui::GetTextLineHeightWithSpacing();
    ImGui::PushStyleColor(ImGuiCol_Text, ImGui::GetStyleColorVec4(ImGuiCol_TextDisabled));
    ImGui::TextWrapped("%s", error.why.c_str());
    ImGui::PopStyleColor();
    ImGui::SetCursorPosY(std::max(below, ImGui::GetCursorPosY()));
}

// In whole per cent, rounded down, and 100 only where nothing is left.
int percent_of_the_way(double spent, double left) {
    if (!(left > 0)) return 100;
    return std::min(99, static_cast<int>(std::floor(100 * spent / (spent + left))));
}

// Always the same rows, so that nothing below moves.
void draw_prediction(const ErrorEstimate& error, double seconds_now, double target) {
    begin_row("Time to target");
    const ErrorEstimate::Prediction prediction = error.seconds_to(target);
    const bool reached = error.meets(target);
    std::string range = "-";
    int percent = reached ? 100 : 0;
    if (error.trust == Trust::red) {
        ImGui::TextDisabled("not trusted");
    } else if (!prediction.valid) {
        ImGui::TextDisabled("not known yet");
    } else if (reached) {
        ImGui::TextUnformatted("reached");
    } else {
        range = duration_text(prediction.lo95) + " to " + duration_text(prediction.hi95);
        // A single number only where it is promised.
        if (prediction.firm) {
            ImGui::TextUnformatted(duration_text(prediction.seconds).c_str());
        } else {
            ImGui::TextDisabled("only a range");
        }
        // By the further end of the band, so that it does not promise too much.
        percent = percent_of_the_way(seconds_now, std::max(prediction.hi95, 0x1p-30));
    }
    text_row("", "%s", range.c_str());
    begin_row("Progress");
    const std::string text = std::to_string(percent) + " %";
    ImGui::ProgressBar(static_cast<float>(percent) / 100, ImVec2(-1, 0), text.c_str());
}

// The error that a typed time buys.
void draw_budget(const ErrorEstimate& error, ViewSettings& look) {
    begin_row("Further seconds", "Of rendering; below, the error that they buy.");
    double seconds = look.budget_seconds;
    if (ImGui::InputDouble("##budget", &seconds, 0, 0, "%.6g s"))
        look.budget_seconds = std::clamp(seconds, 0.0, 1e9);
    begin_row("buy an error of");
    const ErrorEstimate::FutureError future = error.error_after(look.budget_seconds);
    std::string range = "-";
    if (error.trust == Trust::red) {
        ImGui::TextDisabled("not trusted");
    } else if (!future.valid) {
        ImGui::TextDisabled("not known yet");
    } else {
        ImGui::Text("%s", percent_text(future.relrmse_percent).c_str());
        range = percent_text(future.lo95) + " to " + percent_text(future.hi95);
    }
    text_row("", "%s", range.c_str());
}

void draw_target(const ErrorEstimate& error, double seconds_now, ViewerModel& model) {
    begin_row("Target error", "Relative RMS error of the image, in per cent; or drag the line.");
    const Parameter<ViewerModel>* target =
        find_parameter(session_parameters(), "target_error_percent");
    double percent = model.look.target_error_percent;
    if (ImGui::InputDouble("##target", &percent, 0, 0, "%.3g %%"))
        model.look.target_error_percent =
            std::clamp(percent, target->info.lower, target->info.upper);
    draw_prediction(error, seconds_now, model.look.target_error_percent);
    edit_named(session_parameters(), "stop_at_target", model);
    draw_budget(error, model.look);
}

void draw_bias(const ViewerModel& model, const Diagnosis& diagnosis, bool& measure) {
    const std::vector<BiasedSwitch> switches = biased_switches(model.settings);
    if (switches.empty()) {
        text_row("Biased switches", "none is on");
        return;
    }
    for (const BiasedSwitch& biased : switches)
        text_row("Biased switch", "%s", biased.name.c_str());
    if (diagnosis.bias) {
        for (const BiasEntry& entry : *diagnosis.bias) {
            if (!entry.floor.significant) {
                text_row(entry.name, "below %s", percent_text(entry.floor.hi95).c_str());
                continue;
            }
            text_row(entry.name, "removes %s", percent_text(entry.floor.relrmse_percent).c_str());
            if (entry.loss_after_seconds) {
                text_row("", "a loss after %s", duration_text(*entry.loss_after_seconds).c_str());
            }
        }
    }
    measure = ImGui::Button(diagnosis.measuring_bias ? "Measuring ..." : "Measure what it removes",
                            ImVec2(-1, 0)) &&
              !diagnosis.measuring_bias;
}

// A bar for each part of the error.
void draw_shares(const std::vector<ErrorShare>& shares) {
    for (const ErrorShare& share : shares) {
        constexpr double kSmallest = 0.005;
        if (share.error < kSmallest) continue;
        begin_row(share.label.empty() ? share.name : share.label);
        char text[48];
        std::snprintf(text, sizeof text, "%.0f \xC2\xB1 %.1f %%", 100 * share.error,
                      100 * share.error_sd);
        ImGui::PushStyleColor(ImGuiCol_PlotHistogram,
                              ImGui::GetColorU32(ImGuiCol_PlotHistogram, 0.5f));
        ImGui::ProgressBar(static_cast<float>(share.error), ImVec2(-1, 0), text);
        ImGui::PopStyleColor();
        if (ImGui::IsItemHovered() && !share.help.empty()) {
            ImGui::SetTooltip("%s would need %.1f times less work", share.help.c_str(),
                              share.help_factor);
        }
    }
}

void draw_diagnosis(const Diagnosis& diagnosis, bool& measure) {
    if (!ImGui::TreeNodeEx("Where the error comes from", ImGuiTreeNodeFlags_SpanAvailWidth)) return;
    ImGui::Unindent();
    if (diagnosis.shares && diagnosis.shares->valid) {
        draw_shares(diagnosis.shares->kinds);
        if (!diagnosis.shares->lights.empty()) ImGui::TextDisabled("By light:");
        draw_shares(diagnosis.shares->lights);
        if (!diagnosis.shares->help.empty()) {
            ImGui::TextWrapped("%s would need %.1f times less work for the same error.",
                               diagnosis.shares->help.c_str(), diagnosis.shares->help_factor);
        }
    } else if (diagnosis.shares) {
        ImGui::TextDisabled("Nothing in this view is noisy.");
    }
    measure =
        ImGui::Button(diagnosis.measuring_shares ? "Measuring ..." : "Measure", ImVec2(-1, 0)) &&
        !diagnosis.measuring_shares;
    ImGui::Indent();
    ImGui::TreePop();
}

}  // namespace

void draw_accuracy_panel(const Snapshot* snapshot, ViewerModel& model, Edits& edits,
                         const Diagnosis& diagnosis, DiagnosisRequest& request) {
    static const ErrorEstimate kNone;
    const ErrorEstimate& error = snapshot ? snapshot->error : kNone;
    const double seconds_now = snapshot ? snapshot->render_seconds : 0;
    begin_row("Relative error", "Root of the mean squared error relative to brightness (relRMSE).");
    if (error.valid) {
        ImGui::Text("%s", percent_text(error.relrmse_percent).c_str());
        text_row("95 % interval", "%s to %s", percent_text(error.lo95).c_str(),
                 percent_text(error.hi95).c_str());
    } else {
        ImGui::TextDisabled("from 2 samples on");
        text_row("95 % interval", "-");
    }
    draw_trust(error);
    const float height = 11 * ImGui::GetFontSize();
    draw_error_plot(error, seconds_now, model.look.target_error_percent,
                    ImVec2(ImGui::GetContentRegionAvail().x, height));
    if (error.valid && error.octaves.size() > 1) {
        ImGui::TextWrapped("This view converges as t^%.2f.", -0.5 * error.seconds_exponent);
    } else {
        ImGui::PushStyleColor(ImGuiCol_Text, ImGui::GetStyleColorVec4(ImGuiCol_TextDisabled));
        ImGui::TextWrapped("%s", "How fast this view converges is not known yet.");
        ImGui::PopStyleColor();
    }
    draw_target(error, seconds_now, model);
    bool shows_blocks = model.look.aov == Aov::block_error;
    begin_row("Where the error is",
              "The estimated error of every 8 x 8 pixels, in place of the image.");
    if (ImGui::Checkbox("##blocks", &shows_blocks)) {
        model.look.aov = shows_blocks ? Aov::block_error : Aov::beauty;
        edits.aov = true;
    }
    draw_diagnosis(diagnosis, request.shares);
    draw_bias(model, diagnosis, request.bias);
}

}  // namespace talbot
