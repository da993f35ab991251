// A scene in code as self-contained glTF text, for readers of the gallery to open elsewhere.
#pragma once

#include <string>

#include "core/scene/camera.h"
#include "core/scene/scene_desc.h"

namespace talbot::hardcases {

// Meshes, instances, spheres, factors and base colour and normal textures of materials, volumes,
// punctual lights, an even or graded environment and one camera with its resolution in pixels.
// What glTF cannot say (an environment image) is left out. Throws where an image cannot be encoded.
std::string gltf_text(const SceneDesc& desc, const Camera& camera, uint32_t width, uint32_t height);

}  // namespace talbot::hardcases
