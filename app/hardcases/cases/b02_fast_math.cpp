// B02: what -ffast-math takes away: NaN, infinity and the sign of zero.
#include <bit>
#include <vector>

#include "app/hardcases/cases/b02_relaxed.h"
#include "app/hardcases/worst.h"
#include "core/base/float_probe.h"
#include "core/math/robust.h"

namespace talbot::hardcases::b02 {
namespace {

CaseResult run(Effort effort) {
    double naive = 0;
    double own = 0;
    const auto look = [&](uint32_t bits) {
        const float x = std::bit_cast<float>(bits);
        const bool finite = (bits & 0x7F800000u) != 0x7F800000u;
        naive += relaxed_is_finite(x) == finite ? 0 : 1;
        own += is_finite(x) == finite && is_finite(static_cast<double>(x)) == finite ? 0 : 1;
    };
    // All exponents, both signs, some mantissas; or everything.
    const uint64_t step = effort == Effort::full ? 1 : 4099;
    for (uint64_t bits = 0; bits <= 0xFFFFFFFFull; bits += step) look(static_cast<uint32_t>(bits));
    const FloatProbe probe = probe_floats();
    CaseResult result;
    result.measures.push_back(
        {"bit patterns whose finiteness is not told", naive, own, 0, Gate::at_most, ""});
    result.measures.push_back(
        {"rules of arithmetic that this build lacks (NaN, -0)", kNoControl,
         (probe.nan_is_unequal ? 0.0 : 1.0) + (probe.zero_has_sign ? 0.0 : 1.0), 0, Gate::at_most,
         ""});
    return result;
}

const bool kAdded = add_case(
    {"B02", Priority::p0, "arithmetic is not relaxed", "std::isfinite under -ffinite-math-only",
     "fast-math is a compile error, finite tests look at bits, a probe at start",
     "google/filament#6558, buddhi1980/mandelbulber2#130", run});

}  // namespace
}  // namespace talbot::hardcases::b02
