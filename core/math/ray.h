// A ray in the re-centred world, in float, and the primitives that it must not hit again.
#pragma once

#include <cstdint>

#include "core/math/vec.h"

namespace talbot {

inline constexpr uint32_t kNoId = 0xFFFFFFFFu;

// A primitive as the intersector names it: an instance and a triangle in its mesh, or
// kSphereInstance and a sphere.
struct PrimitiveId {
    uint32_t instance = kNoId;
    uint32_t primitive = kNoId;

    bool operator==(const PrimitiveId&) const = default;
};

inline constexpr uint32_t kSphereInstance = 0xFFFFFFFEu;

// Points o + t d with t in (0, t_max). d need not have unit length. Planar primitives named in
// skip_from and skip_to are never reported; a sphere named there is reported only for the hit that
// is not at the origin (skip_from).
struct Ray {
    Vec3f o{0};
    float t_max = kInfinity;
    Vec3f d{0, 0, 1};
    PrimitiveId skip_from{};
    PrimitiveId skip_to{};
};

// What traversal reports. u and v are the barycentric weights of the triangle's second and third
// vertex; zero on spheres.
struct Hit {
    float t = kInfinity;
    float u = 0;
    float v = 0;
    PrimitiveId id{};

    bool is_sphere() const { return id.instance == kSphereInstance; }
};

}  // namespace talbot
