// Every instruction set of this machine that traversal is compiled for, one after the other.
#pragma once

#include <hwy/highway.h>

#include <cstdint>
#include <string>
#include <vector>

namespace talbot::hardcases::geometry {

inline std::vector<int64_t> instruction_sets() {
    return hwy::SupportedAndGeneratedTargets();
}
inline std::string instruction_set_name(int64_t target) {
    return hwy::TargetName(target);
}

// While it lives, structures are built with the routines of one instruction set.
class UseInstructionSet {
  public:
    explicit UseInstructionSet(int64_t target) { hwy::SetSupportedTargetsForTest(target); }
    ~UseInstructionSet() { hwy::SetSupportedTargetsForTest(0); }
    UseInstructionSet(const UseInstructionSet&) = delete;
    UseInstructionSet& operator=(const UseInstructionSet&) = delete;
};

}  // namespace talbot::hardcases::geometry
