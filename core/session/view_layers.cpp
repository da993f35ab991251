#include "core/session/view_layers.h"

#include <algorithm>

#include "core/integrate/object_ids.h"
#include "core/session/scheduler.h"

namespace talbot {
namespace {

// Samples a pixel of a variable; enough for smooth edges and a first look at light.
constexpr uint32_t kMostAovSamples = 64;

CameraRays rays_of(const ViewLayers::View& view, uint32_t width, uint32_t height) {
    const Scene& scene = view.scene.scene();
    return CameraRays(view.camera, scene.origin(), width, height, scene.geometry().bounds);
}

}  // namespace

void ViewLayers::select(std::optional<uint32_t> object) {
    selection_ = object;
    object_ids_.reset();
}

void ViewLayers::show(std::optional<Aov> aov) {
    if (aov == Aov::beauty) aov.reset();
    if (aov == aov_) return;
    aov_ = aov;
    buffer_ = AovBuffer();
    image_.reset();
}

void ViewLayers::restart() {
    object_ids_.reset();
    buffer_ = AovBuffer();
    image_.reset();
}

bool ViewLayers::traces() const {
    return aov_ && aov_info(*aov_).source != AovSource::film;
}

bool ViewLayers::are_missing() const {
    return (selection_ && !object_ids_) || (traces() && buffer_.samples() == 0);
}

void ViewLayers::preview(const View& view, uint32_t width, uint32_t height) {
    if (!traces()) return;
    AovBuffer buffer(*aov_, width, height);
    const bool done =
        buffer.add_pass(view.scene, rays_of(view, width, height), path_settings(view.settings),
                        view.settings.first_sample, view.pool, {});
    if (done) image_ = std::make_shared<const AovImage>(buffer.image());
}

void ViewLayers::glimpse(const View& view, double samples_per_second, double seconds) {
    if (!are_missing()) return;
    const RenderSettings& settings = view.settings;
    const uint64_t pixels = uint64_t{settings.width} * settings.height;
    const uint32_t divisor = preview_divisor(pixels, samples_per_second, seconds);
    preview(view, std::max(1u, settings.width / divisor), std::max(1u, settings.height / divisor));
}

// What is cut short is begun anew.
void ViewLayers::update(const View& view, const std::stop_token& stop) {
    const uint32_t width = view.settings.width;
    const uint32_t height = view.settings.height;
    if (selection_ && !object_ids_) {
        object_ids_ =
            render_object_ids(view.scene, rays_of(view, width, height), width, height, view.pool);
    }
    if (!traces() || buffer_.samples() >= kMostAovSamples) return;
    if (buffer_.samples() > 0 && !aov_info(*aov_).averaged) return;
    if (buffer_.samples() == 0) buffer_ = AovBuffer(*aov_, width, height);
    const bool done =
        buffer_.add_pass(view.scene, rays_of(view, width, height), path_settings(view.settings),
                         view.settings.first_sample, view.pool, stop);
    if (done) image_ = std::make_shared<const AovImage>(buffer_.image());
}

void ViewLayers::update_from(const Film& film, const std::vector<float>& block_errors) {
    if (!aov_ || traces()) return;
    image_ = std::make_shared<const AovImage>(film_aov(*aov_, film, block_errors));
}

}  // namespace talbot
