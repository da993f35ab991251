#include "ui/ab_view.h"

#include <imgui.h>

#include <algorithm>
#include <cmath>

namespace talbot {

void AbView::start(const ViewerModel& model, const Snapshot& shown, unsigned threads) {
    AbConfig a;
    a.settings = model.settings;
    AbConfig b;
    b.settings = model.rival;
    AbPolicy policy;
    policy.threads = threads;
    policy.exposure_ev = model.display.exposure_ev;
    comparison_.start(shown.scene, shown.camera, a, b, policy);
    open_ = true;
}

void AbView::stop() {
    comparison_.stop();
}

void AbView::close() {
    if (!open_) return;
    comparison_.stop();
    open_ = false;
}

bool AbView::is_running() const {
    if (!open_) return false;
    const std::shared_ptr<const AbSnapshot> snapshot = comparison_.latest();
    return !snapshot || !snapshot->finished;
}

void AbView::draw_line(ViewerModel& model, const PixelRect& image) const {
    if (!latest()) return;
    const float em = ImGui::GetFontSize();
    const float width = static_cast<float>(image.width);
    const float x = static_cast<float>(image.x) + model.look.wipe * width;
    const float top = static_cast<float>(image.y);
    const float bottom = top + static_cast<float>(image.height);
    ImDrawList& list = *ImGui::GetBackgroundDrawList();
    list.AddLine(ImVec2(x, top), ImVec2(x, bottom), IM_COL32(0, 0, 0, 160), 0.3f * em);
    list.AddLine(ImVec2(x, top), ImVec2(x, bottom), IM_COL32(255, 255, 255, 255), 0.1f * em);
    for (const bool left : {true, false}) {
        const char* name = left ? "A" : "B";
        const float at = left ? x - 1.2f * em : x + 0.6f * em;
        list.AddText(ImVec2(at + 1, top + 0.5f * em + 1), IM_COL32(0, 0, 0, 255), name);
        list.AddText(ImVec2(at, top + 0.5f * em), IM_COL32(255, 255, 255, 255), name);
    }
    ImGui::SetNextWindowPos(ImVec2(x - 0.5f * em, top));
    ImGui::SetNextWindowSize(ImVec2(em, bottom - top));
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2(0, 0));
    ImGui::PushStyleVar(ImGuiStyleVar_WindowMinSize, ImVec2(1, 1));
    ImGui::Begin("wipe", nullptr,
                 ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoBackground |
                     ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
                     ImGuiWindowFlags_NoNav);
    ImGui::InvisibleButton("line", ImVec2(em, std::max(1.0f, bottom - top)));
    if (ImGui::IsItemActive() || ImGui::IsItemHovered())
        ImGui::SetMouseCursor(ImGuiMouseCursor_ResizeEW);
    if (ImGui::IsItemActive() && width > 0) {
        const float pointer = (ImGui::GetIO().MousePos.x - static_cast<float>(image.x)) / width;
        model.look.wipe = std::clamp(pointer, 0.0f, 1.0f);
    }
    ImGui::End();
    ImGui::PopStyleVar(2);
}

bool AbView::draw(const GlFunctions& gl, Display& first, const PixelRect& rect,
                  PixelSize framebuffer, const ViewerModel& model, const DisplayOverlay& overlay) {
    const std::shared_ptr<const AbSnapshot> snapshot = latest();
    if (!snapshot || !snapshot->a.image || !snapshot->b.image) return false;
    first.update(snapshot->a.image, nullptr, 0, 0);
    display_.update(snapshot->b.image, nullptr, 0, 0);
    const int left = static_cast<int>(
        std::lround(static_cast<double>(model.look.wipe) * static_cast<double>(rect.width)));
    const int bottom = framebuffer.height - rect.y - rect.height;
    gl.Enable(GL_SCISSOR_TEST);
    gl.Scissor(rect.x, bottom, left, rect.height);
    first.draw(rect, framebuffer, model.display, overlay);
    gl.Scissor(rect.x + left, bottom, rect.width - left, rect.height);
    display_.draw(rect, framebuffer, model.display, overlay);
    gl.Disable(GL_SCISSOR_TEST);
    return true;
}

}  // namespace talbot
