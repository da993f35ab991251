#include "core/geometry/instruction_set.h"

#include <hwy/highway.h>

#include <algorithm>
#include <cctype>

namespace talbot {

std::vector<std::string> instruction_sets_here() {
    std::vector<std::string> names;
    for (const int64_t target : hwy::SupportedAndGeneratedTargets())
        names.emplace_back(hwy::TargetName(target));
    return names;
}

bool use_instruction_set(std::string_view name) {
    const auto same_letter = [](char a, char b) {
        return std::toupper(static_cast<unsigned char>(a)) ==
               std::toupper(static_cast<unsigned char>(b));
    };
    for (const int64_t target : hwy::SupportedAndGeneratedTargets()) {
        const std::string_view known = hwy::TargetName(target);
        if (!std::equal(name.begin(), name.end(), known.begin(), known.end(), same_letter))
            continue;
        // Better sets have lower bits.
        hwy::DisableTargets(target - 1);
        return true;
    }
    return false;
}

}  // namespace talbot
