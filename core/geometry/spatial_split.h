// Splits by a plane, through primitives: a triangle on both sides is referred to from both, each
// time with the box of its part. Reference: Stich, Friedrich, Dietrich 2009, "Spatial splits in
// bounding volume hierarchies".
#pragma once

#include <cstdint>
#include <span>

#include "core/geometry/bvh_build.h"
#include "core/geometry/split_search.h"

namespace talbot {

struct SpatialSplit {
    double cost = kInfinity;  // as SplitCost::cost
    int axis = 0;
    uint32_t bin = 0;  // the first one of the second part
    uint64_t cut = 0;  // primitives on both sides, at most
};

// The best plane through the range's box; its cost is infinite when there is none. Large ranges are
// read by all workers of the pool, when there is one.
SpatialSplit search_spatial_split(std::span<const BuildPrimitive> primitives,
                                  const LoadTriangle& load, WorkerPool* pool, const Range& range);

// Orders the primitives of a range for a split by its plane: cuts those on both sides, which takes
// free places behind them, at most SpatialSplit::cut. Sets where the two parts are and adds the
// primitives to them; false when one of them stays empty, and then nothing was cut.
bool partition_spatially(std::span<BuildPrimitive> primitives, const LoadTriangle& load,
                         const Range& range, Range& first, Range& second);

// The boxes of what lies on the two sides of a plane of the triangle within `box`, which has at
// least all points of the one that are meant. They hold those points and the hits that rounding
// shifts; empty where there are none.
void cut_triangle(const StoredTriangle& triangle, const Box& box, int axis, float plane, Box& first,
                  Box& second);

}  // namespace talbot
