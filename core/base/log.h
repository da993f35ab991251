// Messages for the user: one line each, to stderr, from any thread. Workers never log in their
// loops.
#pragma once

#include <string_view>

namespace talbot {

enum class LogLevel { quiet, error, warning, info, debug };

void set_log_level(LogLevel level);
LogLevel log_level();

// Writes "talbot: [warning: ]message\n" when the level lets it through.
void log(LogLevel level, std::string_view message);
inline void log_error(std::string_view message) {
    log(LogLevel::error, message);
}
inline void log_warning(std::string_view message) {
    log(LogLevel::warning, message);
}
inline void log_info(std::string_view message) {
    log(LogLevel::info, message);
}

}  // namespace talbot
