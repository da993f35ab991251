// `talbot merge OUT IN...`: joins partial renders (raw films) exactly, as if one run had made them.
#pragma once

#include <span>
#include <string>

namespace talbot {

// The words after `merge`. Returns an exit code.
int run_merge(std::span<const std::string> args);

}  // namespace talbot
