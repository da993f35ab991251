// A small scene as self-contained glTF text, for the gallery's readers to open elsewhere.
#pragma once

#include <string>

#include "core/scene/camera.h"
#include "oracles/scene_builder.h"

namespace talbot::hardcases {

// Meshes, spheres, factors and textures of materials, punctual lights, an even or graded
// environment and one camera. What glTF cannot say (an environment image) is left out.
std::string gltf_text(const SceneBuilder& builder, const Camera& camera, uint32_t side_px);

}  // namespace talbot::hardcases
