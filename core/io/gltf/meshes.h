// One glTF primitive to one Mesh.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/io/gltf/loading.h"
#include "core/io/gltf/materials.h"
#include "core/io/gltf/shapes.h"

namespace talbot::gltf {

struct PrimitiveRequest {
    uint32_t mesh = 0;       // of the file
    uint32_t primitive = 0;  // of that mesh
    uint32_t material = 0;   // of the scene
    UvSets uv_sets{0, 1};
    uint8_t tangent_uv_set = 0;  // of the two above
    bool wants_tangents = false;
    const MeshShape* shape = nullptr;  // of this mesh; null: as the file has it
};

struct PrimitiveResult {
    std::optional<Mesh> mesh;  // empty when nothing of it can be drawn
    bool is_points_or_lines = false;
    std::vector<std::string> warnings;
};

// Safe to call from several threads.
Result<PrimitiveResult> load_primitive(const Document& document, const PrimitiveRequest& request,
                                       MemoryBudget& budget, uint64_t max_bytes);

// "meshes[2].primitives[0]"
std::string primitive_name(uint32_t mesh, uint32_t primitive);

}  // namespace talbot::gltf
