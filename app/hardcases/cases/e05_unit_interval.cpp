// E05: random numbers must lie in [0, 1). 32 random bits times 2^-32 round up to 1 for the largest integers.
#include <algorithm>
#include <cstdint>

#include "app/hardcases/hard_case.h"
#include "core/math/sample_bits.h"

namespace talbot::hardcases {
namespace {

CaseResult run(Effort effort) {
    const uint64_t reach = effort == Effort::full ? uint64_t{1} << 32 : uint64_t{1} << 16;
    float naive_max = 0;
    float own_max = 0;
    const auto look = [&](uint32_t bits) {
        naive_max = std::max(naive_max, static_cast<float>(bits) * 0x1p-32f);
        own_max = std::max(own_max, unit_float(bits));
    };
    for (uint64_t i = 0; i < reach / 2; ++i) {
        look(static_cast<uint32_t>(i));
        look(~static_cast<uint32_t>(i));
    }
    CaseResult result;
    result.measures.push_back({"largest number from 32 random bits", naive_max, own_max,
                               1 - 0x1p-24, Gate::at_most, ""});
    return result;
}

const bool kAdded = add_case({"E05", Priority::p0, "random numbers stay below 1",
                              "all 32 bits times 2^-32", "the top 24 bits times 2^-24",
                              "AMReX-Codes/amrex#5638, cupy/cupy#1614", run});

}  // namespace
}  // namespace talbot::hardcases
