#include "app/sub_command.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <vector>

#include "app/exit_code.h"

namespace talbot {

Result<bool> parse_words(CLI::App& app, std::span<const std::string> words) {
    try {
        app.parse(std::vector<std::string>(words.rbegin(), words.rend()));
    } catch (const CLI::Success& success) {
        app.exit(success);
        return false;
    } catch (const CLI::ParseError& error) {
        std::string what = error.what();
        std::replace(what.begin(), what.end(), '\n', ' ');
        const std::string& name = app.get_name();
        const std::size_t space = name.find(' ');
        return usage_error(space == std::string::npos ? "command line" : name.substr(space + 1),
                           what + "; see " + name + " --help");
    }
    // Typically a shell variable that is not set; it must not pass for "option not given".
    for (const CLI::Option* option : app.get_options()) {
        for (const std::string& value : option->results()) {
            if (value.empty()) return usage_error(option->get_name(), "has an empty value");
        }
    }
    return true;
}

Result<uint64_t> parse_whole(const std::string& text, const std::string& option, uint64_t most) {
    uint64_t number = 0;
    const char* end = text.data() + text.size();
    const auto [stop, code] = std::from_chars(text.data(), end, number);
    if (code != std::errc{} || stop != end || number > most) {
        return usage_error(
            option, "'" + text + "' is not a whole number from 0 to " + std::to_string(most));
    }
    return number;
}

}  // namespace talbot
