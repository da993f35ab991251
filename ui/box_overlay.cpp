#include "ui/box_overlay.h"

#include <imgui.h>

#include <algorithm>
#include <string>

#include "ui/screen_map.h"

namespace talbot {
namespace {

// As many lines as software OpenGL still draws in a small part of a second.
constexpr size_t kMostBoxes = 4096;

constexpr ImU32 kInnerColor = IM_COL32(90, 190, 255, 190);
constexpr ImU32 kLeafColor = IM_COL32(255, 160, 50, 190);

std::string caption(const TreeBoxes& boxes, int level) {
    const auto leaves = std::count_if(boxes.boxes.begin(), boxes.boxes.end(),
                                      [](const TreeBox& box) { return box.is_leaf; });
    std::string text = "Tree level " + std::to_string(level) + ": ";
    if (boxes.is_cut) text += "the largest ";
    text += std::to_string(boxes.boxes.size()) + (boxes.boxes.size() == 1 ? " box, " : " boxes, ");
    return text + std::to_string(leaves) + " of them leaves (orange)";
}

void draw_box(const ScreenMap& screen, const TreeBox& box, const Vec3d& origin, float width,
              ImDrawList& list) {
    const ImU32 color = box.is_leaf ? kLeafColor : kInnerColor;
    for (size_t corner = 0; corner < 8; ++corner) {
        for (size_t axis = 0; axis < 3; ++axis) {
            const size_t other = corner | size_t{1} << axis;
            if (other == corner) continue;
            const std::optional<ScreenLine> line =
                screen.line(box.corners[corner] + origin, box.corners[other] + origin);
            if (!line) continue;
            list.AddLine(ImVec2(line->from.x, line->from.y), ImVec2(line->to.x, line->to.y), color,
                         width);
        }
    }
}

}  // namespace

void BoxOverlay::follow(const ViewerModel& model) {
    if (scene_.lock() == model.scene && level_ == model.look.bvh_boxes) return;
    scene_ = model.scene;
    level_ = model.look.bvh_boxes;
    boxes_ = {};
    if (model.scene && level_ >= 0)
        boxes_ = tree_boxes(model.scene->accel(), static_cast<uint32_t>(level_), kMostBoxes);
}

void BoxOverlay::draw(const ViewerModel& model, const PixelRect& image) {
    follow(model);
    if (!model.scene || level_ < 0) return;
    ImDrawList& list = *ImGui::GetBackgroundDrawList();
    const ImVec2 corner(static_cast<float>(image.x), static_cast<float>(image.y));
    list.PushClipRect(corner,
                      ImVec2(static_cast<float>(image.x + image.width),
                             static_cast<float>(image.y + image.height)),
                      false);
    const float size = ImGui::GetFontSize();
    const ScreenMap screen(model, image);
    for (const TreeBox& box : boxes_.boxes)
        draw_box(screen, box, model.scene->origin(), 0.07f * size, list);
    const std::string text = caption(boxes_, level_);
    const ImVec2 at(corner.x + 0.5f * size, corner.y + 0.4f * size);
    const ImVec2 extent = ImGui::CalcTextSize(text.c_str());
    list.AddRectFilled(ImVec2(at.x - 0.3f * size, at.y - 0.2f * size),
                       ImVec2(at.x + extent.x + 0.3f * size, at.y + extent.y + 0.2f * size),
                       IM_COL32(0, 0, 0, 170));
    list.AddText(at, IM_COL32(255, 255, 255, 255), text.c_str());
    list.PopClipRect();
}

}  // namespace talbot
