// glTF materials to Material: core metallic-roughness and the ratified extensions that the renderer
// knows.
#include "core/io/gltf/materials.h"

#include <algorithm>

#include "core/io/gltf/images.h"
#include "core/io/gltf/values.h"
#include "core/math/robust.h"

namespace talbot::gltf {

namespace {

constexpr int kMaxUvSet = 64;

// One texture reference of the file, wherever it stands.
struct TextureReference {
    int index = -1;
    int uv_set = 0;
    const tinygltf::ExtensionMap* extensions = nullptr;  // of a typed reference
    const tinygltf::Value* value = nullptr;              // of one within an extension
};

class MaterialConverter {
  public:
    MaterialConverter(Loading& loading, MaterialTables& tables)
        : loading_(loading),
          tables_(tables),
          texture_map_(loading.document.model.textures.size(), kNoTexture) {}

    Material convert(const tinygltf::Material& in, size_t index, bool used) {
        element_ = element_name("materials", index);
        used_ = used;
        uv_sets_ = {0, 1};
        uv_set_taken_ = {false, false};
        Material out;
        out.name = in.name.empty() ? "material " + std::to_string(index) : in.name;
        convert_core(in, out);
        convert_extensions(in, out);
        tables_.uv_sets.push_back(uv_sets_);
        return out;
    }

  private:
    void warn(const std::string& what) { loading_.warn(element_, what); }

    void convert_core(const tinygltf::Material& in, Material& out) {
        const tinygltf::PbrMetallicRoughness& pbr = in.pbrMetallicRoughness;
        for (size_t i = 0; i < 4; ++i)
            out.base_color_factor[static_cast<int>(i)] = limited(pbr.baseColorFactor[i], 0, 1);
        out.base_color_texture = slot(pbr.baseColorTexture);
        out.metallic_factor = limited(pbr.metallicFactor, 0, 1);
        out.roughness_factor = limited(pbr.roughnessFactor, 0, 1);
        out.metallic_roughness_texture = slot(pbr.metallicRoughnessTexture);
        out.normal_texture = slot(in.normalTexture);
        out.normal_scale = limited(in.normalTexture.scale, -kLargestFactor, kLargestFactor);
        out.emissive_factor = color_of(in.emissiveFactor.data(), kLargestFactor);
        out.emissive_texture = slot(in.emissiveTexture);
        out.alpha_cutoff = limited(in.alphaCutoff, 0, kLargestFactor);
        out.double_sided = in.doubleSided;
        out.nested_priority =
            limited(number_member(in.extras, "nestedPriority", 0), -kLargestFactor, kLargestFactor);
        if (in.alphaMode == "MASK") out.alpha_mode = AlphaMode::mask;
        if (in.alphaMode == "BLEND") out.alpha_mode = AlphaMode::blend;
        if (in.alphaMode != "MASK" && in.alphaMode != "BLEND" && in.alphaMode != "OPAQUE") {
            warn("alphaMode '" + in.alphaMode.substr(0, 40) + "' is unknown; taken as OPAQUE");
        }
    }

