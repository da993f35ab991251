// The boxes of a structure at one level of its trees: for debug views.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/geometry/accel.h"

namespace talbot {

struct TreeBox {
    // In re-centred world coordinates. Bit i of the index: the upper end along axis i of the space
    // that the box is upright in, which is the object's for boxes inside an instance.
    std::array<Vec3d, 8> corners;
    bool is_leaf = false;  // nothing is below it: triangles or a sphere
};

struct TreeBoxes {
    std::vector<TreeBox> boxes;
    bool is_cut = false;  // there are more than the caller wanted
};

// The boxes that are `level` levels below the root, and the leaves above them: together they hold
// all that can be hit. An instance's or sphere's own box is one level below the leaf that lists it.
// Where a level has more than `most` boxes its largest are kept and followed. Nothing for a
// structure that has no boxes.
TreeBoxes tree_boxes(const Accel& accel, uint32_t level, size_t most);

}  // namespace talbot
