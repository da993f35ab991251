// Integer hashing and the map from random bits to [0, 1).
#pragma once

#include <cstdint>

namespace talbot {

// 32-bit finaliser with full avalanche (Wellons 2018, "lowbias32").
constexpr uint32_t hash32(uint32_t x) {
    x ^= x >> 16;
    x *= 0x7FEB352Du;
    x ^= x >> 15;
    x *= 0x846CA68Bu;
    x ^= x >> 16;
    return x;
}

constexpr uint32_t hash_combine(uint32_t seed, uint32_t value) {
    return hash32(seed ^ (value + 0x9E3779B9u + (seed << 6) + (seed >> 2)));
}

constexpr uint32_t reverse_bits(uint32_t x) {
    x = (x << 16) | (x >> 16);
    x = ((x & 0x00FF00FFu) << 8) | ((x & 0xFF00FF00u) >> 8);
    x = ((x & 0x0F0F0F0Fu) << 4) | ((x & 0xF0F0F0F0u) >> 4);
    x = ((x & 0x33333333u) << 2) | ((x & 0xCCCCCCCCu) >> 2);
    return ((x & 0x55555555u) << 1) | ((x & 0xAAAAAAAAu) >> 1);
}

// The top 24 bits as a float in [0, 1 - 2^-24]: never rounds to 1.
constexpr float unit_float(uint32_t bits) {
    // Through int32, whose conversion every vector unit has.
    return static_cast<float>(static_cast<int32_t>(bits >> 8)) * 0x1p-24f;
}

}  // namespace talbot
