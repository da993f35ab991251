// Builds one wide tree over boxes by binned surface area heuristic.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <stop_token>

#include "core/base/worker_pool.h"
#include "core/geometry/bvh.h"

namespace talbot {

// A primitive's box. `instance` is kObjectPrimitive for objects; then `index` is the object's.
struct alignas(32) BuildPrimitive {
    Vec3f lower;
    uint32_t instance;
    Vec3f upper;
    uint32_t index;
};

inline constexpr uint32_t kObjectPrimitive = 0xFFFFFFFDu;

// Fills one lane of a block with the triangle behind a primitive.
using FillTriangle =
    std::function<void(const BuildPrimitive& primitive, TriangleBlock& block, uint32_t lane)>;

// Builds `tree` over the primitives, whose order it changes; false when stop was requested.
// progress is told the number of primitives that have reached their leaves.
bool build_tree(std::span<BuildPrimitive> primitives, BuildQuality quality,
                const FillTriangle& fill, WorkerPool* pool, std::stop_token stop,
                const std::function<void(uint64_t)>& progress, Tree& tree);

}  // namespace talbot
