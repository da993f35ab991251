// Instances whose matrix takes space to a plane: it has no inverse, so each becomes a mesh of its
// own, whose vertices are transformed.
#pragma once

#include "core/scene/mesh.h"

namespace talbot::gltf {

// How many dimensions the linear part of a matrix leaves, up to rounding: 3 where it is regular, 2
// where it flattens things, 1 or 0 where nothing of them can be seen.
int rank_of(const Mat4d& m);

// The mesh as a matrix of rank 2 shows it, relative to the place where that takes the origin: all
// but flat, so that of two layers the one that was in front stays there. All normals are the
// plane's; the winding stays. What is seen from the side is dropped; maybe nothing is left.
Mesh flattened(const Mesh& mesh, const Mat4d& world);

// Of the arrays of flattened(mesh, ...).
uint64_t flattened_bytes(const Mesh& mesh);

}  // namespace talbot::gltf
