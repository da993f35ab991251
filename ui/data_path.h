// Where shaders and built-in scenes are found at run time, from any working directory.
#pragma once

#include <filesystem>
#include <string>

namespace talbot {

// The first that exists of $TALBOT_DATA_DIR/relative, <executable>/../share/talbot/relative and the
// source tree's own file; e.g. "shaders/display.frag" or "scenes/cornell.gltf". Where none exists,
// the path that was looked at last.
std::filesystem::path find_data(const std::string& relative);

// The running executable's folder; empty when the system does not tell.
std::filesystem::path executable_folder();

}  // namespace talbot
