// Morph targets and skins, applied to a mesh once (glTF 2.0, sections 3.7.2.2 and 3.7.3).
#pragma once

#include <array>
#include <vector>

#include "core/io/gltf/attributes.h"
#include "core/math/vec.h"
#include "core/scene/mesh.h"

namespace talbot::gltf {

// Which elements of the accessors the mesh's vertices are: [first, first + count) of `total`.
struct VertexRange {
    size_t total = 0;
    size_t first = 0;
    size_t count = 0;
};

// Adds weights[k] times the deltas of target k to positions, normals, tangents, texture coordinates
// and colours, as far as both the target and the mesh have them. Normals and tangents are not unit
// after it.
Status apply_morph_targets(const AttributeSource& source, const VertexRange& range,
                           const std::vector<double>& weights,
                           const std::array<uint32_t, 2>& uv_sets, MemoryBudget& budget,
                           uint64_t max_bytes, Mesh& mesh);

// Moves every vertex by the weighted mean of joints[JOINTS_n]. Weights are made to sum to 1; where
// they are all 0, the first joint of the vertex counts. Triangles are turned round when the joints
// mirror.
Status apply_skin(const AttributeSource& source, const VertexRange& range,
                  const std::vector<Mat4d>& joints, Mesh& mesh);

}  // namespace talbot::gltf
