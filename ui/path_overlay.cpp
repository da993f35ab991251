#include "ui/path_overlay.h"

#include <imgui.h>

#include <string>

#include "ui/screen_map.h"

namespace talbot {
namespace {

class PathPainter {
  public:
    PathPainter(const ViewerModel& model, const PixelRect& image)
        : screen_(model, image),
          list_(*ImGui::GetBackgroundDrawList()),
          size_(ImGui::GetFontSize()) {}

    void segment(Vec3d a, Vec3d b, ImU32 color) {
        const std::optional<ScreenLine> line = screen_.line(a, b);
        if (!line) return;
        const ImVec2 p(line->from.x, line->from.y);
        const ImVec2 q(line->to.x, line->to.y);
        list_.AddLine(p, q, IM_COL32(0, 0, 0, 190), 0.32f * size_);
        list_.AddLine(p, q, color, 0.14f * size_);
    }

    void vertex(const Vec3d& point, std::size_t number) {
        const std::optional<Vec2f> at = screen_.point(point);
        if (!at) return;
        const ImVec2 p(at->x, at->y);
        list_.AddCircleFilled(p, 0.36f * size_, IM_COL32(0, 0, 0, 220));
        list_.AddCircleFilled(p, 0.27f * size_, IM_COL32(255, 150, 40, 255));
        const std::string text = std::to_string(number);
        const ImVec2 corner(p.x + 0.5f * size_, p.y - 0.6f * size_);
        list_.AddText(ImVec2(corner.x + 1, corner.y + 1), IM_COL32(0, 0, 0, 220), text.c_str());
        list_.AddText(corner, IM_COL32(255, 255, 255, 255), text.c_str());
    }

  private:
    ScreenMap screen_;
    ImDrawList& list_;
    float size_;
};

}  // namespace

void draw_path(const ReplayedPath& path, const ViewerModel& model, const PixelRect& image) {
    ImDrawList& list = *ImGui::GetBackgroundDrawList();
    list.PushClipRect(ImVec2(static_cast<float>(image.x), static_cast<float>(image.y)),
                      ImVec2(static_cast<float>(image.x + image.width),
                             static_cast<float>(image.y + image.height)),
                      false);
    PathPainter painter(model, image);
    const ImU32 color = IM_COL32(255, 205, 60, 255);
    // The first ray is seen from its end: it is the first vertex.
    Vec3d last = path.vertices.empty() ? path.start : path.vertices.front().point;
    for (const ReplayedPath::Vertex& vertex : path.vertices) {
        painter.segment(last, vertex.point, color);
        last = vertex.point;
    }
    if (path.escapes) {
        const double reach = 0.5 * model.view.scene_radius();
        painter.segment(last, last + reach * path.last_direction, IM_COL32(90, 170, 255, 255));
    }
    for (std::size_t i = 0; i < path.vertices.size(); ++i)
        painter.vertex(path.vertices[i].point, i);
    list.PopClipRect();
}

}  // namespace talbot
