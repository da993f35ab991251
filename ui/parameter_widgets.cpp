#include "ui/parameter_widgets.h"

#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstdio>

#include "core/film/tone_map.h"

namespace talbot {
namespace {

// Share of a panel's width that labels take, and that a long one may take.
constexpr float kLabelShare = 0.4f;
constexpr float kLongLabelShare = 0.64f;

void show_tooltip(std::string_view text) {
    if (text.empty() || !ImGui::IsItemHovered()) return;
    ImGui::BeginTooltip();
    ImGui::PushTextWrapPos(ImGui::GetFontSize() * 22);
    ImGui::TextUnformatted(text.data(), text.data() + text.size());
    ImGui::PopTextWrapPos();
    ImGui::EndTooltip();
}

void append_unit(std::string& format, std::string_view unit) {
    if (unit.empty()) return;
    format += ' ';
    format += unit;
}

// Digits that suit the value's size, with the unit.
std::string number_format(const ParameterInfo& info, double value) {
    const double magnitude = std::abs(value);
    const char* digits = "%.3f";
    if (!std::isfinite(value))
        digits = "%f";
    else if (magnitude >= 10000)
        digits = "%.0f";
    else if (magnitude >= 100)
        digits = "%.1f";
    else if (magnitude >= 10)
        digits = "%.2f";
    else if (magnitude > 0 && magnitude < 0.01)
        digits = "%.5f";
    std::string format = digits;
    append_unit(format, info.unit);
    return format;
}

bool edit_number(const ParameterInfo& info, const char* id, double& value) {
    ImGuiSliderFlags flags = ImGuiSliderFlags_None;
    if (info.logarithmic) flags |= ImGuiSliderFlags_Logarithmic;
    const std::string format = number_format(info, value);
    // Infinity stands at the slider's right end.
    double shown = std::isfinite(value) ? value : info.slider_upper;
    const std::string text = std::isfinite(value) ? format : "infinite";
    if (!ImGui::SliderScalar(id, ImGuiDataType_Double, &shown, &info.slider_lower,
                             &info.slider_upper, text.c_str(), flags)) {
        return false;
    }
    if (shown >= info.slider_upper && std::isinf(info.upper)) shown = info.upper;
    value = std::clamp(shown, info.lower, info.upper);
    return true;
}

bool edit_integer(const ParameterInfo& info, const char* id, double& value) {
    int64_t shown = static_cast<int64_t>(value);
    const int64_t lower = static_cast<int64_t>(info.slider_lower);
    const int64_t upper = static_cast<int64_t>(info.slider_upper);
    ImGuiSliderFlags flags = ImGuiSliderFlags_None;
    if (info.logarithmic) flags |= ImGuiSliderFlags_Logarithmic;
    std::string format = "%lld";
    append_unit(format, info.unit);
    if (!ImGui::SliderScalar(id, ImGuiDataType_S64, &shown, &lower, &upper, format.c_str(), flags))
        return false;
    value = std::clamp(static_cast<double>(shown), info.lower, info.upper);
    return true;
}

// Numbers, and a swatch that opens a picker. Colours are linear; the swatch shows them as they are.
bool edit_color(const ParameterInfo& info, const char* id, ParameterValue& value) {
    const int count = component_count(info.kind);
    float shown[4] = {0, 0, 0, 1};
    bool bright = false;
    for (int i = 0; i < count; ++i) {
        shown[i] = static_cast<float>(value[static_cast<std::size_t>(i)]);
        bright |= i < 3 && shown[i] > 1;
    }
    const float spacing = ImGui::GetStyle().ItemInnerSpacing.x;
    const float swatch = ImGui::GetFrameHeight();
    const float lower = static_cast<float>(info.lower);
    const float upper = static_cast<float>(info.upper);
    constexpr float kSpeed = 1.0f / 256;
    ImGui::SetNextItemWidth(ImGui::GetContentRegionAvail().x - swatch - spacing);
    bool edited = ImGui::DragScalarN(id, ImGuiDataType_Float, shown, count, kSpeed, &lower, &upper,
                                     "%.2f", ImGuiSliderFlags_AlwaysClamp);
    ImGui::SameLine(0, spacing);
    ImGuiColorEditFlags flags =
        ImGuiColorEditFlags_Float | ImGuiColorEditFlags_NoInputs | ImGuiColorEditFlags_NoOptions;
    if (info.upper > 1 && bright) flags |= ImGuiColorEditFlags_HDR;
    ImGui::PushID(id);
    edited |= count == 4 ? ImGui::ColorEdit4("##picker", shown,
                                             flags | ImGuiColorEditFlags_AlphaPreviewHalf)
                         : ImGui::ColorEdit3("##picker", shown, flags);
    ImGui::PopID();
    if (!edited) return false;
    for (int i = 0; i < count; ++i) {
        value[static_cast<std::size_t>(i)] =
            std::clamp(static_cast<double>(shown[i]), info.lower, info.upper);
    }
    return true;
}

bool edit_vector(const ParameterInfo& info, const char* id, ParameterValue& value) {
    const int count = component_count(info.kind);
    double largest = 0;
    for (int i = 0; i < count; ++i)
        largest = std::max(largest, std::abs(value[static_cast<std::size_t>(i)]));
    const float speed = static_cast<float>(std::max(largest, 1.0) / 200);
    const float spacing = ImGui::GetStyle().ItemInnerSpacing.x;
    const float width = (ImGui::CalcItemWidth() - spacing * static_cast<float>(count - 1)) /
                        static_cast<float>(count);
    bool edited = false;
    ImGui::PushID(id);
    for (int i = 0; i < count; ++i) {
        double& v = value[static_cast<std::size_t>(i)];
        // Next to the others it is nothing, and its digits would not fit.
        constexpr double kNothing = 0x1p-20;
        const char* format = std::abs(v) < kNothing * largest ? "0" : "%.3g";
        if (i > 0) ImGui::SameLine(0, spacing);
        ImGui::SetNextItemWidth(width);
        ImGui::PushID(i);
        edited |= ImGui::DragScalar("##component", ImGuiDataType_Double, &v, speed, &info.lower,
                                    &info.upper, format, ImGuiSliderFlags_AlwaysClamp);
        ImGui::PopID();
    }
    ImGui::PopID();
    return edited;
}

}  // namespace

void begin_row(std::string_view label, std::string_view tooltip) {
    const float start = ImGui::GetCursorPosX();
    const float width = ImGui::GetContentRegionAvail().x;
    ImGui::AlignTextToFramePadding();
    ImGui::TextUnformatted(label.data(), label.data() + label.size());
    show_tooltip(tooltip);
    const float needed = ImGui::CalcTextSize(label.data(), label.data() + label.size()).x +
                         ImGui::GetStyle().ItemInnerSpacing.x;
    float column = std::floor(width * kLabelShare);
    if (needed > width * kLongLabelShare) {
        // The label has a line of its own.
        ImGui::Dummy(ImVec2(0, 0));
        ImGui::SameLine(start + column);
    } else {
        column = std::max(column, needed);
        ImGui::SameLine(start + column);
    }
    ImGui::SetNextItemWidth(-1);
}

void text_row(std::string_view label, const char* format, ...) {
    begin_row(label);
    va_list arguments;
    va_start(arguments, format);
    ImGui::TextV(format, arguments);
    va_end(arguments);
}

bool edit_parameter(const ParameterInfo& info, ParameterValue& value) {
    begin_row(info.label, info.note);
    std::string id("##");
    id += info.name;
    switch (info.kind) {
        case ParameterKind::number:
            return edit_number(info, id.c_str(), value[0]);
        case ParameterKind::integer:
            return edit_integer(info, id.c_str(), value[0]);
        case ParameterKind::flag: {
            bool flag = value[0] != 0;
            if (!ImGui::Checkbox(id.c_str(), &flag)) return false;
            value[0] = flag ? 1 : 0;
            return true;
        }
        case ParameterKind::choice: {
            const std::size_t current =
                std::min(static_cast<std::size_t>(value[0]), info.choices.size() - 1);
            bool edited = false;
            if (ImGui::BeginCombo(id.c_str(), info.choices[current].data())) {
                for (std::size_t i = 0; i < info.choices.size(); ++i) {
                    if (ImGui::Selectable(info.choices[i].data(), i == current) && i != current) {
                        value[0] = static_cast<double>(i);
                        edited = true;
                    }
                }
                ImGui::EndCombo();
            }
            return edited;
        }
        case ParameterKind::color:
        case ParameterKind::color_alpha:
            return edit_color(info, id.c_str(), value);
        case ParameterKind::vector2:
        case ParameterKind::vector3:
            return edit_vector(info, id.c_str(), value);
    }
    return false;
}

}  // namespace talbot
