// Canonical Huffman codes as BasisLZ stores them (KTX 2.0, "Compressed Huffman Tables").
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/io/ktx2/bit_reader.h"

namespace talbot::ktx2 {

class HuffmanCode {
  public:
    static constexpr int kMaxLength = 16;

    // Code lengths per symbol, 0 for none; empty when they are no prefix code.
    static std::optional<HuffmanCode> from_lengths(const std::vector<uint8_t>& lengths);

    // A code whose lengths are themselves compressed; empty when the bits are no such table.
    static std::optional<HuffmanCode> read(BitReader& in);

    // The next symbol; empty when the bits are none, or end.
    std::optional<uint32_t> decode(BitReader& in) const;

  private:
    std::array<uint32_t, kMaxLength + 1> count_{};  // of codes, by length
    std::vector<uint16_t> symbols_;                 // by length, then by value
};

}  // namespace talbot::ktx2
