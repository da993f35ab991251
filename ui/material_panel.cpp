// The open material.
#include <imgui.h>

#include "ui/panels.h"
#include "ui/parameter_widgets.h"

namespace talbot {
namespace {

struct SlotRow {
    const char* name;
    TextureSlot Material::*slot;
};
constexpr SlotRow kSlots[] = {
    {"baseColorTexture", &Material::base_color_texture},
    {"metallicRoughnessTexture", &Material::metallic_roughness_texture},
    {"normalTexture", &Material::normal_texture},
    {"emissiveTexture", &Material::emissive_texture},
    {"specularTexture", &Material::specular_texture},
    {"specularColorTexture", &Material::specular_color_texture},
    {"transmissionTexture", &Material::transmission_texture},
    {"diffuseTransmissionTexture", &Material::diffuse_transmission_texture},
    {"diffuseTransmissionColorTexture", &Material::diffuse_transmission_color_texture},
    {"clearcoatTexture", &Material::clearcoat_texture},
    {"clearcoatRoughnessTexture", &Material::clearcoat_roughness_texture},
    {"clearcoatNormalTexture", &Material::clearcoat_normal_texture},
    {"sheenColorTexture", &Material::sheen_color_texture},
    {"sheenRoughnessTexture", &Material::sheen_roughness_texture},
    {"anisotropyTexture", &Material::anisotropy_texture},
    {"iridescenceTexture", &Material::iridescence_texture},
    {"iridescenceThicknessTexture", &Material::iridescence_thickness_texture},
};

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
        if (name == "alpha_cutoff" && material.alpha_mode != AlphaMode::mask) continue;
        if (name == "normal_scale" && !material.normal_texture.used()) continue;
        changed |= edit_parameter(parameter, material);
    }
    ImGui::PopID();
    bool textured = false;
    for (const SlotRow& row : kSlots) textured |= (material.*row.slot).used();
    if (textured) {
        ImGui::Spacing();
        ImGui::Separator();
        for (const SlotRow& row : kSlots) draw_texture(model, row.name, material.*row.slot);
    }
    return changed;
}

}  // namespace talbot
