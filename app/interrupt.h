// Ctrl-C, SIGTERM, and SIGHUP where the end of the terminal is to end the run: what they do.
#pragma once

namespace talbot {

// From here on they end the program at once, with a line and its exit code: there is nothing to
// save.
void leave_on_interrupt();

// From here on they only raise a flag: is_interrupted() is the question that long work asks.
void note_interrupts();
bool is_interrupted();

}  // namespace talbot
