// What the program runs on and what built it, for records.
#pragma once

#include <string>

namespace talbot {

struct Machine {
    std::string cpu;
    std::string isa;  // that traversal chose
    std::string compiler;
    std::string flags;
};

Machine this_machine();

}  // namespace talbot
