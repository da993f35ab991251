#include "app/interrupt.h"

#include <unistd.h>

#include <csignal>

#include "app/exit_code.h"

namespace talbot {
namespace {

volatile std::sig_atomic_t interrupted = 0;

void raise_flag(int) {
    interrupted = 1;
}

void leave(int) {
    constexpr char kText[] = "talbot: error: interrupted; nothing was written\n";
    [[maybe_unused]] const ssize_t written = write(STDERR_FILENO, kText, sizeof(kText) - 1);
    _exit(kExitInterrupted);
}

void catch_signals(void (*handler)(int)) {
    struct sigaction action {};
    action.sa_handler = handler;
    sigaction(SIGINT, &action, nullptr);
    sigaction(SIGTERM, &action, nullptr);
    // nohup has it ignored, so that the run outlives the terminal.
    struct sigaction before {};
    sigaction(SIGHUP, nullptr, &before);
    if (before.sa_handler != SIG_IGN) sigaction(SIGHUP, &action, nullptr);
}

}  // namespace

void leave_on_interrupt() {
    catch_signals(leave);
}

void note_interrupts() {
    catch_signals(raise_flag);
}

bool is_interrupted() {
    return interrupted != 0;
}

}  // namespace talbot
