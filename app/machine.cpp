#include "app/machine.h"

#include <fstream>

#include "core/geometry/bvh.h"

namespace talbot {
namespace {

std::string cpu_name() {
    std::ifstream info("/proc/cpuinfo");
    for (std::string line; std::getline(info, line);) {
        if (line.rfind("model name", 0) == 0) return line.substr(line.find(':') + 2);
    }
    return "unknown";
}

}  // namespace

Machine this_machine() {
#if defined(__clang__)
    const std::string compiler = "clang++ " __clang_version__;
#else
    const std::string compiler = "g++ " __VERSION__;
#endif
    return {cpu_name(), traversal_target_name(), compiler, TALBOT_BUILD_FLAGS};
}

}  // namespace talbot
