// A fixed-point accumulator with 72 integer and 56 fraction bits. Integer addition is associative,
// so the sum of any samples is the same bits in any order, split over any number of partial
// renders.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>

namespace talbot {

class ExactSum {
  public:
    // Magnitudes above do not fit; the film clamps and counts them. 2^30 samples of this size still
    // make no overflow.
    static constexpr float kLimit = 0x1p41f;

    // Adds a finite x with |x| <= kLimit, truncated to a multiple of 2^-56.
    void add(float x) { bits_ += to_fixed(x); }
    void add(const ExactSum& other) { bits_ += other.bits_; }

    // The sum in double, off by at most one unit in the last place.
    double value() const {
        if (static_cast<int64_t>(bits_ >> 64) < 0) return -magnitude(-bits_);
        return magnitude(bits_);
    }

    bool operator==(const ExactSum&) const = default;

  private:
    using Bits = unsigned __int128;  // two's complement; unsigned, so that no order of addition can
                                     // overflow on the way

    static double magnitude(Bits bits) {
        return static_cast<double>(static_cast<int64_t>(bits >> 64)) * 0x1p8 +
               static_cast<double>(static_cast<uint64_t>(bits)) * 0x1p-56;
    }

    static Bits to_fixed(float x) {
        const uint32_t bits = std::bit_cast<uint32_t>(x);
        const int exponent = static_cast<int>((bits >> 23) & 0xFFu);
        if (exponent == 0) return 0;  // zero, or a denormal far below 2^-56
        const Bits mantissa = (bits & 0x7FFFFFu) | 0x800000u;
        const int shift = exponent - 150 + 56;  // x = mantissa 2^(exponent - 150)
        const Bits size = shift >= 0 ? mantissa << shift : (shift > -24 ? mantissa >> -shift : 0);
        return (bits >> 31) != 0 ? -size : size;
    }

    Bits bits_ = 0;
};

}  // namespace talbot
