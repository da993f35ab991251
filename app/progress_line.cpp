#include "app/progress_line.h"

#include <unistd.h>

#include <cstdio>

#include "core/base/log.h"

namespace talbot {

ProgressLine::ProgressLine()
    : active_(isatty(STDERR_FILENO) != 0 && log_level() >= LogLevel::info) {}

void ProgressLine::show(const std::string& text) {
    if (!active_) return;
    std::fprintf(stderr, "\r\033[K%s", text.c_str());
    std::fflush(stderr);
    shown_ = true;
}

void ProgressLine::wipe() {
    if (shown_) std::fputs("\r\033[K", stderr);
    shown_ = false;
}

void ProgressLine::keep() {
    if (shown_) std::fputc('\n', stderr);
    shown_ = false;
}

}  // namespace talbot
