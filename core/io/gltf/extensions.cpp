// The table of glTF extensions (Khronos registry, extensions/README).
#include "core/io/gltf/extensions.h"

#include <algorithm>
#include <array>

namespace talbot::gltf {

namespace {

using enum ExtensionSupport;

constexpr auto kTable = std::to_array<ExtensionInfo>({
    {"EXT_mesh_gpu_instancing", supported, ""},
    {"EXT_meshopt_compression", supported, ""},
    {"EXT_texture_webp", supported, ""},
    {"KHR_animation_pointer", supported, ""},
    {"KHR_draco_mesh_compression", supported, ""},
    {"KHR_implicit_shapes", supported, ""},
    {"KHR_lights_punctual", supported, ""},
    {"KHR_materials_anisotropy", supported, ""},
    {"KHR_materials_clearcoat", supported, ""},
    {"KHR_materials_diffuse_transmission", supported, ""},
    {"KHR_materials_dispersion", supported, ""},
    {"KHR_materials_emissive_strength", supported, ""},
    {"KHR_materials_ior", supported, ""},
    {"KHR_materials_iridescence", supported, ""},
    {"KHR_materials_sheen", supported, ""},
    {"KHR_materials_pbrSpecularGlossiness", supported, ""},
    {"KHR_materials_specular", supported, ""},
    {"KHR_materials_transmission", supported, ""},
    {"KHR_materials_unlit", supported, ""},
    {"KHR_materials_variants", supported, ""},
    {"KHR_materials_volume", supported, ""},
    {"KHR_materials_volume_scatter", supported, ""},
    {"KHR_mesh_quantization", supported, ""},
    {"KHR_node_visibility", supported, ""},
    {"KHR_texture_basisu", supported, ""},
    {"KHR_texture_transform", supported, ""},
    {"TALBOT_implicit_surface", supported, ""},
    {"KHR_xmp", ignorable, ""},
    {"KHR_xmp_json_ld", ignorable, ""},
});

}  // namespace

std::span<const ExtensionInfo> extension_table() {
    return kTable;
}

const ExtensionInfo* find_extension(std::string_view name) {
    const auto found = std::find_if(kTable.begin(), kTable.end(),
                                    [&](const ExtensionInfo& info) { return info.name == name; });
    return found == kTable.end() ? nullptr : &*found;
}

Status check_required(const std::vector<std::string>& required) {
    for (const std::string& name : required) {
        const ExtensionInfo* info = find_extension(name);
        if (info && info->support != unsupported) continue;
        return Error{
            ErrorKind::bad_input, "", "extensionsRequired",
            "the scene requires the extension " + name.substr(0, 100) + ", which is not supported"};
    }
    return Done{};
}

void note_extensions(const std::vector<std::string>& used, const std::vector<std::string>& required,
                     SceneDesc& desc) {
    const auto contains = [](const std::vector<std::string>& names, const std::string& name) {
        return std::find(names.begin(), names.end(), name) != names.end();
    };
    std::vector<std::string> names = used;
    for (const std::string& name : required) {
        if (!contains(names, name)) names.push_back(name);
    }
    for (const std::string& name : names) {
        const ExtensionInfo* info = find_extension(name);
        const bool known = info && info->support != unsupported;
        desc.extensions.push_back({name, contains(required, name), known});
        if (known) continue;
        const std::string loss = info ? ": " + std::string(info->loss) : "";
        desc.warnings.push_back("extension " + name + " is not supported" + loss);
    }
}

}  // namespace talbot::gltf
