// `talbot hardcases`: the catalogue of numerically hard cases, one row a case, each beside a naive
// control that must fail.
#pragma once

#include <span>
#include <string>

namespace talbot {

// Takes the words after `hardcases`; returns the exit code.
int run_hardcases(std::span<const std::string> args);

}  // namespace talbot
