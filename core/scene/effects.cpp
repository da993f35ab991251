#include "core/scene/effects.h"

#include <algorithm>

#include "core/geometry/scene_input.h"
#include "core/math/robust.h"
#include "core/scene/effects_fold.h"
#include "core/scene/scene.h"

namespace talbot {
namespace {

// Whether a ray can hit anything of the mesh.
bool has_surface(const Mesh& mesh) {
    const AccelMesh view{mesh.positions, mesh.indices};
    StoredTriangle triangle;
    for (std::size_t i = 0; i < mesh.triangle_count(); ++i) {
        if (load_triangle(view, i, triangle)) return true;
    }
    return false;
}

// Effects of what is placed; returns which materials something that can be hit wears.
std::vector<bool> note_geometry(EffectReport& report, const Scene& scene,
                                const std::vector<Material>& materials) {
    const SceneGeometry& geometry = scene.geometry();
    const bool all_solid = scene.accel().stats().dropped_triangles == 0;
    std::vector<bool> used(materials.size(), false);
    const auto note_alpha = [&](uint32_t index, const Mesh* mesh, const MeshAlpha* alpha) {
        const Material& m = materials[index];
        if (!asks_alpha(scene, m, mesh, alpha)) return;
        report.note(m.alpha_mode == AlphaMode::mask ? Effect::alpha_mask : Effect::alpha_blend,
                    "material '" + m.name + "'");
    };
    for (const SceneInstance& instance : geometry.instances) {
        const Mesh& mesh = geometry.meshes[instance.mesh];
        if (mesh.indices.empty() || !(all_solid || has_surface(mesh))) continue;
        used[instance.material] = true;
        note_alpha(instance.material, &mesh, scene.mesh_alpha(instance.mesh));
        const std::string who = "mesh '" + mesh.name + "'";
        if (!mesh.colors.empty()) report.note(Effect::vertex_color, who);
        if (!instance.identity) report.note(Effect::instancing, who);
    }
    for (const Sphere& sphere : geometry.spheres) {
        used[sphere.material] = true;
        note_alpha(sphere.material, nullptr, nullptr);
        report.note(Effect::analytic_spheres,
                    "object '" + geometry.objects[sphere.object].name + "'");
    }
    return used;
}

void note_environment(EffectReport& report, const Environment& environment) {
    if (!(environment.intensity > 0)) return;
    const std::shared_ptr<const EnvironmentImage>& image = environment.image;
    if (image) {
        if (std::all_of(image->texels.begin(), image->texels.end(),
                        [](const Rgb& texel) { return is_black(texel); }))
            return;
        report.note(Effect::environment_image, "image '" + image->file + "'");
    } else if (environment.gradient
                   ? is_black(environment.gradient->from + environment.gradient->to)
                   : is_black(environment.color)) {
        return;
    }
    report.note(Effect::environment, "the scene's environment");
}

}  // namespace

std::optional<Effect> effect_from_name(std::string_view name) {
    for (const EffectInfo& info : kEffects) {
        if (info.name == name) return info.effect;
    }
    return std::nullopt;
}

EffectReport analyse_effects(const Scene& given, const Camera& camera) {
    std::vector<Material> materials = fold_materials(given);
    if (materials.empty()) materials = given.materials();
    EffectReport report;
    const std::vector<bool> used = note_geometry(report, given, materials);
    std::size_t sources = 0;
    for (std::size_t i = 0; i < used.size(); ++i) {
        if (!used[i]) continue;
        const Material& material = materials[i];
        const std::string who = "material '" + material.name + "'";
        note_material(report, material, who);
        if (material.is_emissive() && !material.unlit) {
            report.note(Effect::emissive_meshes, who);
            ++sources;
        }
    }
    for (const PunctualLight& light : given.punctual_lights()) {
        if (!light.shines()) continue;
        report.note(Effect::punctual_lights, "light '" + light.name + "'");
        ++sources;
    }
    if (sources > 1)
        report.note(Effect::many_lights, std::to_string(sources) + " sources of light");
    note_environment(report, given.environment());
    if (camera.kind == CameraKind::perspective && camera.aperture_radius > 0 &&
        camera.focus_distance > 0) {
        report.note(Effect::depth_of_field, "camera '" + camera.name + "'");
    }
    if (given.motion()) report.note(Effect::motion, given.motion()->witness);
    return report;
}

}  // namespace talbot
