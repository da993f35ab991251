// Where a range of primitives is best split by the surface area heuristic between bins of
// centroids. Reference: Wald 2007, "On fast construction of SAH-based bounding volume hierarchies".
#pragma once

#include <cstdint>
#include <span>

#include "core/geometry/bvh_build.h"
#include "core/geometry/float4.h"
#include "core/math/vec.h"

namespace talbot {

struct Box {
    Float4 lower{kInfinity, kInfinity, kInfinity, kInfinity};
    Float4 upper{-kInfinity, -kInfinity, -kInfinity, -kInfinity};

    void add(const Float4& lo, const Float4& hi) {
        lower = min4(lower, lo);
        upper = max4(upper, hi);
    }
    void add(const Box& b) { add(b.lower, b.upper); }
    // Half the surface; in double, so that boxes of any finite size have one.
    double half_area() const {
        const double x = static_cast<double>(upper[0]) - lower[0];
        const double y = static_cast<double>(upper[1]) - lower[1];
        const double z = static_cast<double>(upper[2]) - lower[2];
        return x < 0 ? 0.0 : x * y + y * z + z * x;
    }
};

inline Float4 lower_of(const BuildPrimitive& p) {
    return Float4{p.lower.x, p.lower.y, p.lower.z, 0};
}
inline Float4 upper_of(const BuildPrimitive& p) {
    return Float4{p.upper.x, p.upper.y, p.upper.z, 0};
}

// A range of primitives that becomes one child: a leaf, or to be split along `axis` (kNoAxis:
// halved). Centroids are doubled, lower + upper.
struct Range {
    static constexpr int kNoAxis = -1;
    uint64_t begin = 0;
    uint64_t end = 0;
    uint64_t room = 0;  // unused places from `end` on, for parts of primitives that are cut in two
    uint64_t objects = 0;  // primitives that are no triangles
    Box box;
    Box centroids;
    bool is_leaf = false;            // when it becomes a child, rather than an inner node
    bool is_worth_splitting = true;  // among children of a node, where one more costs nothing
    int axis = kNoAxis;
    uint32_t split_bin = 0;   // the first one of the second part
    bool is_spatial = false;  // the split is by a plane, through primitives
    uint64_t crowd = 0;  // triangles of the largest range above, or this, that share one centroid

    uint64_t size() const { return end - begin; }
    bool is_crowd() const {
        for (int i = 0; i < 3; ++i) {
            if (centroids.lower[i] != centroids.upper[i]) return false;
        }
        return objects == 0;
    }
    void add(const BuildPrimitive& p) {
        const Float4 lower = lower_of(p);
        const Float4 upper = upper_of(p);
        box.add(lower, upper);
        centroids.add(lower + upper, lower + upper);
        objects += p.instance == kObjectPrimitive ? 1 : 0;
    }
    void add(const Range& part) {
        box.add(part.box);
        centroids.add(part.centroids);
        objects += part.objects;
    }
};

inline uint64_t blocks_of(uint64_t triangles) {
    return (triangles + kBlockWidth - 1) / kBlockWidth;
}

// What a split costs: half surface times blocks of triangles, of both parts.
struct SplitCost {
    double cost = kInfinity;
    double overlap = 0;  // half surface of what the boxes of the parts have in common
};

// Sets how the range is split best; its cost is infinite when there is no split. Large ranges are
// read by all workers of the pool, when there is one.
SplitCost search_split(std::span<const BuildPrimitive> primitives, BuildQuality quality,
                       WorkerPool* pool, Range& range);

// Orders the primitives of a range with an axis for its split, adds them to the two parts, and
// returns how many are in the first.
uint64_t partition_range(std::span<BuildPrimitive> primitives, BuildQuality quality,
                         const Range& range, Range& first, Range& second);

// Ranges of so many primitives are read in pieces of this size by several workers.
inline constexpr uint64_t kPieceSize = 32768;

}  // namespace talbot
