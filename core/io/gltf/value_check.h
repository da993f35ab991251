// Values of a glTF document that have the wrong type or number of components, and transforms that
// are none. The loader takes the default where it cannot use what is written; here it is said.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace talbot::gltf {

// Appends one line for each such value, up to a limit, e.g. "nodes[3].translation: is not 3
// numbers; the default is used". The document's structure must have been checked.
void note_wrong_values(const nlohmann::json& root, std::vector<std::string>& warnings);

}  // namespace talbot::gltf
