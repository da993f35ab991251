// Magnitudes of three channels in four bytes: a shared power of two and eight bits each (Ward 1991,
// as in Radiance's pictures), rounded to nearest, so that sums over pixels stay right. Kept for
// each pixel between two octaves.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>

#include "core/math/vec.h"

namespace talbot {

inline uint32_t pack_difference(const Rgb& difference) {
    const Rgb m = glm::abs(difference);
    const float most = std::max(m.x, std::max(m.y, m.z));
    const uint32_t exponent = (std::bit_cast<uint32_t>(most) >> 23) & 0xFFu;
    // Nothing, or too small for its scale below to be a number.
    constexpr uint32_t kLeast = 16, kMost = 254;
    if (exponent < kLeast || exponent > kMost) return 0;
    // 2^(7 - e) puts the largest channel into 128..255.
    const float scale = std::bit_cast<float>((127 + 7 + 127 - exponent) << 23);
    const auto digit = [&](float x) {
        return static_cast<uint32_t>(std::min(x * scale + 0.5f, 255.0f));
    };
    return exponent << 24 | digit(m.x) << 16 | digit(m.y) << 8 | digit(m.z);
}

inline Rgb unpack_difference(uint32_t packed) {
    const uint32_t exponent = packed >> 24;
    if (exponent == 0) return Rgb(0);
    const float unit = std::bit_cast<float>((exponent - 7) << 23);
    return unit * Rgb(static_cast<float>((packed >> 16) & 0xFFu),
                      static_cast<float>((packed >> 8) & 0xFFu),
                      static_cast<float>(packed & 0xFFu));
}

}  // namespace talbot
