#include <algorithm>

#include "core/math/robust.h"
#include "core/scene/effects.h"
#include "core/scene/material.h"

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

}  // namespace

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

}  // namespace talbot
