// Four floats with elementwise arithmetic, in one register where the processor has such.
#pragma once

namespace talbot {

using Float4 = float __attribute__((vector_size(16)));

inline Float4 min4(const Float4& a, const Float4& b) {
    return a < b ? a : b;
}
inline Float4 max4(const Float4& a, const Float4& b) {
    return a > b ? a : b;
}

}  // namespace talbot
