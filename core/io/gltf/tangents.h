// Tangent frames for normal maps, by the rules of MikkTSpace, which glTF names as the standard.
#pragma once

#include <cstdint>

#include "core/scene/mesh.h"

namespace talbot::gltf {

// Fills mesh.tangents from positions, normals and uv[uv_set], which must be there. A vertex that
// lies where frames of different handedness or of unconnected charts meet is split, so positions
// may grow. V points down: the bitangent goes towards -V.
void generate_tangents(Mesh& mesh, uint32_t uv_set);

}  // namespace talbot::gltf
