// ETC1S images under BasisLZ (KTX 2.0, appendices "BasisLZ Global Data" and "BasisLZ/ETC1S
// Bitstream Specification").
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/io/ktx2/huffman.h"

namespace talbot::ktx2 {

// One slice of an image of one level, as byte ranges within the level.
struct Etc1sSlices {
    uint32_t rgb_offset = 0;
    uint32_t rgb_length = 0;
    uint32_t alpha_offset = 0;
    uint32_t alpha_length = 0;  // 0: there is none
};

// The codebooks and codes that all slices of a file share.
class Etc1sDecoder {
  public:
    // Empty when the global data are broken. image_count is the number of mip levels.
    static std::optional<Etc1sDecoder> read(std::span<const uint8_t> global_data,
                                            size_t image_count);

    const Etc1sSlices& slices(size_t image) const { return images_[image]; }

    // RGB of every texel, rows from the top, width * height * 3 bytes; empty when the slice is
    // broken.
    std::optional<std::vector<uint8_t>> decode(std::span<const uint8_t> slice, uint32_t width,
                                               uint32_t height) const;

  private:
    struct Endpoint {
        std::array<uint8_t, 3> color{};  // 5 bits each
        uint8_t intensity = 0;           // row of ETC1's table of modifiers
    };
    using Selectors = std::array<uint8_t, 4>;  // a row of four two-bit values a byte

    bool read_endpoints(std::span<const uint8_t> bytes, size_t count);
    bool read_selectors(std::span<const uint8_t> bytes, size_t count);
    bool read_codes(std::span<const uint8_t> bytes);

    friend class SliceDecoder;
    std::vector<Etc1sSlices> images_;
    std::vector<Endpoint> endpoints_;
    std::vector<Selectors> selectors_;
    HuffmanCode endpoint_prediction_;
    HuffmanCode endpoint_delta_;
    HuffmanCode selector_;
    HuffmanCode selector_run_;
    uint32_t history_size_ = 0;
};

}  // namespace talbot::ktx2
