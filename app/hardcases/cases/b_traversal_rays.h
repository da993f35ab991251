// Rays for the rows about builds: at vertices and edges of a closed fan, and a soup of triangles.
#pragma once

#include <memory>
#include <vector>

#include "app/hardcases/worst.h"
#include "core/geometry/accel.h"

namespace talbot::hardcases {

// Eight triangles round an apex, closed by their rim, far from the origin by `offset`.
struct Fan {
    std::vector<Vec3f> positions;
    std::vector<uint32_t> indices;

    explicit Fan(float offset, Draw& draw);
    std::unique_ptr<const Accel> build(WorkerPool& pool) const;
    // A ray from above whose direction is that of a point on an inner edge, rounded.
    Ray edge_ray(Draw& draw) const;
};

inline Fan::Fan(float offset, Draw& draw) {
    constexpr uint32_t kRim = 8;
    const Vec3f middle(offset, 0.37f * offset, -0.71f * offset);
    const auto jitter = [&] { return static_cast<float>(draw.between(-0.05, 0.05)); };
    positions.push_back(middle + Vec3f(jitter(), jitter(), jitter()));
    for (uint32_t i = 0; i < kRim; ++i) {
        const double angle = 2 * 3.141592653589793 * i / kRim;
        positions.push_back(middle + Vec3f(static_cast<float>(std::cos(angle)),
                                           static_cast<float>(std::sin(angle)), jitter()));
        indices.insert(indices.end(), {0, i + 1, (i + 1) % kRim + 1});
    }
}

inline std::unique_ptr<const Accel> Fan::build(WorkerPool& pool) const {
    AccelInput input;
    input.meshes.push_back({positions, indices});
    input.instances.push_back({});
    return build_accel(input, pool);
}

inline Ray Fan::edge_ray(Draw& draw) const {
    const auto share = static_cast<float>(draw.unit() < 0.5 ? 0.0 : draw.between(0, 0.95));
    const Vec3f target = positions[0] + share * (positions[1 + draw.bits() % 8] - positions[0]);
    Ray ray;
    ray.o = positions[0] + Vec3f(static_cast<float>(draw.between(-1, 1)),
                                 static_cast<float>(draw.between(-1, 1)),
                                 static_cast<float>(draw.between(1, 3)));
    ray.d = target - ray.o;
    return ray;
}

}  // namespace talbot::hardcases
