// How the image is looked at.
#include <imgui.h>

#include <cstdio>

#include "ui/false_color.h"
#include "ui/panels.h"
#include "ui/parameter_widgets.h"

namespace talbot {
namespace {

ImU32 packed(const Rgb& color) {
    return ImGui::GetColorU32(ImVec4(color.x, color.y, color.z, 1));
}

std::string value_text(float value, std::string_view unit) {
    char text[64];
    std::snprintf(text, sizeof text, "%.4g %.*s", static_cast<double>(value),
                  static_cast<int>(unit.size()), unit.data());
    return text;
}

// The colours of a scalar, from its smallest to its largest value.
void draw_scale(const AovImage& image) {
    const AovInfo& info = aov_info(image.aov);
    const ImVec2 corner = ImGui::GetCursorScreenPos();
    const float width = ImGui::GetContentRegionAvail().x;
    const float height = 0.7f * ImGui::GetFontSize();
    ImDrawList& list = *ImGui::GetWindowDrawList();
    constexpr int kSteps = 32;
    for (int i = 0; i < kSteps; ++i) {
        const float left = corner.x + width * static_cast<float>(i) / kSteps;
        const float right = corner.x + width * static_cast<float>(i + 1) / kSteps;
        const ImU32 a = packed(scale_color(static_cast<float>(i) / kSteps));
        const ImU32 b = packed(scale_color(static_cast<float>(i + 1) / kSteps));
        list.AddRectFilledMultiColor(ImVec2(left, corner.y), ImVec2(right, corner.y + height), a, b,
                                     b, a);
    }
    ImGui::Dummy(ImVec2(width, height));
    const float start = ImGui::GetCursorPosX();
    ImGui::TextUnformatted(value_text(image.lower.x, info.unit).c_str());
    const std::string most = value_text(image.upper.x, info.unit);
    ImGui::SameLine(start + width - ImGui::CalcTextSize(most.c_str()).x);
    ImGui::TextUnformatted(most.c_str());
}

void triple_row(std::string_view label, const Rgb& v) {
    text_row(label, "%.3g  %.3g  %.3g", static_cast<double>(v.x), static_cast<double>(v.y),
             static_cast<double>(v.z));
}

void draw_reading(const std::optional<PixelReading>& reading, const Snapshot* snapshot) {
    ImGui::Separator();
    if (!reading || !snapshot) {
        text_row("Pixel", "point at the image");
        for (const char* label : {"Mean", "Standard error"}) text_row(label, "-");
        return;
    }
    text_row("Pixel", "%u, %u", reading->x, reading->y);
    triple_row("Mean", reading->mean);
    if (reading->standard_error) {
        triple_row("Standard error", *reading->standard_error);
    } else {
        text_row("Standard error", "-");
    }
    if (!reading->value || !snapshot->aov) return;
    const AovInfo& info = aov_info(snapshot->aov->aov);
    if (info.channels == 3) {
        triple_row(info.label, *reading->value);
    } else {
        text_row(info.label, "%s", value_text(reading->value->x, info.unit).c_str());
    }
}

}  // namespace

void draw_display_panel(ViewerModel& model, Edits& edits, const Snapshot* snapshot,
                        const std::optional<PixelReading>& reading) {
    edits.aov |= edit_named(display_parameters(), "aov", model);
    const AovInfo& info = aov_info(model.look.aov);
    const AovImage* image = snapshot ? snapshot->aov.get() : nullptr;
    if (image && image->aov == model.look.aov && info.look == AovLook::scalar) draw_scale(*image);
    if (model.look.aov != Aov::beauty) {
        ImGui::PushStyleColor(ImGuiCol_Text, ImGui::GetStyleColorVec4(ImGuiCol_TextDisabled));
        ImGui::TextWrapped("%s", std::string(info.note).c_str());
        ImGui::PopStyleColor();
    }
    if (info.look == AovLook::radiance) {
        for (const char* name : {"exposure_ev", "tone_map", "channel", "false_color"})
            edit_named(display_parameters(), name, model);
    }
    edit_named(display_parameters(), "bvh_boxes", model);
    draw_reading(reading, snapshot);
}

}  // namespace talbot
