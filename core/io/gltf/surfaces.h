// What the nodes of a scene put into the world: mesh instances and analytic spheres.
#pragma once

#include <vector>

#include "core/io/gltf/loading.h"
#include "core/io/gltf/nodes.h"
#include "core/io/gltf/shapes.h"

namespace talbot::gltf {

// One use of a shape, before its primitives are loaded.
struct MeshUse {
    uint32_t shape = 0;
    uint32_t object = 0;
    Mat4d world{1.0};
    bool is_flat = false;  // world is of rank 2
};

// A sphere of a node, with the material of the scene.
struct SphereUse {
    double radius = 1;
    uint32_t material = 0;
    uint32_t object = 0;
    Mat4d world{1.0};
};

struct SurfaceUses {
    std::vector<MeshShape> shapes;
    std::vector<MeshUse> meshes;
    std::vector<SphereUse> spheres;
};

// Follows the nodes; fills desc.objects. Instances that cannot be seen (zero scale on two or three
// axes, not finite) are dropped; those that are not finite are counted.
Result<SurfaceUses> find_surfaces(Loading& loading, const std::vector<PlacedNode>& nodes);

// Fills desc.spheres; a sphere under non-uniform scale becomes an ellipsoid of triangles in
// desc.meshes, with a warning.
Status place_spheres(Loading& loading, const std::vector<SphereUse>& spheres);

}  // namespace talbot::gltf
