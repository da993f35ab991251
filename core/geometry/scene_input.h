// Reads AccelInput the same way for the tree and for brute force: which triangles count, which
// meshes need a tree of their own, what the spheres and transformed instances are.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/geometry/accel.h"
#include "core/geometry/bvh.h"

namespace talbot {

struct StoredTriangle {
    Vec3f a{0};
    Vec3f b{0};
    Vec3f c{0};
    float extent = 0;
};

// The i-th triangle as the structure stores it; false when no ray can hit it (not looked into
// without `check`).
bool load_triangle(const AccelMesh& mesh, size_t i, StoredTriangle& triangle, bool check = true);

// Puts the triangle into a lane of a block.
void store_triangle(const StoredTriangle& triangle, uint32_t number, TriangleBlock& block,
                    uint32_t lane);

// Meshes that some instance shows under a transform, each once, in the order of first use.
std::vector<uint32_t> shared_meshes(const AccelInput& input);

// Spheres and transformed instances; `trees` gets one empty tree per shared mesh, in the order of
// shared_meshes.
std::vector<SceneObject> make_objects(const AccelInput& input, std::vector<Tree>& trees);

}  // namespace talbot
