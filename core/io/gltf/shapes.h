// The shapes that a scene shows: a mesh of the file with morph weights and a skin in one pose.
#pragma once

#include <map>
#include <utility>
#include <vector>

#include "core/io/gltf/loading.h"
#include "core/io/gltf/nodes.h"

namespace talbot::gltf {

// Nodes that show the same mesh, with the same weights and without a skin, share a shape.
struct MeshShape {
    uint32_t mesh = 0;
    std::vector<double> weights;  // of the morph targets; empty: none
    std::vector<Mat4d> joints;    // vertex to the frame of `world`; empty: no skin
    Mat4d world{1.0};             // of a skinned shape, which stands where its joints are
};

// All shapes, found one by one.
class ShapeTable {
  public:
    explicit ShapeTable(Loading& loading);

    // The shape that a node with a mesh shows. Refuses a skin that is broken.
    Result<uint32_t> shape_of(const tinygltf::Node& node);

    std::vector<MeshShape> take() { return std::move(shapes_); }
    const MeshShape& operator[](uint32_t shape) const { return shapes_[shape]; }

  private:
    Result<MeshShape> skinned(uint32_t mesh, uint32_t skin);

    Loading& loading_;
    std::vector<Mat4d> worlds_;  // of all nodes of the file; filled when the first skin is met
    std::vector<MeshShape> shapes_;
    std::map<std::pair<uint32_t, std::vector<double>>, uint32_t> plain_;  // without a skin
};

}  // namespace talbot::gltf
