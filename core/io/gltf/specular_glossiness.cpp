// KHR_materials_pbrSpecularGlossiness (Khronos registry, archived): diffuse and specular colours,
// specular texture with glossiness in alpha.
#include "core/io/gltf/specular_glossiness.h"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

namespace talbot::gltf {

namespace {

using Json = nlohmann::json;

constexpr const char* kSpecularGlossiness = "KHR_materials_pbrSpecularGlossiness";

// `count` numbers, or all ones.
Json numbers(const Json& object, const char* key, size_t count) {
    const auto found = object.find(key);
    const bool valid =
        found != object.end() && found->is_array() && found->size() == count &&
        std::all_of(found->begin(), found->end(), [](const Json& v) { return v.is_number(); });
    return valid ? *found : Json(std::vector<double>(count, 1.0));
}

double number(const Json& object, const char* key, double fallback) {
    const auto found = object.find(key);
    return found != object.end() && found->is_number() ? found->get<double>() : fallback;
}

class Converter {
  public:
    explicit Converter(Json& root) : root_(root) {}

    std::vector<RoughnessImage> run() {
        const auto materials = root_.find("materials");
        if (materials == root_.end()) return {};
        for (Json& material : *materials) {
            const Json::json_pointer where(std::string("/extensions/") + kSpecularGlossiness);
            if (!material.contains(where) || !material[where].is_object()) continue;
            const Json old = material[where];
            convert(old, material);
        }
        return std::move(images_);
    }

  private:
    void convert(const Json& old, Json& material) {
        const double glossiness = std::clamp(number(old, "glossinessFactor", 1), 0.0, 1.0);
        Json core = {{"baseColorFactor", numbers(old, "diffuseFactor", 4)},
                     {"metallicFactor", 0},
                     {"roughnessFactor", 1 - glossiness}};
        if (old.contains("diffuseTexture")) core["baseColorTexture"] = old["diffuseTexture"];
        Json& extensions = material["extensions"];
        extensions.erase(kSpecularGlossiness);
        extensions["KHR_materials_ior"] = {{"ior", 0}};
        Json& specular = extensions["KHR_materials_specular"];
        specular = {{"specularColorFactor", numbers(old, "specularFactor", 3)}};
        const auto texture = old.find("specularGlossinessTexture");
        if (texture != old.end() && texture->is_object()) {
            specular["specularColorTexture"] = *texture;
            if (const auto index =
                    roughness_texture((*texture)["index"].get<size_t>(), glossiness)) {
                core["roughnessFactor"] = 1;
                core["metallicRoughnessTexture"] = *texture;
                core["metallicRoughnessTexture"]["index"] = *index;
            }
        }
        material["pbrMetallicRoughness"] = std::move(core);
    }

    // The image that a texture takes, as image_of_texture has it.
    static std::optional<uint32_t> image_of(const Json& texture) {
        for (const char* where : {"/extensions/KHR_texture_basisu/source",
                                  "/extensions/EXT_texture_webp/source", "/source"}) {
            const Json::json_pointer pointer(where);
            if (texture.contains(pointer)) return texture[pointer].get<uint32_t>();
        }
        return std::nullopt;
    }

    // A texture of the roughness that a texture's glossiness stands for; empty when it has no
    // image.
    std::optional<size_t> roughness_texture(size_t index, double factor) {
        const auto known = std::find(made_.begin(), made_.end(), std::pair(index, factor));
        if (known != made_.end())
            return first_texture_ + static_cast<std::size_t>(known - made_.begin());
        Json& textures = root_["textures"];
        const std::optional<uint32_t> source = image_of(textures[index]);
        if (!source) return std::nullopt;
        if (made_.empty()) first_texture_ = textures.size();
        const size_t image = root_["images"].size() + images_.size();
        Json texture = {{"source", image}};
        if (textures[index].contains("sampler")) texture["sampler"] = textures[index]["sampler"];
        textures.push_back(std::move(texture));
        images_.push_back({*source, factor});
        made_.emplace_back(index, factor);
        return textures.size() - 1;
    }

    Json& root_;
    std::vector<RoughnessImage> images_;
    std::vector<std::pair<size_t, double>> made_;  // the textures made, in order
    size_t first_texture_ = 0;
};

}  // namespace

std::vector<RoughnessImage> convert_specular_glossiness(Json& root) {
    return Converter(root).run();
}

}  // namespace talbot::gltf
