// The program: parse, choose a driver, map its outcome to the exit code.
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <new>
#include <span>
#include <string>
#include <vector>

#include "app/accuracy.h"
#include "app/compare.h"
#include "app/effects.h"
#include "app/exit_code.h"
#include "app/hardcases/command.h"
#include "app/headless.h"
#include "app/info.h"
#include "app/merge.h"
#include "app/options.h"
#include "app/replay.h"
#include "app/window.h"

namespace talbot {
namespace {

constexpr uint64_t kFramesWithoutDisplay = 64;

bool has_display() {
    return std::getenv("DISPLAY") != nullptr || std::getenv("WAYLAND_DISPLAY") != nullptr;
}

// Where a viewer was meant but no window can be: a picture, and where it is.
int render_without_display(Options options, std::chrono::steady_clock::time_point start) {
    options.frames = kFramesWithoutDisplay;
    options.outputs = {(std::filesystem::current_path() / "talbot.png").string()};
    log_info("there is no display: rendering " + std::to_string(kFramesWithoutDisplay) +
             " passes to " + options.outputs.front());
    const int code = run_headless(options, start);
    if (code == kExitDone)
        log_info("there is no display; the picture is " + options.outputs.front());
    return code;
}

// A stream that the parent has closed would give its number to the next file that is opened, and
// messages would go into that. Writing to what stands in for it fails.
void occupy_standard_streams() {
    for (int fd = STDIN_FILENO; fd <= STDERR_FILENO; ++fd) {
        if (fcntl(fd, F_GETFD) == -1) open("/dev/null", O_RDONLY);
    }
}

int run(int argc, char** argv, std::chrono::steady_clock::time_point start) {
    const std::vector<std::string> words(argv + std::min(argc, 1), argv + argc);
    const std::string command = words.empty() ? "" : words.front();
    const std::span rest = std::span(words).subspan(words.empty() ? 0 : 1);
    if (command == "accuracy") return run_accuracy(rest);
    if (command == "compare") return run_compare(rest);
    if (command == "hardcases") return run_hardcases(rest);
    if (command == "merge") return run_merge(rest);
    const Result<std::optional<Options>> parsed = parse_options(words);
    if (!parsed) {
        log_error(parsed.error().line());
        return exit_code(parsed.error());
    }
    if (!*parsed) return kExitDone;
    const Options& options = **parsed;
    set_log_level(options.log_level);
    if (options.command == Command::info) return run_info(options);
    if (options.command == Command::effects) return run_effects(options);
    if (options.pixel) return run_replay(options);
    if (!options.interact.empty()) return run_script(options);
    if (options.headless() || !options.screenshot.empty()) return run_headless(options, start);
    if (!has_display()) return render_without_display(options, start);
    return run_window(options);
}

}  // namespace
}  // namespace talbot

int main(int argc, char** argv) {
    talbot::occupy_standard_streams();
    const auto start = std::chrono::steady_clock::now();
    try {
        const int code = talbot::run(argc, argv, start);
        // What was printed must have arrived: a full disk behind a redirection is a failure, too.
        if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return code;
        talbot::log_error("cannot write to the standard output");
        return code == talbot::kExitDone ? talbot::kExitCannotWrite : code;
    } catch (const std::bad_alloc&) {
        talbot::log_error("out of memory; try a smaller --size or scene");
    } catch (const std::exception& error) {
        talbot::log_error(error.what());
    }
    return talbot::kExitFailed;
}
