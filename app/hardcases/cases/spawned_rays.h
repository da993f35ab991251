// Rays that leave a hit as Talbot spawns them, and as controls do: does one meet what it left?
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "app/hardcases/cases/case_run.h"
#include "core/integrate/surface_interaction.h"
#include "core/integrate/tiers.h"

namespace talbot::hardcases::geometry {

struct SpawnScore {
    Failures epsilon;  // control: 1e-4 along the new ray
    Failures nothing;  // control: from the hit point
    double offsets = 0, naive_offsets = 0;  // sums, in eps times the largest coordinate
    uint64_t count = 0;

    void merge(const SpawnScore& later) {
        epsilon.merge(later.epsilon);
        nothing.merge(later.nothing);
        offsets += later.offsets;
        naive_offsets += later.naive_offsets;
        count += later.count;
    }
};

// The largest coordinate that enters into a point of the primitive.
inline double coordinate_extent(const Scene& scene, PrimitiveId id) {
    const auto largest = [](const Vec3d& v) { return max_component(glm::abs(v)); };
    if (id.instance == kSphereInstance) {
        const Sphere& sphere = scene.geometry().spheres[id.primitive];
        return largest(sphere.center) + sphere.radius;
    }
    const SceneInstance& placed = scene.geometry().instances[id.instance];
    const Mesh& mesh = scene.geometry().meshes[placed.mesh];
    double extent = 0;
    for (uint32_t k = 0; k < 3; ++k) {
        const Vec3d p(mesh.positions[mesh.indices[size_t{3} * id.primitive + k]]);
        extent = std::max(extent, largest(Vec3d(placed.world_from_object * Vec4d(p, 1))));
        if (placed.identity) continue;
        double reach = 0;
        for (int c = 0; c < 3; ++c)
            reach += largest(Vec3d(placed.world_from_object[c])) * std::abs(p[c]);
        extent = std::max(extent, reach);
    }
    return extent;
}

// Spawns a ray from what `ray` hits, half of the time at a grazing angle, to either side.
inline void spawn(const Scene& scene, const Ray& ray, Rng& rng, SpawnScore& score) {
    Hit hit;
    if (!scene.accel().closest(ray, hit)) return;
    const SurfaceInteraction si = make_surface_interaction<kMatteTier>(scene, ray, hit);
    const Vec3d n(si.n_geometric);
    const Vec3d along = normalize(talbot::cross(n, Vec3d(rng.direction())));
    const double slope = rng.below(2) != 0 ? 1e-3 : rng.uniform();
    const bool outward = rng.below(2) != 0;
    const Vec3f d(normalize(along + (outward ? slope : -slope) * n));
    // Inside a sphere the far side is met rightly.
    if (hit.is_sphere() && !outward) return;
    const auto meets_it = [&](const Ray& r) {
        Hit again;
        return scene.accel().closest(r, again) && again.id == hit.id;
    };
    const Ray next = si.spawn(d);
    Ray bare;
    bare.o = ray.o + hit.t * ray.d;
    bare.d = d;
    const bool own = meets_it(next);
    const bool naive_zero = meets_it(bare);
    bare.o += 1e-4f * d;
    const auto where = [&] { return hex(next) + " after " + hex(ray); };
    score.epsilon.see(meets_it(bare), own, where);
    score.nothing.see(naive_zero, own, where);
    const double unit = 0x1p-24 * coordinate_extent(scene, hit.id);
    score.offsets += length(Vec3d(next.o) - Vec3d(si.p)) / unit;
    score.naive_offsets += 1e-4 / unit;
    ++score.count;
}

}  // namespace talbot::hardcases::geometry
