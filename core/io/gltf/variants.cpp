// KHR_materials_variants: named sets of materials.
#include "core/io/gltf/materials.h"
#include "core/io/gltf/values.h"

namespace talbot::gltf {

namespace {

constexpr const char* kVariants = "KHR_materials_variants";

// The array `key` of an object; null when there is none.
const tinygltf::Value* array_member(const tinygltf::Value* object, const char* key) {
    const tinygltf::Value* found = object ? member(*object, key) : nullptr;
    return found && found->IsArray() ? found : nullptr;
}

bool lists(const tinygltf::Value& mapping, uint32_t variant) {
    const tinygltf::Value* variants = array_member(&mapping, "variants");
    for (size_t i = 0; variants && i < variants->ArrayLen(); ++i) {
        const tinygltf::Value& v = variants->Get(static_cast<int>(i));
        if (v.IsInt() && v.GetNumberAsInt() == static_cast<int>(variant)) return true;
    }
    return false;
}

}  // namespace

std::vector<std::string> variant_names(const Document& document) {
    std::vector<std::string> names;
    const tinygltf::Value* extension = find_extension_value(document.model.extensions, kVariants);
    const tinygltf::Value* variants = array_member(extension, "variants");
    for (size_t i = 0; variants && i < variants->ArrayLen(); ++i) {
        const tinygltf::Value* name = member(variants->Get(static_cast<int>(i)), "name");
        names.push_back(name && name->IsString() ? name->Get<std::string>()
                                                 : "variant " + std::to_string(i));
    }
    return names;
}

Result<std::optional<uint32_t>> choose_variant(const Loading& loading) {
    const std::string& wanted = loading.options.variant;
    if (wanted.empty()) return std::optional<uint32_t>();
    const std::vector<std::string> names = variant_names(loading.document);
    std::string known;
    for (uint32_t i = 0; i < names.size(); ++i) {
        if (names[i] == wanted) return std::optional<uint32_t>(i);
        known += (i ? ", '" : "'") + names[i] + "'";
    }
    return Error{
        ErrorKind::usage, loading.document.file.string(), "--variant",
        "there is no variant '" + wanted + "'; the file has " + (known.empty() ? "none" : known)};
}

uint32_t material_of(const tinygltf::Primitive& primitive, std::optional<uint32_t> variant) {
    const auto own = static_cast<uint32_t>(primitive.material + 1);
    if (!variant) return own;
    const tinygltf::Value* mappings =
        array_member(find_extension_value(primitive.extensions, kVariants), "mappings");
    for (size_t i = 0; mappings && i < mappings->ArrayLen(); ++i) {
        const tinygltf::Value& mapping = mappings->Get(static_cast<int>(i));
        const std::optional<uint32_t> material = index_member(mapping, "material");
        if (material && lists(mapping, *variant)) return *material + 1;
    }
    return own;
}

}  // namespace talbot::gltf
