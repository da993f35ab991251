// Runs the program under test as a user does.
#pragma once

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

namespace talbot::program {

namespace fs = std::filesystem;

struct Outcome {
    int code = -1;
    std::string output;  // of both streams
};

// `arguments` are words for a shell; `before` goes before the program, `after` behind its words.
inline Outcome run(const std::string& arguments, const std::string& before = "",
                   const std::string& after = "", int seconds = 120) {
    const std::string command = "timeout " + std::to_string(seconds) +
                                " env -u DISPLAY -u WAYLAND_DISPLAY " + before +
                                " '" TALBOT_BINARY "' " + arguments + after + " 2>&1";
    FILE* pipe = popen(command.c_str(), "r");
    Outcome outcome;
    char buffer[4096];
    for (std::size_t n = 0; (n = std::fread(buffer, 1, sizeof(buffer), pipe)) > 0;)
        outcome.output.append(buffer, n);
    const int status = pclose(pipe);
    outcome.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    return outcome;
}

// Kills it with SIGKILL after so long; true when it was still alive then.
inline bool run_and_kill(const std::vector<std::string>& arguments, double seconds) {
    std::vector<char*> words{const_cast<char*>(TALBOT_BINARY)};
    for (const std::string& a : arguments) words.push_back(const_cast<char*>(a.c_str()));
    words.push_back(nullptr);
    const pid_t child = fork();
    if (child == 0) {
        execv(words[0], words.data());
        _exit(127);
    }
    usleep(static_cast<useconds_t>(seconds * 1e6));
    const bool alive = waitpid(child, nullptr, WNOHANG) == 0;
    if (alive) {
        kill(child, SIGKILL);
        waitpid(child, nullptr, 0);
    }
    return alive;
}

// One line, that names `part`, and this exit code.
inline void expect_refused(const Outcome& outcome, int code, const std::string& part,
                           const std::string& arguments) {
    EXPECT_EQ(outcome.code, code) << arguments << "\n" << outcome.output;
    EXPECT_NE(outcome.output.find(part), std::string::npos) << outcome.output;
    EXPECT_EQ(std::count(outcome.output.begin(), outcome.output.end(), '\n'), 1) << outcome.output;
}

inline nlohmann::json read_json(const std::string& file) {
    std::ifstream in(file);
    return nlohmann::json::parse(in, nullptr, false);
}

inline std::string read_text(const std::string& file) {
    std::ifstream in(file, std::ios::binary);
    std::ostringstream text;
    text << in.rdbuf();
    return text.str();
}

// A folder that lives as long as this.
class Folder {
  public:
    explicit Folder(const std::string& name)
        : path_(fs::temp_directory_path() / ("talbot-" + name + "-" + std::to_string(getpid()))) {
        fs::create_directories(path_);
    }
    ~Folder() { fs::remove_all(path_); }
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;
    std::string operator/(const std::string& name) const { return (path_ / name).string(); }

  private:
    fs::path path_;
};

}  // namespace talbot::program
