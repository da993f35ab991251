// The option --isa, which every command that traces rays has.
#pragma once

namespace CLI {
class App;
}

namespace talbot {

// Takes effect for the whole process as it is parsed; a set that the machine lacks is a usage
// error.
void add_isa_option(CLI::App& app);

}  // namespace talbot
