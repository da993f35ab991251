// `talbot compare A B`: the errors of image A against reference B, and a picture of where they are.
#pragma once

#include <span>
#include <string>

namespace talbot {

// The words after `compare`. Returns an exit code.
int run_compare(std::span<const std::string> args);

}  // namespace talbot
