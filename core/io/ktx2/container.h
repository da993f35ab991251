// KTX 2.0 files: header, level index and data format descriptor, as far as glTF's
// KHR_texture_basisu uses them (one 2D image with its mip levels, in a Basis Universal format).
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/base/result.h"

namespace talbot::ktx2 {

enum class Format { etc1s, uastc };
enum class Supercompression : uint32_t { none = 0, basis_lz = 1, zstandard = 2 };

struct Level {
    std::span<const uint8_t> bytes;
    uint64_t uncompressed_length = 0;  // as declared
};

// Spans point into the file's bytes.
struct Container {
    uint32_t width = 0;
    uint32_t height = 0;
    Format format = Format::uastc;
    Supercompression supercompression = Supercompression::none;
    bool is_srgb = false;
    std::vector<uint8_t> channels;  // channel ids of the descriptor's samples, one or two
    std::vector<Level> levels;      // 0 is the full size
    std::span<const uint8_t> global_data;
};

bool is_ktx2(std::span<const uint8_t> bytes);

// Everything but the levels' contents is checked; `name` is for messages.
Result<Container> read_container(std::span<const uint8_t> bytes, const std::string& name);

}  // namespace talbot::ktx2
