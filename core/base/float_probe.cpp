#include "core/base/float_probe.h"

#include <limits>

namespace talbot {
namespace {

// (1 + 2^-12)^2 - (1 + 2^-11) is 2^-24, which the rounded product has lost.
struct Factors {
    volatile float a = 1 + 0x1p-12f;
    volatile float c = -(1 + 0x1p-11f);
};

[[gnu::noinline]] bool contracts() {
    const Factors f;
    const float a = f.a;
    const float c = f.c;
    return a * a + c != 0;
}

#if defined(__x86_64__)
[[gnu::noinline, gnu::target("fma")]] bool contracts_with_fma() {
    const Factors f;
    const float a = f.a;
    const float c = f.c;
    return a * a + c != 0;
}
#endif

}  // namespace

FloatProbe probe_floats() {
    FloatProbe probe;
    probe.contracts = contracts();
#if defined(__x86_64__)
    if (__builtin_cpu_supports("fma")) probe.contracts = probe.contracts || contracts_with_fma();
#endif
    volatile float least = std::numeric_limits<float>::min();
    volatile float denormal = std::numeric_limits<float>::denorm_min();
    volatile float half = 0.5f;
    volatile float large = 0x1p100f;
    probe.flushes_results = least * half == 0;
    probe.flushes_operands = denormal * large == 0;
    volatile float nan = std::numeric_limits<float>::quiet_NaN();
    volatile float zero = 0.0f;
    probe.nan_is_unequal = nan != nan;
    probe.zero_has_sign = 1 / (-zero) < 0;
    return probe;
}

}  // namespace talbot
