// Bits of a byte string, from the least significant bit of the first byte on (KTX 2.0, BasisLZ
// bitstreams; also RFC 1951).
#pragma once

#include <cstdint>
#include <span>

namespace talbot::ktx2 {

// Past the end it gives zeros and says so.
class BitReader {
  public:
    explicit BitReader(std::span<const uint8_t> bytes) : bytes_(bytes) {}

    uint32_t bit() {
        const size_t byte = at_ >> 3;
        if (byte >= bytes_.size()) {
            is_past_end_ = true;
            return 0;
        }
        return uint32_t{bytes_[byte]} >> (at_++ & 7) & 1u;
    }

    // count <= 32.
    uint32_t bits(int count) {
        uint32_t value = 0;
        for (int i = 0; i < count; ++i) value |= bit() << i;
        return value;
    }

    bool is_past_end() const { return is_past_end_; }

  private:
    std::span<const uint8_t> bytes_;
    size_t at_ = 0;
    bool is_past_end_ = false;
};

}  // namespace talbot::ktx2
