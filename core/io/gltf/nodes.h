// The node hierarchy of one scene: which nodes are in it and where they stand in the world, in
// double.
#pragma once

#include <vector>

#include "core/io/gltf/loading.h"
#include "core/math/vec.h"

namespace talbot::gltf {

// A node placed in the world.
struct PlacedNode {
    uint32_t node = 0;
    Mat4d world{1.0};
    bool is_visible = true;     // KHR_node_visibility of the node and all above it
    Mat4d world_unscaled{1.0};  // without the node's own scale, for cameras and lights
};

// What chains of nodes are multiplied in: far excursions that lead back again would leave errors of
// more than a float's in double.
using WideMatrix = glm::mat<4, 4, long double>;

// Deepest hierarchy that is followed.
inline constexpr uint32_t kMaxNodeDepth = 1024;

// The scene named by the options (name or index), else the default, else the first; nullopt inside
// when the file has none.
Result<std::optional<size_t>> choose_scene(const Loading& loading);

// The nodes of that scene (all roots when there is none), parents before children. Refuses cycles,
// two parents and depth.
Result<std::vector<PlacedNode>> place_nodes(Loading& loading, std::optional<size_t> scene);

// Where every node of the file stands, in the scene or not; the hierarchy has been checked.
std::vector<Mat4d> all_node_worlds(const Document& document);

// Translation, rotation (x, y, z, w; normalised) and scale as a matrix.
Mat4d compose(const Vec3d& translation, const Vec4d& rotation, const Vec3d& scale);

}  // namespace talbot::gltf
