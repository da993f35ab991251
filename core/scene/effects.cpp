#include "core/scene/effects.h"

#include <algorithm>

#include "core/geometry/scene_input.h"
#include "core/math/robust.h"
#include "core/scene/effects_fold.h"
#include "core/scene/scene.h"

namespace talbot {
namespace {

void note_slot(EffectReport& report, Effect effect, const TextureSlot& slot,
               const std::string& who) {
    if (!slot.used()) return;
    report.note(effect, who);
    if (slot.uv_set != 0) report.note(Effect::second_uv, who);
    if (slot.has_transform) report.note(Effect::uv_transform, who);
}

// Whether the material is more than Lambert: then its specular lobes exist, of weight zero or not.
bool has_lobes(const Material& m) {
    return m.metallic_factor > 0 || m.specular_factor > 0 || m.transmission_factor > 0 ||
           m.diffuse_transmission_factor > 0 || m.clearcoat_factor > 0 || m.has_sheen();
}

// Metal lets nothing through.
bool is_all_metal(const Material& m) {
    return m.metallic_factor >= 1 && !m.metallic_roughness_texture.used();
}

// Lobes of the extensions: each with its textures, none where its factor is zero.
void note_layers(EffectReport& report, const Material& m, const std::string& who) {
    if (m.diffuse_transmission_factor > 0 && !is_all_metal(m)) {
        report.note(Effect::diffuse_transmission, who);
        note_slot(report, Effect::diffuse_transmission, m.diffuse_transmission_texture, who);
        note_slot(report, Effect::diffuse_transmission, m.diffuse_transmission_color_texture, who);
    }
    if (m.clearcoat_factor > 0) {
        report.note(Effect::clearcoat, who);
        note_slot(report, Effect::clearcoat, m.clearcoat_texture, who);
        note_slot(report, Effect::clearcoat, m.clearcoat_roughness_texture, who);
        note_slot(report, Effect::clearcoat, m.clearcoat_normal_texture, who);
    }
    if (m.has_sheen()) {
        report.note(Effect::sheen, who);
        note_slot(report, Effect::sheen, m.sheen_color_texture, who);
        note_slot(report, Effect::sheen, m.sheen_roughness_texture, who);
    }
    if (m.anisotropy_strength > 0 && has_lobes(m)) {
        report.note(Effect::anisotropy, who);
        note_slot(report, Effect::anisotropy, m.anisotropy_texture, who);
    }
    const float thickest =
        std::max(m.iridescence_thickness_minimum, m.iridescence_thickness_maximum);
    if (m.iridescence_factor > 0 && thickest > 0 && has_lobes(m)) {
        report.note(Effect::iridescence, who);
        note_slot(report, Effect::iridescence, m.iridescence_texture, who);
        note_slot(report, Effect::iridescence, m.iridescence_thickness_texture, who);
    }
}

void note_material(EffectReport& report, const Material& material, const std::string& who) {
    if (!material.double_sided && !material.is_volume()) report.note(Effect::single_sided, who);
    note_slot(report, Effect::base_color_texture, material.base_color_texture, who);
    if (material.is_emissive())
        note_slot(report, Effect::emissive_texture, material.emissive_texture, who);
    if (material.unlit) {
        report.note(Effect::unlit, who);
        return;
    }
    if (material.normal_scale != 0)
        note_slot(report, Effect::normal_map, material.normal_texture, who);
    if (material.metallic_factor > 0 || material.specular_factor > 0) {
        report.note(Effect::glossy, who);
        note_slot(report, Effect::metallic_roughness_texture, material.metallic_roughness_texture,
                  who);
    }
    const bool white =
        material.specular_color_factor == Rgb(1) && !material.specular_color_texture.used();
    const bool full = material.specular_factor == 1 && !material.specular_texture.used();
    if (!(white && full) && material.specular_factor > 0) {
        report.note(Effect::specular, who);
        note_slot(report, Effect::specular, material.specular_texture, who);
        note_slot(report, Effect::specular, material.specular_color_texture, who);
    }
    if (material.transmission_factor > 0 && !is_all_metal(material)) {
        report.note(Effect::transmission, who);
        note_slot(report, Effect::transmission, material.transmission_texture, who);
        if (!(material.thickness_factor > 0)) {
            report.note(Effect::thin_wall, who);
        } else if (material.dispersion > 0 && material.ior > 1) {
            report.note(Effect::dispersion, who);
        }
    }
    if (material.is_volume() && !is_all_metal(material) &&
        is_finite(material.attenuation_distance) && material.attenuation_color != Rgb(1)) {
        report.note(Effect::volume_absorption, who);
    }
    if (material.scatters()) report.note(Effect::scattering_medium, who);
    note_layers(report, material, who);
}

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

EffectSet material_effects(const Material& material) {
    EffectReport report;
    note_material(report, material, {});
    // Its textures have no effect of their own; texture coordinates come with those of base colour.
    if (report.active.has(Effect::specular) &&
        (material.specular_texture.used() || material.specular_color_texture.used()))
        report.active.add(Effect::base_color_texture);
    // The inside of a body is told from its outside, and one body from another, by the code of
    // transmission, be it all metal.
    if (material.thickness_factor > 0) report.active.add(Effect::transmission);
    return report.active;
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
    return report;
}

}  // namespace talbot
