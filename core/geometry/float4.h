// Four floats with elementwise arithmetic, in one register where the processor has such.
#pragma once

namespace talbot {

using Float4 = float __attribute__((vector_size(16)));
using Int4 = int __attribute__((vector_size(16)));

inline Float4 min4(const Float4& a, const Float4& b) {
    return a < b ? a : b;
}
inline Float4 max4(const Float4& a, const Float4& b) {
    return a > b ? a : b;
}

inline Float4 abs4(const Float4& a) {
    return reinterpret_cast<Float4>(reinterpret_cast<Int4>(a) & 0x7fffffff);
}
inline Float4 copysign4(const Float4& size, const Float4& sign) {
    constexpr int kMagnitude = 0x7fffffff;
    return reinterpret_cast<Float4>((reinterpret_cast<Int4>(size) & kMagnitude) |
                                    (reinterpret_cast<Int4>(sign) & ~kMagnitude));
}

}  // namespace talbot
