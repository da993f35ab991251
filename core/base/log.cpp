#include "core/base/log.h"

#include <atomic>
#include <cstdio>
#include <string>

namespace talbot {
namespace {

std::atomic<LogLevel> current_level{LogLevel::info};

}  // namespace

void set_log_level(LogLevel level) { current_level.store(level); }

LogLevel log_level() { return current_level.load(); }

void log(LogLevel level, std::string_view message) {
    if (level > log_level()) return;
    std::string text = "talbot: ";
    if (level == LogLevel::error) text += "error: ";
    if (level == LogLevel::warning) text += "warning: ";
    text.append(message);
    text += '\n';
    std::fwrite(text.data(), 1, text.size(), stderr);
}

}  // namespace talbot
