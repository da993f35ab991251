// A node of the structure.
#pragma once

#include <cstdint>

namespace talbot {

inline constexpr uint32_t kNodeWidth = 8;

// What unused children refer to: the first node, which is nobody's child.
inline constexpr uint32_t kUnusedChild = 0;

// Planes in the order lower x, upper x, lower y, upper y, lower z, upper z. Unused children have an
// empty box.
struct alignas(64) WideNode {
    float plane[6][kNodeWidth];
    uint32_t child[kNodeWidth];
};

}  // namespace talbot
