// What a glTF file offers to choose from.
#pragma once

#include "core/io/gltf/document.h"
#include "core/io/gltf_loader.h"

namespace talbot::gltf {

GltfChoices choices_of(const Document& document);

}  // namespace talbot::gltf
