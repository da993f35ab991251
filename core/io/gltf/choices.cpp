// What a glTF file offers to choose from.
#include "core/io/gltf/animation.h"
#include "core/io/gltf/materials.h"

namespace talbot {

Result<GltfChoices> read_gltf_choices(const std::filesystem::path& file) {
    const Result<gltf::Document> document = gltf::read_document(file, LoadOptions().max_bytes);
    if (!document) return document.error();
    GltfChoices choices;
    choices.variants = gltf::variant_names(*document);
    const std::vector<tinygltf::Animation>& animations = document->model.animations;
    for (size_t i = 0; i < animations.size(); ++i) {
        const std::string& name = animations[i].name;
        choices.animations.push_back({name.empty() ? "animation " + std::to_string(i) : name,
                                      gltf::animation_seconds(*document, i)});
    }
    return choices;
}

}  // namespace talbot
