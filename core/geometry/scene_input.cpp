#include "core/geometry/scene_input.h"

#include <algorithm>

#include "core/base/check.h"
#include "core/geometry/triangle.h"
#include "core/math/robust.h"

namespace talbot {

bool load_triangle(const AccelMesh& mesh, size_t i, StoredTriangle& triangle, bool check) {
    Vec3f corners[3];
    for (size_t k = 0; k < 3; ++k) {
        const uint32_t index = mesh.indices[3 * i + k];
        TALBOT_CHECK(index < mesh.positions.size());
        corners[k] = stored_vertex(mesh.positions[index]);
    }
    if (check && !is_hittable(corners[0], corners[1], corners[2])) return false;
    triangle = {corners[0], corners[1], corners[2],
                triangle_extent(corners[0], corners[1], corners[2])};
    return true;
}

void store_triangle(const StoredTriangle& triangle, uint32_t number, TriangleBlock& block,
                    uint32_t lane) {
    const Vec3f* corners[3] = {&triangle.a, &triangle.b, &triangle.c};
    for (size_t k = 0; k < 3; ++k) {
        for (size_t axis = 0; axis < 3; ++axis)
            block.vertex[k][axis][lane] = (*corners[k])[static_cast<int>(axis)];
    }
    block.extent[lane] = triangle.extent;
    block.number[lane] = number;
}

TriangleNumbers::TriangleNumbers(const AccelInput& input) {
    uint64_t first = 0;
    for (size_t i = 0; i < input.instances.size(); ++i) {
        const AccelInstance& instance = input.instances[i];
        const uint64_t triangles = input.meshes[instance.mesh].indices.size() / 3;
        if (!instance.identity || triangles == 0) continue;
        const auto part = static_cast<uint32_t>(parts_.size());
        parts_.push_back({static_cast<uint32_t>(first), static_cast<uint32_t>(i)});
        first += triangles;
        TALBOT_CHECK(first < kNoId);
        while (pages_.size() << kPageShift < first) pages_.push_back(part);
    }
    if (parts_.size() == 1) only_instance_ = parts_[0].instance;
    parts_.push_back({static_cast<uint32_t>(first), kNoId});
}

uint32_t TriangleNumbers::number(const PrimitiveId& id) const {
    const auto part =
        std::lower_bound(parts_.begin(), parts_.end(), id.instance,
                         [](const Part& p, uint32_t instance) { return p.instance < instance; });
    if (part == parts_.end() || part->instance != id.instance || id.instance == kNoId) return kNoId;
    return part->first + id.primitive;
}

std::vector<uint32_t> shared_meshes(const AccelInput& input) {
    std::vector<uint32_t> meshes;
    std::vector<uint8_t> seen(input.meshes.size(), 0);
    for (const AccelInstance& instance : input.instances) {
        TALBOT_CHECK(instance.mesh < input.meshes.size());
        if (instance.identity || seen[instance.mesh] != 0) continue;
        seen[instance.mesh] = 1;
        meshes.push_back(instance.mesh);
    }
    return meshes;
}

std::vector<SceneObject> make_objects(const AccelInput& input, std::vector<Tree>& trees) {
    const std::vector<uint32_t> meshes = shared_meshes(input);
    std::vector<uint32_t> tree_of_mesh(input.meshes.size(), kNoId);
    for (size_t i = 0; i < meshes.size(); ++i) tree_of_mesh[meshes[i]] = static_cast<uint32_t>(i);
    trees.resize(meshes.size());

    std::vector<SceneObject> objects;
    for (size_t i = 0; i < input.spheres.size(); ++i) {
        const AccelSphere& sphere = input.spheres[i];
        TALBOT_CHECK(is_finite(sphere.center) && is_finite(sphere.radius) && sphere.radius >= 0);
        TALBOT_CHECK(max_component(glm::abs(sphere.center)) <= kMaxCoordinate &&
                     sphere.radius <= kMaxCoordinate);
        SceneObject object;
        object.is_sphere = true;
        object.filtered = sphere.filtered;
        object.id = static_cast<uint32_t>(i);
        object.center = sphere.center;
        object.radius = sphere.radius;
        objects.push_back(object);
    }
    for (size_t i = 0; i < input.instances.size(); ++i) {
        const AccelInstance& instance = input.instances[i];
        if (instance.identity) continue;
        const Mat3d linear(instance.world_from_object);
        const Vec3d offset(instance.world_from_object[3]);
        const Mat3d inverse = glm::inverse(linear);
        SceneObject object;
        object.filtered = instance.filtered;
        object.id = static_cast<uint32_t>(i);
        object.tree = tree_of_mesh[instance.mesh];
        object.object_from_world = inverse;
        object.object_from_world_offset = -(inverse * offset);
        TALBOT_CHECK(is_finite(offset) && is_finite(object.object_from_world_offset));
        for (int column = 0; column < 3; ++column) TALBOT_CHECK(is_finite(inverse[column]));
        objects.push_back(object);
    }
    return objects;
}

}  // namespace talbot
