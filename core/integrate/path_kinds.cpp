#include "core/integrate/path_kinds.h"

#include "core/integrate/tiers.h"

namespace talbot {
namespace {

// Per steradian; a lobe of a degree and a half.
constexpr float kSharpPdf = 500;

}  // namespace

PathKind PathSorter::kind() const {
    if (in_media_) return PathKind::volume;
    if (broad_ == 0) return sharp_ == 0 ? PathKind::seen : PathKind::mirrored;
    if (last_sharp_) return PathKind::caustic;
    return broad_ == 1 ? PathKind::direct : PathKind::indirect;
}

void PathSorter::add(PathKind kind, uint32_t source, const Rgb& radiance) {
    if (radiance.x != 0 || radiance.y != 0 || radiance.z != 0)
        parts_.push_back({kind, source, radiance});
}

PathSample PathSorter::trace(uint32_t x, uint32_t y, uint64_t sample_index) {
    parts_.clear();
    x_ = x;
    y_ = y;
    sample_ = sample_index;
    sorted_ = Rgb(0);
    sharp_ = broad_ = 0;
    last_sharp_ = false;
    in_media_ = false;
    const PathSample sample = observe_path(scene_, camera_, settings_, x, y, sample_index, *this);
    // An unlit surface ends the path without a word.
    add(kind(), end_of_ray(), sample.Li - sorted_);
    return sample;
}

uint32_t PathSorter::end_of_ray() const {
    if (found_) return scene_.scene().object_of(hit_.id);
    for (const SunDisc& sun : scene_.lights().suns()) {
        if (sun.holds(direction_)) return kPunctualSource;
    }
    return kEnvironmentSource;
}

// What the path has brought since the last call.
void PathSorter::sort(PathKind kind, uint32_t source, const PathState& path) {
    add(kind, source, path.Li - sorted_);
    sorted_ = path.Li;
}

void PathSorter::ray(uint32_t, const Ray& ray, bool found, const Hit& hit, const PathState&) {
    hit_ = hit;
    direction_ = ray.d;
    found_ = found;
}

void PathSorter::seen(uint32_t, const PathState& path) {
    sort(kind(), end_of_ray(), path);
}

void PathSorter::in_medium(uint32_t, const Vec3f&, const PathState& path) {
    in_media_ = true;
    // Lights inside the body; which one is not told.
    sort(PathKind::volume, end_of_ray(), path);
}

void PathSorter::vertex(uint32_t bounce, const SurfaceInteraction& si, const Material&,
                        const ShadingParams& params, const std::optional<BsdfSample>& scattered,
                        const PathState& path) {
    if (path.Li != sorted_) {
        // The light that was drawn, once more.
        const Sampler sampler(settings_.sampler, settings_.seed, x_, y_, sample_);
        const Bounce numbers = sampler.bounce(bounce);
        const Vec3f n =
            is_lit_through(params) ? Vec3f(0) : (si.front ? 1.0f : -1.0f) * si.n_surface();
        const std::optional<LightSample> light = scene_.lights().sample(
            scene_.scene(), si.lit_point(), n, numbers.light_choice(), numbers.light());
        const uint32_t source = !light || light->delta ? kPunctualSource
                                : light->infinite      ? kEnvironmentSource
                                                       : scene_.scene().object_of(light->id);
        const PathKind drawn = in_media_     ? PathKind::volume
                               : broad_ == 0 ? PathKind::direct
                                             : PathKind::indirect;
        sort(drawn, source, path);
    }
    if (!scattered) return;
    last_sharp_ = scattered->delta || scattered->pdf > kSharpPdf;
    ++(last_sharp_ ? sharp_ : broad_);
}

}  // namespace talbot
