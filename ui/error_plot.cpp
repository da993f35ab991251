#include "ui/error_plot.h"

#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace talbot {
namespace {

// A range of powers of ten on the screen.
struct LogAxis {
    double lower = 0;  // exponents
    double upper = 1;
    float from_px = 0;
    float to_px = 1;

    double value_at(float px) const {
        const double t = static_cast<double>((px - from_px) / (to_px - from_px));
        return std::pow(10.0, lower + t * (upper - lower));
    }
    float at(double value) const {
        const double t = (std::log10(value) - lower) / (upper - lower);
        return from_px + static_cast<float>(t) * (to_px - from_px);
    }
};

// The whole decades round the values, at least one of them.
void cover(LogAxis& axis, double smallest, double largest) {
    axis.lower = std::floor(std::log10(smallest));
    axis.upper = std::ceil(std::log10(largest));
    if (axis.upper - axis.lower < 1) axis.upper = axis.lower + 1;
}

void draw_decades(ImDrawList& list, const LogAxis& x, const LogAxis& y) {
    const ImU32 line = ImGui::GetColorU32(ImVec4(1, 1, 1, 0.09f));
    const ImU32 text = ImGui::GetColorU32(ImGuiCol_TextDisabled);
    const float size = ImGui::GetFontSize() * 0.86f;
    char label[32];
    const auto write = [&](const LogAxis& axis, int decade, const char* unit) {
        const int step = axis.upper - axis.lower > 6 ? 2 : 1;
        if ((decade - static_cast<int>(axis.lower)) % step != 0) return false;
        if (decade >= 4) {
            std::snprintf(label, sizeof label, "1e%d%s", decade, unit);
        } else {
            std::snprintf(label, sizeof label, "%g%s", std::pow(10.0, decade), unit);
        }
        return true;
    };
    float free_from = x.from_px - 9;  // where the label before ends
    for (int decade = static_cast<int>(x.lower); decade <= static_cast<int>(x.upper); ++decade) {
        const float px = x.at(std::pow(10.0, decade));
        list.AddLine(ImVec2(px, y.from_px), ImVec2(px, y.to_px), line);
        if (!write(x, decade, " s")) continue;
        const float width = ImGui::CalcTextSize(label).x * 0.86f;
        const float left =
            std::clamp(px - 0.5f * width, x.from_px - 8, std::max(x.from_px - 8, x.to_px - width));
        if (left < free_from) continue;
        free_from = left + width + 0.5f * size;
        list.AddText(ImGui::GetFont(), size, ImVec2(left, y.from_px + 3), text, label);
    }
    for (int decade = static_cast<int>(y.lower); decade <= static_cast<int>(y.upper); ++decade) {
        const float py = y.at(std::pow(10.0, decade));
        list.AddLine(ImVec2(x.from_px, py), ImVec2(x.to_px, py), line);
        if (!write(y, decade, " %")) continue;
        const float width = ImGui::CalcTextSize(label).x * 0.86f;
        list.AddText(ImGui::GetFont(), size, ImVec2(x.from_px - width - 5, py - 0.5f * size), text,
                     label);
    }
}

// Where the error is expected from now on: a band that opens, and the middle of it, dashed. The
// past is the fitted line.
void draw_cone(ImDrawList& list, const LogAxis& x, const LogAxis& y, const ErrorEstimate& error,
               double seconds_now) {
    if (!(error.relrmse_percent > 0) || !(error.seconds > 0)) return;
    const double slope = -0.5 * error.seconds_exponent;
    const ImU32 color = ImGui::GetColorU32(ImGuiCol_PlotLines, 0.75f);
    const ImU32 band = ImGui::GetColorU32(ImGuiCol_PlotLines, 0.16f);
    const double now = std::log10(std::max(seconds_now, error.seconds));
    constexpr int kSegments = 40;
    const auto past = [&](double exponent) {
        const double seconds = std::pow(10.0, exponent);
        return ImVec2(x.at(seconds),
                      y.at(error.relrmse_percent * std::pow(seconds / error.seconds, slope)));
    };
    list.AddLine(past(x.lower), past(now), color, 1.5f);
    ErrorEstimate::FutureError last;
    double last_seconds = 0;
    for (int i = 0; i <= kSegments; ++i) {
        const double seconds = std::pow(10.0, now + (x.upper - now) * i / kSegments);
        const ErrorEstimate::FutureError next =
            error.error_after(std::max(0.0, seconds - error.seconds));
        if (!next.valid) return;
        if (i > 0 && last.lo95 > 0 && next.lo95 > 0) {
            const float left = x.at(last_seconds);
            const float right = x.at(seconds);
            list.AddQuadFilled(ImVec2(left, y.at(last.hi95)), ImVec2(right, y.at(next.hi95)),
                               ImVec2(right, y.at(next.lo95)), ImVec2(left, y.at(last.lo95)), band);
            if (i % 2 == 1) {
                list.AddLine(ImVec2(left, y.at(last.relrmse_percent)),
                             ImVec2(right, y.at(next.relrmse_percent)), color, 1.5f);
            }
        }
        last = next;
        last_seconds = seconds;
    }
}

void draw_points(ImDrawList& list, const LogAxis& x, const LogAxis& y,
                 const std::vector<ErrorPoint>& points) {
    const ImU32 color = ImGui::GetColorU32(ImGuiCol_Text);
    const float radius = ImGui::GetFontSize() * 0.19f;
    for (const ErrorPoint& point : points) {
        const float px = x.at(point.seconds);
        if (point.lower > 0) {
            list.AddLine(ImVec2(px, y.at(point.lower)), ImVec2(px, y.at(point.upper)), color, 1);
        }
        list.AddCircleFilled(ImVec2(px, y.at(point.percent)), radius, color);
    }
}

// The line of the target, with a handle at its right end.
void draw_target(ImDrawList& list, const LogAxis& x, float py, bool lit) {
    const float em = ImGui::GetFontSize();
    const ImU32 color = ImGui::GetColorU32(ImVec4(0.36f, 0.78f, 0.42f, lit ? 1.0f : 0.8f));
    list.AddLine(ImVec2(x.from_px, py), ImVec2(x.to_px, py), color, lit ? 2.5f : 1.5f);
    list.AddTriangleFilled(ImVec2(x.to_px - 0.55f * em, py), ImVec2(x.to_px, py - 0.35f * em),
                           ImVec2(x.to_px, py + 0.35f * em), color);
    if (lit) ImGui::SetMouseCursor(ImGuiMouseCursor_ResizeNS);
}

double round_to_two_digits(double value) {
    const double unit = std::pow(10.0, std::floor(std::log10(value)) - 1);
    return std::round(value / unit) * unit;
}

// The target can be dragged so far below everything.
constexpr double kRoomBelowTarget = 3;

// While the target is dragged, the axis stays as it was.
void hold(LogAxis& axis, bool held) {
    ImGuiStorage& storage = *ImGui::GetStateStorage();
    float* lower = storage.GetFloatRef(ImGui::GetID("lower"), static_cast<float>(axis.lower));
    float* upper = storage.GetFloatRef(ImGui::GetID("upper"), static_cast<float>(axis.upper));
    if (held) {
        axis.lower = static_cast<double>(*lower);
        axis.upper = static_cast<double>(*upper);
    } else {
        *lower = static_cast<float>(axis.lower);
        *upper = static_cast<float>(axis.upper);
    }
}

// Moves the target to the pointer; true when it was elsewhere.
bool drag_target(const LogAxis& y, double& target_percent) {
    const float py = std::clamp(ImGui::GetIO().MousePos.y, y.to_px, y.from_px);
    const double wanted = round_to_two_digits(y.value_at(py));
    const bool moved = wanted != target_percent;
    target_percent = wanted;
    return moved;
}

}  // namespace

