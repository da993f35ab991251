#include "ui/data_path.h"

#include <cstdlib>
#include <system_error>

namespace talbot {
namespace {

// In the source tree the built-in scenes lie in assets/.
std::filesystem::path source_path(const std::string& relative) {
    const std::filesystem::path root(TALBOT_SOURCE_DATA_DIR);
    if (relative.starts_with("scenes/")) return root / "assets" / relative;
    return root / relative;
}

}  // namespace

std::filesystem::path executable_folder() {
    std::error_code failed;
    const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe", failed);
    return failed ? std::filesystem::path() : self.parent_path();
}

std::filesystem::path find_data(const std::string& relative) {
    std::error_code ignored;
    if (const char* folder = std::getenv("TALBOT_DATA_DIR"); folder && *folder) {
        const std::filesystem::path path = std::filesystem::path(folder) / relative;
        if (std::filesystem::exists(path, ignored)) return path;
    }
    if (const std::filesystem::path folder = executable_folder(); !folder.empty()) {
        const std::filesystem::path path = folder.parent_path() / "share" / "talbot" / relative;
        if (std::filesystem::exists(path, ignored)) return path;
    }
    return source_path(relative);
}

}  // namespace talbot
