// The ray engine's interface: an immutable two-level structure over triangle meshes, instances and
// analytic spheres. All coordinates are re-centred world coordinates. Everything here is robust by
// construction: watertight triangles, padded slabs, identity-based exclusion; no tolerance depends
// on the scale of the scene.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <stop_token>
#include <vector>

#include "core/base/worker_pool.h"
#include "core/geometry/beam.h"
#include "core/geometry/bounds.h"
#include "core/math/ray.h"
#include "core/math/vec.h"

namespace talbot {

// Triangles as the scene keeps them; the spans must outlive the build only (the structure copies
// what it needs).
struct AccelMesh {
    std::span<const Vec3f> positions;
    std::span<const uint32_t> indices;  // three per triangle
};

struct AccelInstance {
    uint32_t mesh = 0;
    bool identity =
        true;  // then the mesh is already in world coordinates and is merged into the top level
    Mat4d world_from_object{1.0};  // affine
    bool filtered = false;         // its hits are put to the HitFilter, where a call has one
};

struct AccelSphere {
    Vec3d center{0};
    double radius = 0;
    bool filtered = false;
};

enum class BuildQuality { fast, high };

struct AccelInput {
    std::vector<AccelMesh> meshes;
    std::vector<AccelInstance> instances;  // Hit.id.instance indexes this
    std::vector<AccelSphere> spheres;      // Hit.id = {kSphereInstance, index}
    BuildQuality quality = BuildQuality::high;
};

// Decides whether a hit on a filtered instance counts. Must be a pure function of its arguments
// (the order of calls is not defined): alpha coverage and camera-only back-face culling live here.
struct HitFilter {
    bool (*accepts)(const void* context, const Ray& ray, const Hit& hit) = nullptr;
    const void* context = nullptr;
};

struct AccelStats {
    uint64_t triangles = 0;   // stored ones
    uint64_t references = 0;  // to them: more where some were cut
    uint64_t instances = 0;
    uint64_t spheres = 0;
    uint64_t nodes = 0;
    uint64_t bytes = 0;
    uint64_t dropped_triangles = 0;  // non-finite or exactly degenerate, which no ray can hit
    // The most triangles in one place, so that no tree parts them and a ray there tests them all;
    // and a mesh that has of them.
    uint64_t crowd = 0;
    uint32_t crowd_mesh = kNoId;
    uint32_t depth = 0;
    double build_seconds = 0;
};

// A leaf of the structure: its level below the root (of instances: of both trees added up), and a
// name for it that differs from those of other leaves of its tree.
struct LeafPlace {
    uint32_t depth = 0;
    uint32_t leaf = 0;
};

class Accel {
  public:
    virtual ~Accel() = default;

    // Closest hit in (0, t_max), ties by the lower PrimitiveId; false and an untouched hit when
    // there is none. With a filter, hits on filtered instances count only if it accepts them.
    virtual bool closest(const Ray& ray, Hit& hit) const = 0;
    virtual bool closest(const Ray& ray, Hit& hit, const HitFilter& filter) const = 0;

    // For rays that run side by side: the same hits as closest(ray, hit) in less time. Every such
    // ray must be of the beam that the entry was found for.
    virtual BeamEntry enter(const Beam& beam) const = 0;
    virtual bool closest(const Ray& ray, Hit& hit, const BeamEntry& entry) const = 0;

    // Whether anything lies in (0, t_max).
    virtual bool occluded(const Ray& ray) const = 0;
    virtual bool occluded(const Ray& ray, const HitFilter& filter) const = 0;

    // Closest hit and the number of nodes visited, for the debug view.
    virtual bool closest_counting(const Ray& ray, Hit& hit, uint32_t& steps) const = 0;

    virtual const AccelStats& stats() const = 0;
    virtual Bounds bounds() const = 0;

    // The leaf that keeps the primitive of a hit that closest() gave for the ray, for debug views;
    // false where there are no leaves. Slow.
    virtual bool find_leaf(const Ray& ray, const Hit& hit, LeafPlace& place) const = 0;
};

// Builds the structure; null only when stop was requested. progress, when given, is called with
// 0..1 from any thread.
std::unique_ptr<const Accel> build_accel(const AccelInput& input, WorkerPool& pool,
                                         std::stop_token stop = {},
                                         const std::function<void(float)>& progress = {});

// The structure that `previous` becomes when vertices, transforms or spheres have moved: its trees
// keep their shape and get new boxes, at a small part of a build's cost. Null when `input` has not
// the same meshes and instances, when triangles came up that `previous` had dropped, when triangles
// are cut in it, when its boxes would overlap so much that a build is the better choice, or when
// stop was requested.
std::unique_ptr<const Accel> refit_accel(const Accel& previous, const AccelInput& input,
                                         WorkerPool& pool, std::stop_token stop = {});

// The same interface without any acceleration structure, as the oracle of tests and the "BVH off"
// switch.
std::unique_ptr<const Accel> build_brute_force(const AccelInput& input);

}  // namespace talbot
