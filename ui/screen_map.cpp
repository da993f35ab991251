#include "ui/screen_map.h"

namespace talbot {

ScreenMap::ScreenMap(const ViewerModel& model, const PixelRect& image)
    : origin_(model.scene ? model.scene->origin() : Vec3d(0)),
      rays_(model.view.camera(), origin_, model.settings.width, model.settings.height, Bounds{}),
      corner_(static_cast<float>(image.x), static_cast<float>(image.y)),
      scale_(static_cast<float>(image.width) / static_cast<float>(model.settings.width),
             static_cast<float>(image.height) / static_cast<float>(model.settings.height)) {}

std::optional<Vec2f> ScreenMap::point(const Vec3d& world) const {
    const std::optional<Vec2f> pixel = rays_.project(Vec3f(world - origin_));
    if (!pixel) return std::nullopt;
    return corner_ + *pixel * scale_;
}

std::optional<ScreenLine> ScreenMap::line(const Vec3d& a, const Vec3d& b) const {
    const std::optional<Vec2f> from = point(a);
    const std::optional<Vec2f> to = point(b);
    if (!from && !to) return std::nullopt;
    return ScreenLine{from ? *from : visible_end(b, a, *to), to ? *to : visible_end(a, b, *from)};
}

// The end of the part of a segment that the camera sees, from a visible end (at `at`) towards a
// hidden one.
Vec2f ScreenMap::visible_end(Vec3d visible, Vec3d hidden, Vec2f at) const {
    constexpr int kHalvings = 24;
    for (int i = 0; i < kHalvings; ++i) {
        const Vec3d middle = 0.5 * visible + 0.5 * hidden;
        const std::optional<Vec2f> seen = point(middle);
        (seen ? visible : hidden) = middle;
        if (seen) at = *seen;
    }
    return at;
}

}  // namespace talbot
