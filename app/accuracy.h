// `talbot accuracy`: what accuracy costs on a scene, and the proof that the stated errors are true.
#pragma once

#include <span>
#include <string>

namespace talbot {

// The words after `accuracy`. Returns an exit code.
int run_accuracy(std::span<const std::string> args);

// The words after `accuracy certify`. Exit code 1 when a promise is broken.
int run_certify(std::span<const std::string> args);

// The words after `accuracy ab`.
int run_ab(std::span<const std::string> args);

}  // namespace talbot
