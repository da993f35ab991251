// What a sample's light went through: its radiance sorted by kind of path and by the light that it
// came from. For diagnostics; the kernels know nothing of it.
#pragma once

#include <array>
#include <string_view>
#include <vector>

#include "core/integrate/path_observer.h"

namespace talbot {

// A vertex is sharp where the path went on by a mirror or clear glass, or by a lobe hardly wider;
// else broad.
enum class PathKind : uint8_t {
    seen,      // the light itself, without a vertex
    mirrored,  // the light behind nothing but sharp vertices
    direct,    // light on the first broad vertex
    indirect,  // light on a later one
    caustic,   // light that reached a broad vertex by sharp ones
    volume,    // light that scattered inside a medium
};
inline constexpr std::size_t kPathKinds = 6;

struct PathKindInfo {
    PathKind kind;
    std::string_view name;
    std::string_view label;
};
inline constexpr std::array<PathKindInfo, kPathKinds> kPathKindTable{{
    {PathKind::seen, "seen", "lamps and sky, seen"},
    {PathKind::mirrored, "mirrored", "lamps and sky in mirrors and glass"},
    {PathKind::direct, "direct", "direct light"},
    {PathKind::indirect, "indirect", "indirect light"},
    {PathKind::caustic, "caustic", "caustics"},
    {PathKind::volume, "volume", "light scattered inside volumes"},
}};

// Where light comes from: an emissive object by its index, or one of these.
inline constexpr uint32_t kEnvironmentSource = 0xFFFFFFFF;
inline constexpr uint32_t kPunctualSource = 0xFFFFFFFE;

// Sorts one sample after the other.
class PathSorter final : public PathObserver {
  public:
    struct Part {
        PathKind kind;
        uint32_t source;
        Rgb radiance;
    };

    PathSorter(const RenderScene& scene, const CameraRays& camera, const PathSettings& settings)
        : scene_(scene), camera_(camera), settings_(settings) {}

    // The sample; parts() then add up to its radiance.
    PathSample trace(uint32_t x, uint32_t y, uint64_t sample_index);
    const std::vector<Part>& parts() const { return parts_; }

    void ray(uint32_t bounce, const Ray& ray, bool found, const Hit& hit,
             const PathState& path) override;
    void seen(uint32_t bounce, const PathState& path) override;
    void in_medium(uint32_t bounce, const Vec3f& p, const PathState& path) override;
    void vertex(uint32_t bounce, const SurfaceInteraction& si, const Material& material,
                const ShadingParams& params, const std::optional<BsdfSample>& scattered,
                const PathState& path) override;

  private:
    PathKind kind() const;
    uint32_t end_of_ray() const;
    void sort(PathKind kind, uint32_t source, const PathState& path);
    void add(PathKind kind, uint32_t source, const Rgb& radiance);

    const RenderScene& scene_;
    const CameraRays& camera_;
    const PathSettings& settings_;
    std::vector<Part> parts_;
    uint32_t x_ = 0, y_ = 0;
    uint64_t sample_ = 0;
    Hit hit_;
    Vec3f direction_{0};
    bool found_ = false;
    Rgb sorted_{0};  // of the path's radiance
    uint32_t sharp_ = 0, broad_ = 0;
    bool last_sharp_ = false;
    bool in_media_ = false;
};

}  // namespace talbot
