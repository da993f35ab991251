// Ctrl-C as a question that long work asks.
#pragma once

namespace talbot::hardcases {

// From here on SIGINT and SIGTERM only raise the flag.
void catch_interrupts();
bool is_interrupted();

}  // namespace talbot::hardcases
