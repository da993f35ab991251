// Cameras, punctual lights and the environment of a scene.
#pragma once

#include <optional>
#include <vector>

#include "core/io/gltf/loading.h"
#include "core/io/gltf/nodes.h"

namespace talbot::gltf {

// Fills desc.cameras in the order of the file's camera array.
void place_cameras(Loading& loading, const std::vector<PlacedNode>& nodes);

// Fills desc.lights (KHR_lights_punctual). Refuses a light index that is out of range.
Status place_lights(Loading& loading, const std::vector<PlacedNode>& nodes);

// scene.extras.environment: {"color": [r, g, b]} or {"gradient": {"axis": [x, y, z], "from": [r, g,
// b], "to": [r, g, b]}}.
void read_environment(Loading& loading, std::optional<size_t> scene);

}  // namespace talbot::gltf
