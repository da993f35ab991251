#include "app/sub_command.h"

#include <CLI/CLI.hpp>
#include <algorithm>
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
    return true;
}

}  // namespace talbot
