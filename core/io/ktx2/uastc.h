// UASTC 4x4 LDR blocks (Binomial's UASTC specification; interpolation as in ASTC, Khronos Data
// Format Specification).
#pragma once

#include <array>
#include <cstdint>
#include <span>

namespace talbot::ktx2 {

// RGBA of 16 texels, rows from the top.
using Block = std::array<std::array<uint8_t, 4>, 16>;

// False when the 16 bytes are no block. is_srgb picks ASTC's rounding for sRGB colours.
bool decode_uastc_block(std::span<const uint8_t, 16> bytes, bool is_srgb, Block& out);

// Which texels lie in subset 1 (and 2, for three subsets) of the patterns that UASTC shares with
// ASTC and BC7; bit 4 * y + x.
std::span<const uint16_t> two_subset_patterns();        // modes 2, 4, 9 and 16
std::span<const uint16_t> two_subset_patterns_mode7();  // those of mode 7
std::span<const std::array<uint16_t, 2>> three_subset_patterns();

}  // namespace talbot::ktx2
