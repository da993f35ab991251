// E05: random numbers must lie in [0, 1). 32 random bits times 2^-32 round up to 1 for the largest
// integers.
#include <cstdint>
#include <string>

#include "app/hardcases/hard_case.h"
#include "core/math/robust.h"
#include "core/math/sample_bits.h"

namespace talbot::hardcases::e05 {
namespace {

CaseResult run(Effort effort) {
    const uint64_t reach = effort == Effort::full ? uint64_t{1} << 32 : uint64_t{1} << 16;
    const auto is_outside = [](float u) { return !(u >= 0 && u <= kOneMinusEpsilon); };
    uint64_t naive = 0;
    uint64_t own = 0;
    const auto look = [&](uint32_t bits) {
        naive += is_outside(static_cast<float>(bits) * 0x1p-32f) ? 1 : 0;
        own += is_outside(unit_float(bits)) ? 1 : 0;
    };
    for (uint64_t i = 0; i < reach / 2; ++i) {
        look(static_cast<uint32_t>(i));
        look(~static_cast<uint32_t>(i));
    }
    CaseResult result;
    result.measures.push_back({"integers whose number is not in [0, 1), of the " +
                                   std::to_string(reach) + " nearest to either end",
                               static_cast<double>(naive), static_cast<double>(own), 0,
                               Gate::at_most, ""});
    return result;
}

const bool kAdded =
    add_case({"E05", Priority::p0, "random numbers stay below 1", "all 32 bits times 2^-32",
              "the top 24 bits times 2^-24", "AMReX-Codes/amrex#5638, cupy/cupy#1614", run});

}  // namespace
}  // namespace talbot::hardcases::e05
