// Triangle meshes, their placements and analytic spheres, as data. Angles in radians, lengths in
// metres.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/math/vec.h"

namespace talbot {

// One glTF primitive as an indexed triangle list. Attribute arrays are empty or as long as
// positions.
struct Mesh {
    std::string name;
    std::vector<Vec3f> positions;   // object space
    std::vector<Vec3f> normals;     // unit; empty means flat shading by the geometric normal
    std::vector<Vec4f> tangents;    // xyz unit, w = +-1 (bitangent = cross(n, t) * w); empty: from
                                    // texture coordinates
    std::vector<Vec2f> uv[2];       // TEXCOORD_0 and TEXCOORD_1, V down
    std::vector<Vec4f> colors;      // linear COLOR_0, clamped to 0..1
    std::vector<uint32_t> indices;  // three per triangle, each < positions.size()
    uint32_t material = 0;          // index into the material table

    uint64_t triangle_count() const { return indices.size() / 3; }
};

// One use of a mesh.
struct MeshInstance {
    uint32_t mesh = 0;
    uint32_t object = 0;           // index into the object table: what a click picks
    Mat4d world_from_object{1.0};  // affine, finite, not singular; a negative determinant mirrors
};

// An exact sphere in world coordinates.
struct Sphere {
    Vec3d center{0};
    double radius = 1;  // > 0
    uint32_t material = 0;
    uint32_t object = 0;
};

// Texture coordinates of the point of a sphere with unit outward normal n: u round +Y from -X, v
// from the top pole.
Vec2f sphere_uv(const Vec3f& n);

// What the user sees as one thing: a node of the file.
struct Object {
    std::string name;
};

}  // namespace talbot
