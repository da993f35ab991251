#include "core/base/log.h"

#include <atomic>
#include <cstdio>
#include <string>

namespace talbot {
namespace {

std::atomic<LogLevel> current_level{LogLevel::info};

}  // namespace

void set_log_level(LogLevel level) {
    current_level.store(level);
}

LogLevel log_level() {
    return current_level.load();
}

void log(LogLevel level, std::string_view message) {
    if (level > log_level()) return;
    std::string text = "talbot: ";
    if (level == LogLevel::error) text += "error: ";
    if (level == LogLevel::warning) text += "warning: ";
    // File names and texts from files may hold line breaks and escape codes: one line stays one.
    for (const char c : message) {
        const auto byte = static_cast<unsigned char>(c);
        if (byte >= 0x20 && byte != 0x7F) {
            text += c;
        } else {
            constexpr char kDigits[] = "0123456789abcdef";
            text += "\\x";
            text += kDigits[byte >> 4];
            text += kDigits[byte & 15];
        }
    }
    text += '\n';
    std::fwrite(text.data(), 1, text.size(), stderr);
}

}  // namespace talbot