    void convert_extensions(const tinygltf::Material& in, Material& out) {
        const auto extension = [&](const char* name) {
            return find_extension_value(in.extensions, name);
        };
        if (const auto* e = extension("KHR_materials_emissive_strength")) {
            out.emissive_strength =
                limited(number_member(*e, "emissiveStrength", 1), 0, kLargestFactor);
        }
        out.unlit = extension("KHR_materials_unlit") != nullptr;
        if (const auto* e = extension("KHR_materials_ior"))
            out.ior = valid_ior(number_member(*e, "ior", 1.5));
        if (const auto* e = extension("KHR_materials_specular")) {
            out.specular_factor = limited(number_member(*e, "specularFactor", 1), 0, 1);
            out.specular_texture = slot(*e, "specularTexture");
            double color[3] = {1, 1, 1};
            numbers_member(*e, "specularColorFactor", 3, color);
            out.specular_color_factor = color_of(color, kLargestFactor);
            out.specular_color_texture = slot(*e, "specularColorTexture");
        }
        if (const auto* e = extension("KHR_materials_transmission")) {
            out.transmission_factor = limited(number_member(*e, "transmissionFactor", 0), 0, 1);
            out.transmission_texture = slot(*e, "transmissionTexture");
        }
        if (const auto* e = extension("KHR_materials_volume")) convert_volume(*e, out);
        if (const auto* e = extension("KHR_materials_volume_scatter")) convert_scatter(*e, out);
        if (const auto* e = extension("KHR_materials_dispersion"))
            out.dispersion = limited(number_member(*e, "dispersion", 0), 0, kLargestFactor);
        if (const auto* e = extension("KHR_materials_diffuse_transmission"))
            convert_diffuse_transmission(*e, out);
        if (const auto* e = extension("KHR_materials_clearcoat")) convert_clearcoat(*e, out);
        if (const auto* e = extension("KHR_materials_sheen")) convert_sheen(*e, out);
        if (const auto* e = extension("KHR_materials_anisotropy")) convert_anisotropy(*e, out);
        if (const auto* e = extension("KHR_materials_iridescence")) convert_iridescence(*e, out);
    }

    void convert_diffuse_transmission(const tinygltf::Value& in, Material& out) {
        out.diffuse_transmission_factor =
            limited(number_member(in, "diffuseTransmissionFactor", 0), 0, 1);
        out.diffuse_transmission_texture = slot(in, "diffuseTransmissionTexture");
        double color[3] = {1, 1, 1};
        numbers_member(in, "diffuseTransmissionColorFactor", 3, color);
        out.diffuse_transmission_color_factor = color_of(color, 1);
        out.diffuse_transmission_color_texture = slot(in, "diffuseTransmissionColorTexture");
    }

    void convert_clearcoat(const tinygltf::Value& in, Material& out) {
        out.clearcoat_factor = limited(number_member(in, "clearcoatFactor", 0), 0, 1);
        out.clearcoat_texture = slot(in, "clearcoatTexture");
        out.clearcoat_roughness_factor =
            limited(number_member(in, "clearcoatRoughnessFactor", 0), 0, 1);
        out.clearcoat_roughness_texture = slot(in, "clearcoatRoughnessTexture");
        out.clearcoat_normal_texture = slot(in, "clearcoatNormalTexture");
        if (const tinygltf::Value* map = member(in, "clearcoatNormalTexture")) {
            out.clearcoat_normal_scale =
                limited(number_member(*map, "scale", 1), -kLargestFactor, kLargestFactor);
        }
    }

    void convert_sheen(const tinygltf::Value& in, Material& out) {
        double color[3] = {0, 0, 0};
        numbers_member(in, "sheenColorFactor", 3, color);
        out.sheen_color_factor = color_of(color, 1);
        out.sheen_color_texture = slot(in, "sheenColorTexture");
        out.sheen_roughness_factor = limited(number_member(in, "sheenRoughnessFactor", 0), 0, 1);
        out.sheen_roughness_texture = slot(in, "sheenRoughnessTexture");
    }

    void convert_anisotropy(const tinygltf::Value& in, Material& out) {
        out.anisotropy_strength = limited(number_member(in, "anisotropyStrength", 0), 0, 1);
        out.anisotropy_rotation =
            limited(number_member(in, "anisotropyRotation", 0), -kLargestFactor, kLargestFactor);
        out.anisotropy_texture = slot(in, "anisotropyTexture");
    }

    void convert_iridescence(const tinygltf::Value& in, Material& out) {
        out.iridescence_factor = limited(number_member(in, "iridescenceFactor", 0), 0, 1);
        out.iridescence_texture = slot(in, "iridescenceTexture");
        out.iridescence_ior = limited(number_member(in, "iridescenceIor", 1.3), 1, kLargestFactor);
        out.iridescence_thickness_minimum =
            limited(number_member(in, "iridescenceThicknessMinimum", 100), 0, kLargestFactor);
        out.iridescence_thickness_maximum =
            limited(number_member(in, "iridescenceThicknessMaximum", 400), 0, kLargestFactor);
        out.iridescence_thickness_texture = slot(in, "iridescenceThicknessTexture");
    }

