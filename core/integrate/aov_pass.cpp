#include "core/integrate/aov_pass.h"

#include <chrono>

#include "core/base/check.h"
#include "core/integrate/path_observer.h"
#include "core/integrate/tiers.h"
#include "core/math/sample_bits.h"

namespace talbot {
namespace {

// What a path has brought when its light has been scattered a certain number of times.
struct LightParts final : PathObserver {
    Rgb emission{0};
    Rgb until_second{0};  // emission and direct light
    uint32_t met = 0;     // ends of rays, the environment included
    uint32_t surfaces = 0;

    void ray(uint32_t, const Ray&, bool found, const Hit&, const PathState&) override {
        surfaces += found ? 1 : 0;
    }
    void vertex(uint32_t, const SurfaceInteraction&, const Material&, const ShadingParams&,
                const std::optional<BsdfSample>&, const PathState&) override {}
    void seen(uint32_t bounce, const PathState& path) override {
        ++met;
        if (bounce == 0) emission = path.Li;
        if (bounce == 1) until_second = path.Li;
    }
};

Rgb path_value(Aov aov, const RenderScene& scene, const CameraRays& camera,
               const PathSettings& settings, uint32_t x, uint32_t y, uint64_t sample_index) {
    using Clock = std::chrono::steady_clock;
    LightParts parts;
    const Clock::time_point start = Clock::now();
    const PathSample sample = observe_path(scene, camera, settings, x, y, sample_index, parts);
    const std::chrono::duration<float, std::micro> spent = Clock::now() - start;
    // A path that met nothing twice has no indirect light.
    const Rgb two = parts.met > 1 ? parts.until_second : sample.Li;
    switch (aov) {
        case Aov::emission:
            return parts.emission;
        case Aov::direct:
            return two - parts.emission;
        case Aov::indirect:
            return sample.Li - two;
        case Aov::bounces:
            return Rgb(static_cast<float>(parts.surfaces));
        default:
            return Rgb(spent.count());
    }
}

Rgb missed(Aov aov) {
    if (aov == Aov::depth) return Rgb(kInfinity);
    if (aov == Aov::material_id || aov == Aov::object_id) return Rgb(-1);
    if (aov == Aov::bvh_depth || aov == Aov::bvh_leaf) return Rgb(-1);
    return Rgb(0);
}

// Leaves of a tree are told apart by a number that float holds exactly.
Rgb leaf_value(Aov aov, const Accel& accel, const Ray& ray, const Hit& hit) {
    LeafPlace place;
    if (!accel.find_leaf(ray, hit, place)) return missed(aov);
    return Rgb(static_cast<float>(aov == Aov::bvh_depth ? place.depth : hash32(place.leaf) >> 8));
}

Rgb first_hit_value(Aov aov, const RenderScene& rs, const CameraRays& camera,
                    const PathSettings& settings, uint32_t x, uint32_t y, uint64_t sample_index) {
    const Sampler sampler(settings.sampler, settings.seed, x, y, sample_index);
    const Vec2f offset = sample_pixel_filter(settings.filter, sampler.pair(Purpose::pixel));
    const Vec2f lens = camera.has_lens() ? sampler.pair(Purpose::lens) : Vec2f(0);
    const Ray ray =
        camera.ray(static_cast<float>(x) + offset.x, static_cast<float>(y) + offset.y, lens);
    Hit hit;
    if (aov == Aov::traversal_steps) {
        uint32_t steps = 0;
        rs.scene().accel().closest_counting(ray, hit, steps);
        return Rgb(static_cast<float>(steps));
    }
    if (!intersect<kFullTier>(rs, sampler, 0, ray, hit)) return missed(aov);
    if (aov == Aov::bvh_depth || aov == Aov::bvh_leaf)
        return leaf_value(aov, rs.scene().accel(), ray, hit);
    if (aov == Aov::depth) return Rgb(camera.distance_to(ray, hit.t));
    if (aov == Aov::object_id) return Rgb(static_cast<float>(rs.scene().object_of(hit.id)));
    SurfaceInteraction si = make_surface_interaction<kFullTier>(rs.scene(), ray, hit);
    if (aov == Aov::material_id) return Rgb(static_cast<float>(si.material));
    if (aov == Aov::uv) return Rgb(si.uv[0].x, si.uv[0].y, 0);
    if (aov == Aov::position) return Rgb(Vec3d(si.p) + rs.scene().origin());
    const float side = si.front ? 1.0f : -1.0f;
    if (aov == Aov::geometric_normal) return side * si.n_geometric;
    const Material& material = rs.scene().materials()[si.material];
    if (aov == Aov::albedo) return Rgb(eval_base_color<kFullTier>(rs.scene(), material, si));
    apply_normal_map<kFullTier>(rs.scene(), material, si);
    return side * si.shading.n;
}

}  // namespace

Rgb aov_sample(Aov aov, const RenderScene& scene, const CameraRays& camera,
               const PathSettings& settings, uint32_t x, uint32_t y, uint64_t sample_index) {
    const AovSource source = aov_info(aov).source;
    TALBOT_CHECK(source != AovSource::film);
    if (source == AovSource::path)
        return path_value(aov, scene, camera, settings, x, y, sample_index);
    return first_hit_value(aov, scene, camera, settings, x, y, sample_index);
}

AovBuffer::AovBuffer(Aov aov, uint32_t width, uint32_t height)
    : aov_(aov),
      width_(width),
      height_(height),
      sums_(std::size_t{width} * height, Vec3d(0)),
      pass_(std::size_t{width} * height) {}

bool AovBuffer::add_pass(const RenderScene& scene, const CameraRays& camera,
                         const PathSettings& settings, uint64_t first_sample, WorkerPool& pool,
                         const std::stop_token& stop) {
    const bool averaged = aov_info(aov_).averaged;
    if (!averaged && samples_ > 0) return true;
    const uint64_t index = first_sample + samples_;
    pool.parallel_for(
        height_,
        [&](uint64_t row, unsigned) {
            for (uint32_t x = 0; x < width_ && !stop.stop_requested(); ++x) {
                pass_[row * width_ + x] =
                    aov_sample(aov_, scene, camera, settings, x, static_cast<uint32_t>(row), index);
            }
        },
        stop);
    if (stop.stop_requested()) return false;
    for (std::size_t i = 0; i < sums_.size(); ++i) sums_[i] += Vec3d(pass_[i]);
    ++samples_;
    return true;
}

AovImage AovBuffer::image() const {
    AovImage result;
    result.aov = aov_;
    result.samples = samples_;
    result.image.width = width_;
    result.image.height = height_;
    result.image.rgb.reserve(sums_.size());
    const double count = std::max(1u, samples_);
    for (const Vec3d& sum : sums_) result.image.rgb.push_back(Rgb(sum / count));
    find_range(result);
    return result;
}

}  // namespace talbot
