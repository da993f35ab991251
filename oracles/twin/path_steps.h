// What one path did, in words that the float and the double tracer share.
#pragma once

#include <cstdint>
#include <vector>

#include "core/math/vec.h"

namespace twin {

// One ray and what became of the path at its end.
struct Step {
    bool found = false;     // the ray met a surface
    uint32_t instance = 0;  // which one
    uint32_t primitive = 0;
    bool in_medium = false;  // the path turned before it got there
    bool goes_on = false;    // the path was scattered at the surface
    bool transmitted = false;
    bool delta = false;
    glm::dvec3 p{0};         // the surface's point, re-centred
    glm::dvec3 wi{0};        // where the path went on
    glm::dvec3 radiance{0};  // collected up to here and at this vertex
};

struct Path {
    glm::dvec3 radiance{0};
    std::vector<Step> steps;
};

}  // namespace twin