    void convert_volume(const tinygltf::Value& in, Material& out) {
        out.thickness_factor = limited(number_member(in, "thicknessFactor", 0), 0, kLargestFactor);
        double color[3] = {1, 1, 1};
        numbers_member(in, "attenuationColor", 3, color);
        out.attenuation_color = color_of(color, 1);
        if (!member(in, "attenuationDistance")) return;
        const auto distance = static_cast<float>(number_member(in, "attenuationDistance", 0));
        if (distance > 0) {
            out.attenuation_distance = distance;
        } else {
            warn("attenuationDistance must be positive; taken as infinite");
        }
    }

    // The extension is a draft; its colour has had three names.
    void convert_scatter(const tinygltf::Value& in, Material& out) {
        double color[3] = {0, 0, 0};
        for (const char* name : {"scatterAlbedo", "multiscatterColor", "multiscatterColorFactor"})
            numbers_member(in, name, 3, color);
        out.multiscatter_color = color_of(color, 1);
        out.scatter_anisotropy = limited(number_member(in, "scatterAnisotropy", 0),
                                         -kLargestAnisotropy, kLargestAnisotropy);
    }

    float valid_ior(double ior) {
        if (ior == 0) return 0;
        if (ior < 1) warn("an index of refraction below 1 is invalid; taken as 1");
        return limited(ior, 1, kLargestFactor);
    }

    TextureSlot slot(const tinygltf::TextureInfo& info) {
        return slot({info.index, info.texCoord, &info.extensions, nullptr});
    }
    TextureSlot slot(const tinygltf::NormalTextureInfo& info) {
        return slot({info.index, info.texCoord, &info.extensions, nullptr});
    }
    TextureSlot slot(const tinygltf::Value& extension, const char* key) {
        const tinygltf::Value* info = member(extension, key);
        if (!info || !info->IsObject()) return {};
        const std::optional<uint32_t> index = index_member(*info, "index");
        if (!index) return {};
        return slot({static_cast<int>(*index),
                     static_cast<int>(index_member(*info, "texCoord").value_or(0)), nullptr, info});
    }

    TextureSlot slot(const TextureReference& reference) {
        TextureSlot out;
        if (reference.index < 0 || !used_) return out;
        out.texture = scene_texture(static_cast<uint32_t>(reference.index));
        if (!out.used()) return out;
        int set = reference.uv_set;
        if (const tinygltf::Value* transform = texture_transform(reference)) {
            fold_transform(*transform, out);
            if (const auto over = index_member(*transform, "texCoord"))
                set = static_cast<int>(*over);
        }
        out.uv_set = scene_uv_set(set);
        return out;
    }

    static const tinygltf::Value* texture_transform(const TextureReference& reference) {
        if (reference.extensions)
            return find_extension_value(*reference.extensions, "KHR_texture_transform");
        const tinygltf::Value* extensions = member(*reference.value, "extensions");
        const tinygltf::Value* transform =
            extensions ? member(*extensions, "KHR_texture_transform") : nullptr;
        return transform && transform->IsObject() ? transform : nullptr;
    }

    // uv' = translation * rotation * scale * uv, with the rotation of the extension's text (V
    // points down).
    static void fold_transform(const tinygltf::Value& transform, TextureSlot& out) {
        double offset[2] = {0, 0};
        double scale[2] = {1, 1};
        numbers_member(transform, "offset", 2, offset);
        numbers_member(transform, "scale", 2, scale);
        const double angle = number_member(transform, "rotation", 0);
        const double c = std::cos(angle);
        const double s = std::sin(angle);
        const auto number = [](double x) { return limited(x, -kLargestFactor, kLargestFactor); };
        out.transform_u = Vec3f(number(c * scale[0]), number(s * scale[1]), number(offset[0]));
        out.transform_v = Vec3f(number(-s * scale[0]), number(c * scale[1]), number(offset[1]));
        out.has_transform = out.transform_u != Vec3f(1, 0, 0) || out.transform_v != Vec3f(0, 1, 0);
    }

