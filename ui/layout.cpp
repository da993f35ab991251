#include "ui/layout.h"

#include <imgui.h>

#include <algorithm>
#include <cmath>

#include "ui/style.h"

namespace talbot {
namespace {

constexpr ImGuiWindowFlags kFixedWindow = ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize |
                                          ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoCollapse |
                                          ImGuiWindowFlags_NoSavedSettings |
                                          ImGuiWindowFlags_NoBringToFrontOnFocus;

// Panels never take more than this share of the window each.
constexpr float kLargestPanelShare = 0.3f;

int panel_width(PixelSize framebuffer, float scale) {
    const float wanted = kSidePanelWidth * scale;
    return static_cast<int>(
        std::min(wanted, kLargestPanelShare * static_cast<float>(framebuffer.width)));
}

int status_height(float scale) {
    return static_cast<int>(std::lround(kStatusBarHeight * scale));
}

void begin_window(const char* name, const PixelRect& rect, ImGuiWindowFlags flags) {
    ImGui::SetNextWindowPos(ImVec2(static_cast<float>(rect.x), static_cast<float>(rect.y)));
    ImGui::SetNextWindowSize(
        ImVec2(static_cast<float>(rect.width), static_cast<float>(rect.height)));
    ImGui::Begin(name, nullptr, flags);
}

// A heading that folds; the panel's body follows when it is open.
bool section(const char* title, bool open = true) {
    ImGui::Spacing();
    return ImGui::CollapsingHeader(title,
                                   open ? ImGuiTreeNodeFlags_DefaultOpen : ImGuiTreeNodeFlags_None);
}

}  // namespace

PixelRect image_area(PixelSize framebuffer, float scale, bool show_panels) {
    if (!show_panels) return {0, 0, framebuffer.width, framebuffer.height};
    const int side = panel_width(framebuffer, scale);
    return {side, 0, std::max(1, framebuffer.width - 2 * side),
            std::max(1, framebuffer.height - status_height(scale))};
}

void draw_panels(PixelSize framebuffer, float scale, ViewerModel& model, Edits& edits,
                 const PanelView& view, FileForm& form, PanelRequests& requests) {
    const Snapshot* snapshot = view.snapshot;
    const int side = panel_width(framebuffer, scale);
    const int bar = status_height(scale);
    const int height = framebuffer.height - bar;

    begin_window("scene", {0, 0, side, height}, kFixedWindow);
    if (section("File")) draw_file_panel(model, form, requests.file);
    if (has_choices(model) && section("Scene")) draw_scene_panel(model);
    if (section("Session")) draw_session_panel(model, edits, snapshot);
    if (section("Camera")) edits.camera |= draw_camera_panel(model);
    if (section("Environment and lights")) draw_lights_panel(model, edits);
    if (section("Render")) edits.settings |= draw_render_panel(model, view.threads);
    if (section("Effects", false)) edits.settings |= draw_effects_panel(model, snapshot);
    ImGui::End();

    begin_window("image settings", {framebuffer.width - side, 0, side, height}, kFixedWindow);
    if (section("Accuracy"))
        draw_accuracy_panel(snapshot, model, edits, view.diagnosis, requests.diagnosis);
    if (section("Compare A and B", false))
        draw_ab_panel(model, view.ab, view.comparing, requests.ab);
    if (section("Display")) draw_display_panel(model, edits, snapshot, view.reading);
    if (section("Samples", false))
        draw_samples_panel(snapshot, view.path, requests.retrace, requests.hide_path);
    if (section("Material") && draw_material_panel(model)) edits.materials.insert(model.material);
    ImGui::End();

    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2(12 * scale, 6 * scale));
    ImGui::PushStyleColor(ImGuiCol_WindowBg, ImVec4(0.095f, 0.095f, 0.1f, 1));
    begin_window("status", {0, height, framebuffer.width, bar},
                 kFixedWindow | ImGuiWindowFlags_NoScrollbar);
    draw_status_bar(model, snapshot, view.status);
    ImGui::End();
    ImGui::PopStyleColor();
    ImGui::PopStyleVar();
}

void draw_notice(const PixelRect& area, const std::string& text, bool is_error) {
    const float em = ImGui::GetFontSize();
    ImGui::SetNextWindowPos(
        ImVec2(static_cast<float>(area.x) + 0.5f * static_cast<float>(area.width),
               static_cast<float>(area.y + area.height) - 1.5f * em),
        ImGuiCond_Always, ImVec2(0.5f, 1));
    ImGui::SetNextWindowBgAlpha(0.92f);
    ImGui::PushStyleVar(ImGuiStyleVar_WindowRounding, 0.4f * em);
    ImGui::PushStyleColor(ImGuiCol_WindowBg, is_error ? ImVec4(0.36f, 0.11f, 0.10f, 1)
                                                      : ImVec4(0.16f, 0.16f, 0.17f, 1));
    ImGui::Begin("notice", nullptr,
                 ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_AlwaysAutoResize |
                     ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
                     ImGuiWindowFlags_NoInputs | ImGuiWindowFlags_NoNav);
    ImGui::PushTextWrapPos(0.8f * static_cast<float>(area.width));
    ImGui::TextUnformatted(text.c_str());
    ImGui::PopTextWrapPos();
    ImGui::End();
    ImGui::PopStyleColor();
    ImGui::PopStyleVar();
}

}  // namespace talbot
