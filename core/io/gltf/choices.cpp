#include "core/io/gltf/choices.h"

#include <algorithm>

#include "core/io/gltf/animation.h"
#include "core/io/gltf/materials.h"

namespace talbot {

double GltfChoices::last_key() const {
    double last = 0;
    for (const GltfAnimation& animation : animations) last = std::max(last, animation.seconds);
    return last;
}

namespace gltf {
namespace {

std::string name_or_index(const std::string& name, const char* kind, size_t index) {
    return name.empty() ? std::string(kind) + " " + std::to_string(index) : name;
}

}  // namespace

GltfChoices choices_of(const Document& document) {
    GltfChoices choices;
    choices.variants = variant_names(document);
    const std::vector<tinygltf::Scene>& scenes = document.model.scenes;
    for (size_t i = 0; i < scenes.size(); ++i)
        choices.scenes.push_back(name_or_index(scenes[i].name, "scene", i));
    if (document.model.defaultScene > 0)
        choices.default_scene = static_cast<size_t>(document.model.defaultScene);
    const std::vector<tinygltf::Animation>& animations = document.model.animations;
    for (size_t i = 0; i < animations.size(); ++i) {
        choices.animations.push_back(
            {name_or_index(animations[i].name, "animation", i), animation_seconds(document, i)});
    }
    return choices;
}

}  // namespace gltf
}  // namespace talbot
