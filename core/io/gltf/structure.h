// The shape of a glTF document's JSON, checked before tinygltf sees it: nesting, arrays of objects,
// and every index within the array that it points into. After this, indices are followed without
// further tests.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string_view>

#include "core/base/result.h"

namespace talbot::gltf {

// Deepest nesting of brackets that is parsed; real files stay under 30.
inline constexpr int kMaxJsonDepth = 200;

// Whether brackets outside strings nest no deeper than kMaxJsonDepth.
bool json_depth_ok(std::string_view text);

// The error names the element, e.g. "meshes[0].primitives[1].indices", and leaves the file to the
// caller.
Status check_structure(const nlohmann::json& root);

}  // namespace talbot::gltf