    // The file's TEXCOORD_n as one of the two sets of a mesh. Sets 0 and 1 keep their places; a
    // higher one takes a place that no texture of this material has asked for yet.
    uint8_t scene_uv_set(int set) {
        const auto wanted = static_cast<uint32_t>(std::clamp(set, 0, kMaxUvSet));
        for (uint8_t place = 0; place < 2; ++place) {
            if (uv_sets_[place] != wanted) continue;
            uv_set_taken_[place] = true;
            return place;
        }
        for (const uint8_t place : {uint8_t{1}, uint8_t{0}}) {
            if (uv_set_taken_[place]) continue;
            uv_sets_[place] = wanted;
            uv_set_taken_[place] = true;
            return place;
        }
        warn("uses more than two texture coordinate sets; TEXCOORD_" + std::to_string(wanted) +
             " is replaced by TEXCOORD_" + std::to_string(uv_sets_[0]));
        return 0;
    }

    static TextureWrap wrap_of(int mode) {
        if (mode == TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE) return TextureWrap::clamp_to_edge;
        return mode == TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT ? TextureWrap::mirrored_repeat
                                                             : TextureWrap::repeat;
    }

    // Without a word of the file the levels are blended.
    static void set_levels(int mode, Texture& out) {
        switch (mode) {
            case TINYGLTF_TEXTURE_FILTER_NEAREST:
            case TINYGLTF_TEXTURE_FILTER_LINEAR:
                out.levels = TextureLevels::none;
                break;
            case TINYGLTF_TEXTURE_FILTER_NEAREST_MIPMAP_NEAREST:
            case TINYGLTF_TEXTURE_FILTER_LINEAR_MIPMAP_NEAREST:
                out.levels = TextureLevels::nearest;
                break;
            default:
                break;
        }
        if (mode == TINYGLTF_TEXTURE_FILTER_NEAREST_MIPMAP_NEAREST ||
            mode == TINYGLTF_TEXTURE_FILTER_NEAREST_MIPMAP_LINEAR)
            out.level_filter = TextureFilter::nearest;
    }

    uint32_t scene_texture(uint32_t index) {
        uint32_t& mapped = texture_map_[index];
        if (mapped != kNoTexture) return mapped;
        const tinygltf::Model& model = loading_.document.model;
        const tinygltf::Texture& in = model.textures[index];
        const std::optional<uint32_t> image = image_of_texture(in);
        if (!image) {
            warn("textures[" + std::to_string(index) +
                 "] has no image that can be read; it is left out");
            return kNoTexture;
        }
        Texture out;
        if (in.sampler >= 0) {
            const tinygltf::Sampler& sampler = model.samplers[static_cast<size_t>(in.sampler)];
            out.wrap_u = wrap_of(sampler.wrapS);
            out.wrap_v = wrap_of(sampler.wrapT);
            if (sampler.magFilter == TINYGLTF_TEXTURE_FILTER_NEAREST)
                out.filter = TextureFilter::nearest;
            set_levels(sampler.minFilter, out);
        }
        mapped = static_cast<uint32_t>(loading_.desc.textures.size());
        loading_.desc.textures.push_back(out);
        tables_.image_of.push_back(*image);
        return mapped;
    }

    Loading& loading_;
    MaterialTables& tables_;
    std::vector<uint32_t> texture_map_;
    UvSets uv_sets_{0, 1};
    std::array<bool, 2> uv_set_taken_{false, false};
    std::string element_;
    bool used_ = false;
};

}  // namespace

MaterialTables convert_materials(Loading& loading, const std::vector<bool>& used) {
    MaterialTables tables;
    tables.uv_sets.push_back({0, 1});
    Material standard;
    standard.name = "default";
    loading.desc.materials.push_back(standard);
    const std::vector<tinygltf::Material>& materials = loading.document.model.materials;
    MaterialConverter converter(loading, tables);
    for (size_t i = 0; i < materials.size(); ++i) {
        loading.desc.materials.push_back(converter.convert(materials[i], i, used[i + 1]));
    }
    return tables;
}

}  // namespace talbot::gltf
