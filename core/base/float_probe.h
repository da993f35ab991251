// What the compiled code really does with floating point, found out by calculating: the flags of a
// build say little about that.
#pragma once

namespace talbot {

struct FloatProbe {
    bool contracts = false;  // a b + c is rounded once though the source asks for two roundings
    bool flushes_results = false;   // denormal results become zero
    bool flushes_operands = false;  // denormal operands count as zero
    bool nan_is_unequal = false;    // NaN differs from itself
    bool zero_has_sign = false;     // 1 / -0 is -infinity
};

// Of the calling thread. The multiplications are compiled once for the build's instruction set and
// once for one with fused instructions, where this CPU has them.
FloatProbe probe_floats();

}  // namespace talbot
