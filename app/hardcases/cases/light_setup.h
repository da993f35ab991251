// Scenes of one lamp, as light sampling sees them.
#pragma once

#include "app/hardcases/cases/shading_setup.h"
#include "core/lights/light_table.h"
#include "core/lights/surface_light.h"

namespace talbot::hardcases {

inline Material lamp_material(bool two_sided = false) {
    Material m = SceneBuilder::diffuse(0);
    m.emissive_factor = Rgb(1);
    m.double_sided = two_sided;
    return m;
}

// The lamps of a scene and the place of its origin.
struct LampScene {
    std::shared_ptr<const Scene> scene;
    LightTable lights;

    LampScene(const SceneBuilder& builder, WorkerPool& pool)
        : scene(builder.build(pool)), lights(*scene) {}

    const Light& light(std::size_t i) const { return lights.lights()[i]; }
    Vec3f local(const Vec3d& world) const { return Vec3f(world - scene->origin()); }
};

// The middle of cell (i, j) of a grid over the unit square.
inline Vec2f grid_point(int i, int j, int steps) {
    const auto at = [steps](int k) {
        return static_cast<float>((k + 0.5) / static_cast<double>(steps));
    };
    return {at(i), at(j)};
}

}  // namespace talbot::hardcases
