// Durations, counts and percentages as short text for panels.
#pragma once

#include <cstdint>
#include <string>

namespace talbot {

// "0.42 s", "12.3 s", "3 min 20 s", "2 h 05 min", "4.1 days"; "-" for negative or non-finite input.
std::string duration_text(double seconds);

// Three significant digits and a prefix: "950", "12.4 k", "3.21 M".
std::string count_text(double count);

// Three significant digits: "12.3 %", "0.0451 %".
std::string percent_text(double percent);

}  // namespace talbot
