// Which instruction set traversal uses. All give the same bytes; a bug report may ask for one.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace talbot {

// Those of this machine that traversal is compiled for, the best first.
std::vector<std::string> instruction_sets_here();

// Structures built from now on use the named set (letter case ignored) or a lesser one where it has
// no code of its own. For the whole process, before anything is built; false when the machine has
// no such set.
bool use_instruction_set(std::string_view name);

}  // namespace talbot
