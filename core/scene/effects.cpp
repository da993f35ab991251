#include "core/scene/effects.h"

#include "core/math/robust.h"
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

// Lobes of the extensions: each with its textures, none where its factor is zero.
void note_layers(EffectReport& report, const Material& m, const std::string& who) {
    if (m.diffuse_transmission_factor > 0 && m.metallic_factor < 1) {
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
    const bool reflects = m.metallic_factor > 0 || m.specular_factor > 0;
    if (m.anisotropy_strength > 0 && reflects) {
        report.note(Effect::anisotropy, who);
        note_slot(report, Effect::anisotropy, m.anisotropy_texture, who);
    }
    if (m.iridescence_factor > 0 && reflects) {
        report.note(Effect::iridescence, who);
        note_slot(report, Effect::iridescence, m.iridescence_texture, who);
        note_slot(report, Effect::iridescence, m.iridescence_thickness_texture, who);
    }
}

void note_material(EffectReport& report, const Material& material, const std::string& who) {
    if (!material.double_sided && !material.is_volume()) report.note(Effect::single_sided, who);
    if (material.alpha_mode != AlphaMode::opaque) {
        const bool can_be_clear =
            material.base_color_texture.used() || material.base_color_factor.w < 1;
        if (can_be_clear) {
            report.note(
                material.alpha_mode == AlphaMode::mask ? Effect::alpha_mask : Effect::alpha_blend,
                who);
        }
    }
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
    if (material.transmission_factor > 0) {
        report.note(Effect::transmission, who);
        note_slot(report, Effect::transmission, material.transmission_texture, who);
        if (!(material.thickness_factor > 0)) {
            report.note(Effect::thin_wall, who);
        } else if (material.dispersion > 0 && material.ior > 1) {
            report.note(Effect::dispersion, who);
        }
    }
    if (material.is_volume() && is_finite(material.attenuation_distance) &&
        material.attenuation_color != Rgb(1)) {
        report.note(Effect::volume_absorption, who);
    }
    if (material.scatters()) report.note(Effect::scattering_medium, who);
    note_layers(report, material, who);
}

}  // namespace

std::optional<Effect> effect_from_name(std::string_view name) {
    for (const EffectInfo& info : kEffects) {
        if (info.name == name) return info.effect;
    }
    return std::nullopt;
}

EffectReport analyse_effects(const Scene& scene, const Camera& camera) {
    EffectReport report;
    const SceneGeometry& geometry = scene.geometry();
    std::vector<bool> used(scene.materials().size(), false);
    uint64_t emitters = 0;
    for (const SceneInstance& instance : geometry.instances) {
        const Mesh& mesh = geometry.meshes[instance.mesh];
        used[instance.material] = true;
        if (!mesh.colors.empty()) report.note(Effect::vertex_color, "mesh '" + mesh.name + "'");
        if (!instance.identity) report.note(Effect::instancing, "mesh '" + mesh.name + "'");
        if (scene.materials()[instance.material].is_emissive()) emitters += mesh.triangle_count();
    }
    for (const Sphere& sphere : geometry.spheres) {
        used[sphere.material] = true;
        report.note(Effect::analytic_spheres,
                    "object '" + geometry.objects[sphere.object].name + "'");
        if (scene.materials()[sphere.material].is_emissive()) ++emitters;
    }
    for (std::size_t i = 0; i < used.size(); ++i) {
        if (!used[i]) continue;
        const Material& material = scene.materials()[i];
        const std::string who = "material '" + material.name + "'";
        note_material(report, material, who);
        if (material.is_emissive() && !material.unlit) report.note(Effect::emissive_meshes, who);
    }
    for (const PunctualLight& light : scene.punctual_lights()) {
        if (!(light.intensity > 0) || is_black(light.color)) continue;
        report.note(Effect::punctual_lights, "light '" + light.name + "'");
        ++emitters;
    }
    if (emitters > 1) report.note(Effect::many_lights, std::to_string(emitters) + " emitters");
    const Environment& environment = scene.environment();
    if (environment.intensity > 0) {
        if (environment.image)
            report.note(Effect::environment_image, "image '" + environment.image->file + "'");
        if (environment.image || environment.gradient || !is_black(environment.color)) {
            report.note(Effect::environment, "the scene's environment");
        }
    }
    if (camera.kind == CameraKind::perspective && camera.aperture_radius > 0 &&
        camera.focus_distance > 0) {
        report.note(Effect::depth_of_field, "camera '" + camera.name + "'");
    }
    return report;
}

}  // namespace talbot
