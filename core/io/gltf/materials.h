// glTF materials to Material, and textures with their samplers to the scene's texture table.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/io/gltf/loading.h"

namespace talbot::gltf {

// The two TEXCOORD_n sets that become uv[0] and uv[1] of every mesh with this material.
using UvSets = std::array<uint32_t, 2>;

// KHR_materials_variants: which variant the options name; empty inside when they name none. An
// unknown name is a usage error that lists those there are.
Result<std::optional<uint32_t>> choose_variant(const Loading& loading);

// The names of the file's variants.
std::vector<std::string> variant_names(const Document& document);

// The scene material of a primitive under a variant.
uint32_t material_of(const tinygltf::Primitive& primitive, std::optional<uint32_t> variant);

struct MaterialTables {
    std::vector<UvSets> uv_sets;     // per scene material
    std::vector<uint32_t> image_of;  // per scene texture: which image of the file
};

// Fills desc.materials (0 is glTF's default, file material i is i + 1) and desc.textures (still
// without images). Textures of materials that nothing uses are left out; used[i] is for scene
// material i.
MaterialTables convert_materials(Loading& loading, const std::vector<bool>& used);

}  // namespace talbot::gltf
