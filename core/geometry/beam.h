// Rays that run side by side, as those of a few neighbouring pixels do: what none of them can meet
// is found out once for all of them.
#pragma once

#include "core/geometry/bounds.h"
#include "core/geometry/wide_node.h"
#include "core/math/ray.h"

namespace talbot {

// All rays from a point of one box along a vector of the other.
struct Beam {
    Bounds origins;
    Bounds directions;

    void add(const Ray& ray) {
        origins.add(ray.o);
        directions.add(ray.d);
    }
};

// Where the rays of a beam begin in a structure: at a node of parts of its top tree that hold all
// that any of them can meet. Valid for that structure alone.
struct BeamEntry {
    WideNode node;
    bool is_root = true;  // then they begin where all rays do, and the node is not set
};

}  // namespace talbot
