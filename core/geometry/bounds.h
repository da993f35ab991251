// Axis-aligned boxes of points in float.
#pragma once

#include "core/math/vec.h"

namespace talbot {

struct Bounds {
    Vec3f lower{kInfinity};
    Vec3f upper{-kInfinity};

    bool is_empty() const {
        return !(lower.x <= upper.x && lower.y <= upper.y && lower.z <= upper.z);
    }
    void add(const Vec3f& p) {
        lower = glm::min(lower, p);
        upper = glm::max(upper, p);
    }
    // In size; infinite when empty.
    float largest_coordinate() const {
        return max_component(glm::max(glm::abs(lower), glm::abs(upper)));
    }
};

}  // namespace talbot
