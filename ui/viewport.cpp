#include "ui/viewport.h"

#include <imgui.h>

#include <algorithm>
#include <cmath>

#include "ui/input.h"

namespace talbot {
namespace {

// A drag over the image's whole height turns by half a circle.
constexpr double kRadiansPerHeight = std::numbers::pi;
// One notch of the wheel, and a drag over the whole height as a power of this.
constexpr double kDollyPerNotch = 0.88;
constexpr double kDollyPerHeight = 0.05;
// Scene radii per second.
constexpr double kFlySpeed = 0.5;
constexpr double kFastFlySpeed = 2.5;
// A press that moves less than this (at content scale 1) is a click.
constexpr float kClickSlack = 4;

bool is_down(Key key) {
    return ImGui::IsKeyDown(static_cast<int>(key));
}

// W A S D Q E while no text is typed and no shortcut is meant.
bool fly(ViewerModel& model, double seconds) {
    const ImGuiIO& io = ImGui::GetIO();
    if (io.WantTextInput || io.KeyCtrl || io.KeyAlt) return false;
    const auto axis = [](char plus, char minus) {
        return static_cast<double>(is_down(key_of(plus))) -
               static_cast<double>(is_down(key_of(minus)));
    };
    const Vec3d direction(axis('d', 'a'), axis('e', 'q'), axis('w', 's'));
    if (direction == Vec3d(0)) return false;
    const double speed = (io.KeyShift ? kFastFlySpeed : kFlySpeed) * model.view.scene_radius();
    model.view.fly(direction * (speed * std::min(seconds, 0.1)));
    return true;
}

bool drag(ViewerModel& model, const PixelRect& image) {
    const ImGuiIO& io = ImGui::GetIO();
    const double height = std::max(image.height, 1);
    const double right = io.MouseDelta.x / height;
    const double up = -io.MouseDelta.y / height;
    if (right == 0 && up == 0) return false;
    if (ImGui::IsMouseDown(ImGuiMouseButton_Middle) ||
        (ImGui::IsMouseDown(ImGuiMouseButton_Left) && io.KeyShift)) {
        model.view.pan(right, up, model.aspect());
    } else if (ImGui::IsMouseDown(ImGuiMouseButton_Right)) {
        const double angle =
            2 * std::atan(view_half_extents(model.view.camera(), model.aspect()).y);
        model.view.look(right * angle, up * angle);
    } else if (ImGui::IsMouseDown(ImGuiMouseButton_Left) && io.KeyCtrl) {
        model.view.dolly(std::pow(kDollyPerHeight, up));
    } else if (ImGui::IsMouseDown(ImGuiMouseButton_Left)) {
        model.view.orbit(right * kRadiansPerHeight, up * kRadiansPerHeight);
    } else {
        return false;
    }
    return true;
}

}  // namespace

ViewportResult handle_viewport(ViewerModel& model, const PixelRect& area, const PixelRect& image,
                               double seconds) {
    ViewportResult result;
    if (area.width <= 0 || area.height <= 0) return result;
    ImGui::SetNextWindowPos(ImVec2(static_cast<float>(area.x), static_cast<float>(area.y)));
    ImGui::SetNextWindowSize(
        ImVec2(static_cast<float>(area.width), static_cast<float>(area.height)));
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2(0, 0));
    ImGui::Begin("viewport", nullptr,
                 ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoBackground |
                     ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
                     ImGuiWindowFlags_NoBringToFrontOnFocus | ImGuiWindowFlags_NoNav);
    ImGui::InvisibleButton("image",
                           ImVec2(static_cast<float>(area.width), static_cast<float>(area.height)),
                           ImGuiButtonFlags_MouseButtonLeft | ImGuiButtonFlags_MouseButtonRight |
                               ImGuiButtonFlags_MouseButtonMiddle);
    const ImGuiIO& io = ImGui::GetIO();
    const bool hovered = ImGui::IsItemHovered();
    const float slack = kClickSlack * ImGui::GetFontSize() / 14;
    // A press becomes a drag once it has left the slack; the part within it is not lost, but moves
    // nothing either.
    const bool dragged = io.MouseDragMaxDistanceSqr[0] > slack * slack ||
                         ImGui::IsMouseDown(ImGuiMouseButton_Right) ||
                         ImGui::IsMouseDown(ImGuiMouseButton_Middle);
    // What the pointer moved before the press, in the press's own frame, is no part of the drag.
    if (ImGui::IsItemActive() && !ImGui::IsItemActivated() && dragged)
        result.camera_changed |= drag(model, image);
    if (hovered && io.MouseWheel != 0) {
        model.view.dolly(std::pow(kDollyPerNotch, static_cast<double>(io.MouseWheel)));
        result.camera_changed = true;
    }
    const Vec2f pointer(io.MousePos.x, io.MousePos.y);
    if (hovered && image.contains(pointer.x, pointer.y)) {
        const bool released = ImGui::IsMouseReleased(ImGuiMouseButton_Left);
        if (released && ImGui::IsItemDeactivated() &&
            io.MouseDragMaxDistanceSqr[0] <= slack * slack && !io.KeyCtrl && !io.KeyShift) {
            result.click = pointer;
        }
        if (ImGui::IsMouseDoubleClicked(ImGuiMouseButton_Left)) result.double_click = pointer;
    }
    ImGui::End();
    ImGui::PopStyleVar();
    result.camera_changed |= fly(model, seconds);
    if (result.camera_changed) model.camera = -1;
    return result;
}

}  // namespace talbot
