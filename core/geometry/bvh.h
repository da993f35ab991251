// The stored form of the structure: nodes of eight boxes, leaves of up to eight blocks of four
// triangles, and lists of objects (spheres and instances). Trees refer to nodes, blocks and objects
// by index.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/base/huge_pages.h"
#include "core/geometry/accel.h"
#include "core/geometry/force_inline.h"
#include "core/geometry/wide_node.h"
#include "core/math/ray.h"
#include "core/math/vec.h"

namespace talbot {

inline constexpr uint32_t kBlockWidth = 4;
inline constexpr uint32_t kMaxLeafItems = 8;  // blocks or objects
// Wide levels built by surface area before the builder halves ranges, and the most that can follow.
inline constexpr uint32_t kMaxAreaDepth = 32;
inline constexpr uint32_t kMaxDepth = kMaxAreaDepth + 12;
// Trees of fewer bytes stay in a core's own cache.
inline constexpr uint64_t kCachedTreeBytes = uint64_t{1} << 18;
inline constexpr uint32_t kStackSize = kMaxDepth * (kNodeWidth - 1) + 1;

// What a child is: an inner node's index, or a leaf's kind, number of items (less one) and first
// item.
class ChildRef {
  public:
    static constexpr uint32_t kLeafBit = 0x80000000u;
    static constexpr uint32_t kObjectBit = 0x40000000u;
    static constexpr uint32_t kCountShift = 27;
    static constexpr uint32_t kIndexMask = (1u << kCountShift) - 1;

    static uint32_t inner(uint64_t index) { return static_cast<uint32_t>(index); }
    static uint32_t leaf(uint64_t first, uint64_t count, bool objects) {
        return kLeafBit | (objects ? kObjectBit : 0u) |
               (static_cast<uint32_t>(count - 1) << kCountShift) | static_cast<uint32_t>(first);
    }
    static bool is_leaf(uint32_t ref) { return (ref & kLeafBit) != 0; }
    static bool is_objects(uint32_t ref) { return (ref & kObjectBit) != 0; }
    static uint32_t count(uint32_t ref) { return ((ref >> kCountShift) & (kMaxLeafItems - 1)) + 1; }
    static uint32_t first(uint32_t ref) { return ref & kIndexMask; }
};

// Four triangles: coordinate [vertex][axis][lane]. Unused lanes hold NaN, which no test accepts.
struct alignas(16) TriangleBlock {
    float vertex[3][3][kBlockWidth];
    float extent[kBlockWidth];
    uint32_t number[kBlockWidth];  // in the tree's mesh, or of TriangleNumbers; kNoId if unused
};

// Coordinates of one lane, for intersect_triangle.
struct BlockCorner {
    const TriangleBlock& block;
    uint32_t lane;

    TALBOT_FORCE_INLINE float operator()(uint32_t k, uint32_t axis) const {
        return block.vertex[k][axis][lane];
    }
};

struct Tree {
    HugePageVector<WideNode> nodes;
    HugePageVector<TriangleBlock> blocks;
    std::vector<uint32_t> objects;  // into BvhScene::objects
    uint32_t root = 0;
    bool is_empty = true;
    bool outgrows_cache = false;  // then traversal asks for memory ahead
    Bounds bounds;
    float largest_coordinate = 0;  // of the bounds
    uint32_t depth = 0;
    uint64_t triangles = 0;
    uint64_t references = 0;  // lanes in use: more than triangles where some were cut
    double built_cost = 0;    // of refitted trees: tree_cost when they were built
    uint64_t crowd = 0;       // most triangles whose boxes share one centre: no split parts them
    uint32_t crowd_number = kNoId;  // of one of those

    template <class Corner>
    void set_bounds(const Corner& lower, const Corner& upper) {
        bounds = {{lower[0], lower[1], lower[2]}, {upper[0], upper[1], upper[2]}};
        largest_coordinate = bounds.largest_coordinate();
    }
    uint64_t bytes() const {
        return nodes.size() * sizeof(WideNode) + blocks.size() * sizeof(TriangleBlock) +
               objects.size() * sizeof(uint32_t);
    }
};

// A sphere, or a mesh under a transform.
struct SceneObject {
    bool is_sphere = false;
    bool filtered = false;
    uint32_t id = 0;  // index of the sphere or of the instance
    uint32_t tree = 0;
    Vec3d center{0};
    double radius = 0;
    Mat3d object_from_world{1.0};
    Vec3d object_from_world_offset{0};
};

// The triangles of the instances that are merged into the top tree, numbered through in the order
// of their ids: four bytes name one.
class TriangleNumbers {
  public:
    TriangleNumbers() = default;
    explicit TriangleNumbers(const AccelInput& input);

    TALBOT_FORCE_INLINE PrimitiveId id(uint32_t number) const {
        const Part* part = parts_.data() + pages_[number >> kPageShift];
        while (part[1].first <= number) ++part;
        return {part->instance, number - part->first};
    }
    // kNoId when the triangle is not of a merged instance.
    uint32_t number(const PrimitiveId& id) const;
    // The merged instance if there is just one, else kNoId.
    uint32_t only_instance() const { return only_instance_; }
    uint64_t bytes() const {
        return parts_.size() * sizeof(Part) + pages_.size() * sizeof(uint32_t);
    }

  private:
    struct Part {
        uint32_t first;
        uint32_t instance;
    };
    static constexpr uint32_t kPageShift = 7;

    std::vector<Part> parts_;      // those with triangles, and an end
    std::vector<uint32_t> pages_;  // the part that each 128th number is in
    uint32_t only_instance_ = kNoId;
};

struct BvhScene {
    Tree top;
    TriangleNumbers merged;
    std::vector<Tree> trees;
    std::vector<SceneObject> objects;
    std::vector<uint8_t> filtered;  // per instance
};

// Traversal routines for one instruction set and one kind of scene.
struct TraversalKernels {
    // Rays begin at the node `entry`, or where it is null at the root.
    bool (*closest)(const BvhScene& scene, const Ray& ray, Hit& hit, const HitFilter* filter,
                    uint32_t* steps, const WideNode* entry) = nullptr;
    bool (*closest_filtered)(const BvhScene& scene, const Ray& ray, Hit& hit,
                             const HitFilter* filter, uint32_t* steps,
                             const WideNode* entry) = nullptr;
    bool (*closest_counting)(const BvhScene& scene, const Ray& ray, Hit& hit,
                             const HitFilter* filter, uint32_t* steps,
                             const WideNode* entry) = nullptr;
    bool (*occluded)(const BvhScene& scene, const Ray& ray, const HitFilter* filter) = nullptr;
    bool (*occluded_filtered)(const BvhScene& scene, const Ray& ray,
                              const HitFilter* filter) = nullptr;
};

// The best routines that this processor runs.
TraversalKernels choose_kernels(bool has_objects, bool has_filtered);

// Name of the instruction set that choose_kernels takes, for run records.
const char* traversal_target_name();

}  // namespace talbot
