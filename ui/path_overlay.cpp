#include "ui/path_overlay.h"

#include <imgui.h>

#include <string>

namespace talbot {
namespace {

// The end of the part of a segment that the camera sees, from a visible end towards a hidden one.
Vec3d visible_end(const ViewerModel& model, const PixelRect& image, Vec3d visible, Vec3d hidden) {
    constexpr int kHalvings = 24;
    for (int i = 0; i < kHalvings; ++i) {
        const Vec3d middle = 0.5 * visible + 0.5 * hidden;
        (screen_position(model, image, middle) ? visible : hidden) = middle;
    }
    return visible;
}

class PathPainter {
  public:
    PathPainter(const ViewerModel& model, const PixelRect& image)
        : model_(model),
          image_(image),
          list_(*ImGui::GetBackgroundDrawList()),
          size_(ImGui::GetFontSize()) {}

    void segment(Vec3d a, Vec3d b, ImU32 color) {
        std::optional<Vec2f> from = screen_position(model_, image_, a);
        std::optional<Vec2f> to = screen_position(model_, image_, b);
        if (!from && !to) return;
        if (!to) to = screen_position(model_, image_, visible_end(model_, image_, a, b));
        if (!from) from = screen_position(model_, image_, visible_end(model_, image_, b, a));
        if (!from || !to) return;
        const ImVec2 p(from->x, from->y);
        const ImVec2 q(to->x, to->y);
        list_.AddLine(p, q, IM_COL32(0, 0, 0, 190), 0.32f * size_);
        list_.AddLine(p, q, color, 0.14f * size_);
    }

    void vertex(const Vec3d& point, std::size_t number) {
        const std::optional<Vec2f> at = screen_position(model_, image_, point);
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
    const ViewerModel& model_;
    const PixelRect& image_;
    ImDrawList& list_;
    float size_;
};

}  // namespace

std::optional<Vec2f> screen_position(const ViewerModel& model, const PixelRect& image,
                                     const Vec3d& point) {
    if (!model.scene) return std::nullopt;
    const Vec3d& origin = model.scene->origin();
    const CameraRays rays(model.view.camera(), origin, model.settings.width, model.settings.height,
                          Bounds{});
    const std::optional<Vec2f> pixel = rays.project(Vec3f(point - origin));
    if (!pixel) return std::nullopt;
    const float scale_x =
        static_cast<float>(image.width) / static_cast<float>(model.settings.width);
    const float scale_y =
        static_cast<float>(image.height) / static_cast<float>(model.settings.height);
    return Vec2f(static_cast<float>(image.x) + pixel->x * scale_x,
                 static_cast<float>(image.y) + pixel->y * scale_y);
}

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
