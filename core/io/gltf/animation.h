// Animations, evaluated once, at the time that the user asks for: every driven property of the JSON
// gets its value before the document is read, so that no later step knows of time.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "core/io/gltf/document.h"

namespace talbot::gltf {

// Sets what the document's animations drive to its value at `seconds` (before the first key the
// first value, after the last key the last). All animations count; where two drive one property,
// the first of the file does. KHR_animation_pointer reaches nodes, materials, cameras, meshes and
// lights; targets elsewhere are named in `warnings`. Accessors are read from `document`.
Status apply_animations(const Document& document, double seconds, nlohmann::json& root,
                        std::vector<std::string>& warnings);

// What the animations change from one second to a later one: the first such property as
// "animation 'Walk' drives /nodes/3/rotation"; empty where nothing changes.
Result<std::string> moving_property(const Document& document, double from, double to);

// The last key of animation `index`, seconds; 0 when it has none.
double animation_seconds(const Document& document, size_t index);

}  // namespace talbot::gltf
