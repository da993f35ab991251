// The open material.
#include <imgui.h>

#include <algorithm>
#include <array>

#include "ui/material_textures.h"
#include "ui/panels.h"
#include "ui/parameter_widgets.h"

namespace talbot {
namespace {

void draw_texture(const ViewerModel& model, const char* name, const TextureSlot& slot) {
    if (!slot.used() || !model.scene || slot.texture >= model.scene->textures().size()) return;
    const Texture& texture = model.scene->textures()[slot.texture];
    ImGui::TextUnformatted(name);
    ImGui::Indent();
    const std::string& file = texture.image ? texture.image->name : std::string();
    ImGui::PushStyleColor(ImGuiCol_Text, ImGui::GetStyleColorVec4(ImGuiCol_TextDisabled));
    ImGui::TextWrapped(
        "%s", file.empty() ? ("texture " + std::to_string(slot.texture)).c_str() : file.c_str());
    if (texture.image) {
        ImGui::Text("%u \xC3\x97 %u px, UV %d%s", texture.image->width, texture.image->height,
                    int{slot.uv_set}, slot.has_transform ? ", transformed" : "");
    }
    ImGui::PopStyleColor();
    ImGui::Unindent();
}

// Parameters that belong to one extension, and whether the material uses it.
struct Group {
    const char* title;
    const char* extension;
    std::array<std::string_view, 6> names;
    bool (*is_used)(const Material&);
};
constexpr Group kGroups[] = {
    {"Emission",
     "KHR_materials_emissive_strength",
     {"emissive_factor", "emissive_strength"},
     [](const Material& m) { return m.is_emissive(); }},
    {"Specular",
     "KHR_materials_specular, KHR_materials_ior",
     {"ior", "specular_factor", "specular_color_factor"},
     [](const Material& m) {
         return m.ior != 1.5f || m.specular_factor != 1 || m.specular_color_factor != Rgb(1);
     }},
    {"Transmission",
     "KHR_materials_transmission, KHR_materials_dispersion",
     {"transmission_factor", "dispersion"},
     [](const Material& m) { return m.transmission_factor > 0; }},
    {"Volume",
     "KHR_materials_volume",
     {"thickness_factor", "attenuation_color", "attenuation_distance", "multiscatter_color",
      "scatter_anisotropy", "nested_priority"},
     [](const Material& m) { return m.thickness_factor > 0; }},
    {"Diffuse transmission",
     "KHR_materials_diffuse_transmission",
     {"diffuse_transmission_factor", "diffuse_transmission_color_factor"},
     [](const Material& m) { return m.diffuse_transmission_factor > 0; }},
    {"Clearcoat",
     "KHR_materials_clearcoat",
     {"clearcoat_factor", "clearcoat_roughness_factor", "clearcoat_normal_scale"},
     [](const Material& m) { return m.clearcoat_factor > 0; }},
    {"Sheen",
     "KHR_materials_sheen",
     {"sheen_color_factor", "sheen_roughness_factor"},
     [](const Material& m) { return m.has_sheen(); }},
    {"Anisotropy",
     "KHR_materials_anisotropy",
     {"anisotropy_strength", "anisotropy_rotation"},
     [](const Material& m) { return m.anisotropy_strength > 0; }},
    {"Iridescence",
     "KHR_materials_iridescence",
     {"iridescence_factor", "iridescence_ior", "iridescence_thickness_minimum",
      "iridescence_thickness_maximum"},
     [](const Material& m) { return m.iridescence_factor > 0; }},
};

bool is_grouped(std::string_view name) {
    return std::any_of(std::begin(kGroups), std::end(kGroups), [&](const Group& group) {
        return std::find(group.names.begin(), group.names.end(), name) != group.names.end();
    });
}

// Whether a parameter can change anything.
bool applies(const Material& material, std::string_view name) {
    if (name == "alpha_cutoff") return material.alpha_mode == AlphaMode::mask;
    if (name == "normal_scale") return material.normal_texture.used();
    if (name == "clearcoat_normal_scale") return material.clearcoat_normal_texture.used();
    if (name == "iridescence_thickness_minimum")
        return material.iridescence_thickness_texture.used();
    return true;
}

bool draw_group(const Group& group, Material& material) {
    ImGui::SetNextItemOpen(group.is_used(material), ImGuiCond_Once);
    const bool open = ImGui::TreeNodeEx(group.title, ImGuiTreeNodeFlags_SpanAvailWidth);
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", group.extension);
    if (!open) return false;
    ImGui::Unindent();
    bool changed = false;
    for (const std::string_view name : group.names) {
        if (!name.empty() && applies(material, name))
            changed |= edit_named(material_parameters(), name, material);
    }
    ImGui::Indent();
    ImGui::TreePop();
    return changed;
}

void draw_material_list(ViewerModel& model) {
    begin_row("Material");
    if (!ImGui::BeginCombo("##material", model.material_name(model.material).c_str())) return;
    for (uint32_t i = 0; i < model.materials.size(); ++i) {
        ImGui::PushID(static_cast<int>(i));
        if (ImGui::Selectable(model.material_name(i).c_str(), i == model.material))
            model.material = i;
        ImGui::PopID();
    }
    ImGui::EndCombo();
}

}  // namespace

bool draw_material_panel(ViewerModel& model) {
    if (model.material >= model.materials.size()) {
        ImGui::TextDisabled("No material.");
        return false;
    }
    draw_material_list(model);
    if (model.selected_object && model.scene &&
        *model.selected_object < model.scene->objects().size()) {
        const std::string& name = model.scene->objects()[*model.selected_object].name;
        text_row("Object", "%s", name.empty() ? "(unnamed)" : name.c_str());
    } else {
        ImGui::TextDisabled("Click the image to pick an object.");
    }
    Material& material = model.materials[model.material];
    bool changed = false;
    ImGui::PushID(static_cast<int>(model.material));
    for (const Parameter<Material>& parameter : material_parameters()) {
        const std::string_view name = parameter.info.name;
        if (!is_grouped(name) && applies(material, name))
            changed |= edit_parameter(parameter, material);
    }
    for (const Group& group : kGroups) changed |= draw_group(group, material);
    ImGui::PopID();
    bool textured = false;
    for (const MaterialTexture& row : kMaterialTextures) textured |= (material.*row.slot).used();
    if (textured) {
        ImGui::Spacing();
        ImGui::Separator();
        for (const MaterialTexture& row : kMaterialTextures)
            draw_texture(model, row.name, material.*row.slot);
    }
    return changed;
}

}  // namespace talbot
