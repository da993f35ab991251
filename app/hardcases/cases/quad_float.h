// 113-bit reference arithmetic, from float inputs.
#pragma once

#include <cmath>

namespace talbot::hardcases {

using Quad = __float128;

// Newton's step doubles the digits of the long double root.
inline Quad square_root(Quad x) {
    if (!(x > 0)) return 0;
    const Quad r = std::sqrt(static_cast<long double>(x));
    return (r + x / r) / 2;
}

}  // namespace talbot::hardcases
