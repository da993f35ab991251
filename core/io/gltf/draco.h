// KHR_draco_mesh_compression: the triangles and attributes of a primitive in one compressed stream.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "core/io/gltf/accessor.h"
#include "core/io/gltf/loading.h"

namespace talbot::gltf {

// One decoded attribute: `view` reads `bytes`, so it may be moved, not copied.
struct DracoAttribute {
    std::vector<uint8_t> bytes;
    AccessorView view;

    DracoAttribute() = default;
    DracoAttribute(DracoAttribute&&) = default;
    DracoAttribute& operator=(DracoAttribute&&) = default;
};

struct DracoMesh {
    size_t point_count = 0;
    std::vector<uint32_t> indices;  // three a triangle, each < point_count
    std::map<std::string, DracoAttribute> attributes;
};

bool is_draco(const tinygltf::Primitive& primitive);

// Decodes a primitive for which is_draco holds; `element` names it. Counts that differ from those
// of its accessors are refused before the bulk is allocated. Safe to call from several threads.
Result<DracoMesh> decode_draco(const Document& document, const tinygltf::Primitive& primitive,
                               const std::string& element, MemoryBudget& budget,
                               uint64_t max_bytes);

}  // namespace talbot::gltf
