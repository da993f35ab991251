// The structure behind Accel, and what building and refitting it share.
#pragma once

#include <vector>

#include "core/geometry/accel.h"
#include "core/geometry/beam_entry.h"
#include "core/geometry/bvh.h"
#include "core/geometry/bvh_build.h"

namespace talbot {

class BvhAccel final : public Accel {
  public:
    bool closest(const Ray& ray, Hit& hit) const override {
        return kernels.closest(scene, ray, hit, nullptr, nullptr, nullptr);
    }
    BeamEntry enter(const Beam& beam) const override {
        BeamEntry entry;
        find_beam_entry(scene.top, beam, entry);
        return entry;
    }
    bool closest(const Ray& ray, Hit& hit, const BeamEntry& entry) const override {
        return kernels.closest(scene, ray, hit, nullptr, nullptr,
                               entry.is_root ? nullptr : &entry.node);
    }
    bool closest(const Ray& ray, Hit& hit, const HitFilter& filter) const override {
        return kernels.closest_filtered(scene, ray, hit, &filter, nullptr, nullptr);
    }
    bool occluded(const Ray& ray) const override { return kernels.occluded(scene, ray, nullptr); }
    bool occluded(const Ray& ray, const HitFilter& filter) const override {
        return kernels.occluded_filtered(scene, ray, &filter);
    }
    bool closest_counting(const Ray& ray, Hit& hit, uint32_t& steps) const override {
        return kernels.closest_counting(scene, ray, hit, nullptr, &steps, nullptr);
    }
    bool find_leaf(const Ray& ray, const Hit& hit, LeafPlace& place) const override;
    const AccelStats& stats() const override { return numbers; }
    Bounds bounds() const override { return scene.top.bounds; }

    BvhScene scene;
    TraversalKernels kernels;
    AccelStats numbers;
    // What the structure was built of.
    std::vector<uint64_t> mesh_triangles;
    std::vector<uint32_t> instance_meshes;
    uint64_t spheres = 0;
};

// A box round each object of the scene, whose trees must be there; empty where nothing can be hit.
std::vector<BuildPrimitive> object_boxes(const AccelInput& input, const BvhScene& scene);

// Sets all but the trees, the objects and the number of dropped triangles.
void complete(const AccelInput& input, BvhAccel& accel);

}  // namespace talbot
