// The images that the scene's textures use, decoded on all threads.
#pragma once

#include <memory>
#include <optional>

#include "core/io/gltf/loading.h"

namespace talbot::gltf {

// The image of a texture: that of an image format's extension where there is one, else the core's;
// empty when there is neither.
std::optional<uint32_t> image_of_texture(const tinygltf::Texture& texture);

// Decodes image `index` of the file (its format is known by its content). Safe to call from several
// threads.
Result<std::shared_ptr<const Image8>> load_image8(const Document& document, size_t index,
                                                  MemoryBudget& budget, uint64_t max_bytes);

}  // namespace talbot::gltf