std::vector<ErrorPoint> error_points(const ErrorEstimate& error) {
    std::vector<ErrorPoint> points;
    const double growth = std::exp2(error.exponent) - 1;
    if (!(growth > 0)) return points;
    const auto percent = [&](double difference) {
        return 100 * std::sqrt(std::max(difference, 0.0) / growth);
    };
    for (const Octave& octave : error.octaves) {
        if (!(octave.difference > 0) || !(octave.seconds > 0)) continue;
        points.push_back({octave.seconds, percent(octave.difference),
                          percent(octave.difference - 1.96 * octave.standard_error),
                          percent(octave.difference + 1.96 * octave.standard_error)});
    }
    return points;
}

bool draw_error_plot(const ErrorEstimate& error, double seconds_now, double& target_percent,
                     const ImVec2& size) {
    const ImVec2 corner = ImGui::GetCursorScreenPos();
    ImGui::InvisibleButton("plot", size);
    const bool dragged = ImGui::IsItemActive();
    const bool hovered = ImGui::IsItemHovered();
    ImDrawList& list = *ImGui::GetWindowDrawList();
    const float em = ImGui::GetFontSize();
    const ImVec2 end(corner.x + size.x, corner.y + size.y);
    list.AddRectFilled(corner, end, ImGui::GetColorU32(ImVec4(0, 0, 0, 0.18f)), 3);

    const std::vector<ErrorPoint> points = error_points(error);
    double first = seconds_now > 0 ? seconds_now : 1;
    double last = first;
    double smallest = target_percent;
    double largest = target_percent;
    for (const ErrorPoint& point : points) {
        first = std::min(first, point.seconds);
        last = std::max(last, point.seconds);
        smallest = std::min(smallest, point.percent);
        largest = std::max(largest, point.percent);
    }
    const ErrorEstimate::Prediction prediction = error.seconds_to(target_percent);
    if (prediction.valid)
        last = std::min(std::max(last, error.seconds + prediction.seconds), last * 10000);

    LogAxis x;
    x.from_px = corner.x + 3.4f * em;
    x.to_px = end.x - 0.7f * em;
    cover(x, first, last);
    LogAxis y;
    y.from_px = end.y - 1.4f * em;
    y.to_px = corner.y + 0.6f * em;
    cover(y, smallest / kRoomBelowTarget, largest);
    hold(y, dragged);
    const bool moved = dragged && drag_target(y, target_percent);

    draw_decades(list, x, y);
    list.PushClipRect(ImVec2(x.from_px, y.to_px), ImVec2(x.to_px, y.from_px), true);
    if (error.valid) draw_cone(list, x, y, error, seconds_now);
    draw_points(list, x, y, points);
    draw_target(list, x, y.at(target_percent), hovered || dragged);
    list.PopClipRect();
    return moved;
}

}  // namespace talbot
