// EXT_meshopt_compression: buffer views whose bytes are compressed (Khronos registry, vendor
// extension; streams and filters as the meshoptimizer library decodes them).
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "core/io/gltf/document.h"

namespace talbot::gltf {

// A compressed buffer view: `count` elements of `stride` bytes come out of buffer[offset, +length).
struct CompressedView {
    enum class Mode : uint8_t { attributes, triangles, indices };
    enum class Filter : uint8_t { none, octahedral, quaternion, exponential };

    size_t view = 0;
    size_t buffer = 0;
    uint64_t offset = 0;
    uint64_t length = 0;
    uint64_t stride = 0;
    uint64_t count = 0;
    Mode mode = Mode::attributes;
    Filter filter = Filter::none;
};

// The compressed views of a document whose structure has been checked; the error names the view.
Result<std::vector<CompressedView>> find_compressed_views(const nlohmann::json& root);

// Which buffers must be read: a fallback buffer, in which only compressed views lie, need not
// exist.
std::vector<bool> find_needed_buffers(const nlohmann::json& root,
                                      const std::vector<CompressedView>& views);

// Decodes every view into a buffer of its own and points document.model's view there. A declared
// size that the compressed bytes cannot hold is refused before anything is allocated.
Status decode_views(Document& document, const std::vector<CompressedView>& views,
                    uint64_t max_bytes);

}  // namespace talbot::gltf
