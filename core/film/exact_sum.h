// A fixed-point accumulator with 64 integer and 64 fraction bits. Integer addition is associative, so the sum of any samples
// is the same bits in any order, split over any number of partial renders.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>

namespace talbot {

class ExactSum {
  public:
    // Adds a finite x with |x| < 2^62, truncated to a multiple of 2^-64.
    void add(float x) { value_ += to_fixed(x); }
    void add(const ExactSum& other) { value_ += other.value_; }

    // The sum, rounded to double.
    double value() const {
        const bool negative = value_ < 0;
        const unsigned __int128 magnitude =
            negative ? -static_cast<unsigned __int128>(value_) : static_cast<unsigned __int128>(value_);
        const double sum = static_cast<double>(static_cast<uint64_t>(magnitude >> 64)) +
                           static_cast<double>(static_cast<uint64_t>(magnitude)) * 0x1p-64;
        return negative ? -sum : sum;
    }

    bool operator==(const ExactSum&) const = default;

    // Magnitudes from here on do not fit; the film clamps and counts them.
    static constexpr float kLimit = 0x1p62f;

  private:
    static __int128 to_fixed(float x) {
        const uint32_t bits = std::bit_cast<uint32_t>(x);
        const int exponent = static_cast<int>((bits >> 23) & 0xFFu);
        if (exponent == 0) return 0;  // zero, or a denormal far below 2^-64
        const __int128 mantissa = static_cast<__int128>((bits & 0x7FFFFFu) | 0x800000u);
        const int shift = exponent - 150 + 64;  // x = mantissa 2^(exponent - 150)
        const __int128 magnitude = shift >= 0 ? mantissa << shift : (shift > -24 ? mantissa >> -shift : 0);
        return (bits >> 31) != 0 ? -magnitude : magnitude;
    }

    __int128 value_ = 0;
};

}  // namespace talbot
