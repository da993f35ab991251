// The words behind `talbot` and `talbot COMMAND`: read with one wording of what is wrong with them.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "core/base/result.h"

namespace CLI {
class App;
}

namespace talbot {

// Reads the words into what `app`, of the command's whole name, was told to fill. False when help
// or the version was printed and nothing is left to do.
Result<bool> parse_words(CLI::App& app, std::span<const std::string> words);

// A whole number from 0 up to `most`, of which nothing is rounded or cut off.
Result<uint64_t> parse_whole(const std::string& text, const std::string& option, uint64_t most);

}  // namespace talbot
