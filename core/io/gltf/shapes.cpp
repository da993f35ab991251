// Shapes of meshes, and the matrices of a skin's joints (glTF 2.0, section 3.7.3).
#include "core/io/gltf/shapes.h"

#include <algorithm>

#include "core/io/gltf/accessor.h"
#include "core/math/robust.h"

namespace talbot::gltf {

namespace {

// The inverse bind matrix of every joint; identity when the skin has none.
Result<std::vector<Mat4d>> inverse_bind_matrices(Loading& loading, uint32_t index) {
    const tinygltf::Skin& skin = loading.document.model.skins[index];
    std::vector<Mat4d> matrices(skin.joints.size(), Mat4d(1.0));
    if (skin.inverseBindMatrices < 0) return matrices;
    const std::string element = element_name("skins", index) + ".inverseBindMatrices";
    const Result<AccessorView> view = open_accessor(loading.document, skin.inverseBindMatrices);
    if (!view) return view.error();
    if (view->components != 16 || view->component_type != TINYGLTF_COMPONENT_TYPE_FLOAT)
        return loading.document.error(element, "is not of 4 by 4 matrices of floats");
    if (view->count < matrices.size()) {
        return loading.document.error(element, "has " + std::to_string(view->count) +
                                                   " matrices for " +
                                                   std::to_string(matrices.size()) + " joints");
    }
    for (size_t j = 0; j < matrices.size(); ++j) {
        float raw[16];
        read_floats(*view, j, 1, 16, raw);
        for (int c = 0; c < 4; ++c) {
            for (int r = 0; r < 4; ++r) matrices[j][c][r] = raw[4 * c + r];
            matrices[j][c][3] = c == 3 ? 1 : 0;  // affine, whatever the last row says
        }
    }
    return matrices;
}

}  // namespace

ShapeTable::ShapeTable(Loading& loading) : loading_(loading) {}

Result<uint32_t> ShapeTable::shape_of(const tinygltf::Node& node) {
    const auto mesh = static_cast<uint32_t>(node.mesh);
    const std::vector<double>& of_mesh = loading_.document.model.meshes[mesh].weights;
    MeshShape shape;
    if (node.skin >= 0) {
        Result<MeshShape> made = skinned(mesh, static_cast<uint32_t>(node.skin));
        if (!made) return made.error();
        shape = std::move(made.value());
    }
    shape.mesh = mesh;
    shape.weights = node.weights.empty() ? of_mesh : node.weights;
    if (std::all_of(shape.weights.begin(), shape.weights.end(), [](double w) { return w == 0; }))
        shape.weights.clear();
    const auto next = static_cast<uint32_t>(shapes_.size());
    if (shape.joints.empty()) {
        const auto [same, is_new] = plain_.emplace(std::pair(mesh, shape.weights), next);
        if (!is_new) return same->second;
    }
    shapes_.push_back(std::move(shape));
    return next;
}

// Vertices are kept relative to the mean place of the joints, so that floats suffice far out.
Result<MeshShape> ShapeTable::skinned(uint32_t mesh, uint32_t skin) {
    if (worlds_.empty()) worlds_ = all_node_worlds(loading_.document);
    const std::vector<int>& joints = loading_.document.model.skins[skin].joints;
    if (joints.empty())
        return loading_.document.error(element_name("skins", skin), "has no joints");
    if (!loading_.budget.reserve(joints.size() * sizeof(Mat4d)))
        return over_budget(loading_.document, loading_.options.max_bytes);
    Result<std::vector<Mat4d>> bind = inverse_bind_matrices(loading_, skin);
    if (!bind) return bind.error();
    Vec3d center(0);
    for (const int joint : joints)
        center +=
            Vec3d(worlds_[static_cast<size_t>(joint)][3]) / static_cast<double>(joints.size());
    if (!is_finite(center)) center = Vec3d(0);
    MeshShape shape;
    shape.mesh = mesh;
    shape.world[3] = Vec4d(center, 1.0);
    for (size_t j = 0; j < joints.size(); ++j) {
        Mat4d matrix = worlds_[static_cast<size_t>(joints[j])];
        matrix[3] -= Vec4d(center, 0.0);
        shape.joints.push_back(matrix * (*bind)[j]);
    }
    return shape;
}

}  // namespace talbot::gltf
