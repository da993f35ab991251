// Builds one wide tree over boxes by binned surface area heuristic; in high quality also with cuts
// through triangles.
#pragma once

#include <cstdint>
#include <functional>
#include <stop_token>

#include "core/base/worker_pool.h"
#include "core/geometry/bvh.h"
#include "core/geometry/scene_input.h"

namespace talbot {

// A primitive's box. `index` is a triangle's number in its tree; or, where `instance` is
// kObjectPrimitive, an object's.
struct alignas(32) BuildPrimitive {
    Vec3f lower;
    uint32_t instance;
    Vec3f upper;
    uint32_t index;
};

inline constexpr uint32_t kObjectPrimitive = 0xFFFFFFFDu;

// The triangle behind a primitive.
using LoadTriangle = std::function<StoredTriangle(const BuildPrimitive& primitive)>;

// A high-quality tree refers to at most this many times as many triangles as there are.
inline constexpr double kMostReferences = 1.3;

// Places for so many primitives and for the parts of cut ones.
inline uint64_t places_for(uint64_t primitives, BuildQuality quality) {
    return quality == BuildQuality::high
               ? static_cast<uint64_t>(kMostReferences * static_cast<double>(primitives))
               : primitives;
}

// Builds `tree` over the primitives, which it uses up: what is left in the vector means nothing.
// False when stop was requested. progress is told the number of primitives that have reached
// their leaves.
bool build_tree(HugePageVector<BuildPrimitive>& primitives, BuildQuality quality,
                const LoadTriangle& load, WorkerPool* pool, std::stop_token stop,
                const std::function<void(uint64_t)>& progress, Tree& tree);

}  // namespace talbot
