// The images that the scene's textures use, decoded on all threads.
#pragma once

#include <memory>

#include "core/io/gltf/loading.h"

namespace talbot::gltf {

// Decodes image `index` of the file (PNG or JPEG by content). Safe to call from several threads.
Result<std::shared_ptr<const Image8>> load_image8(const Document& document, size_t index,
                                                  MemoryBudget& budget, uint64_t max_bytes);

}  // namespace talbot::gltf
