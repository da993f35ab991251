#include "core/geometry/bvh_accel.h"

#include <algorithm>
#include <limits>

#include "core/math/robust.h"
#include "core/math/robust_geometry.h"

namespace talbot {
namespace {

BuildPrimitive object_primitive(const Vec3d& lower, const Vec3d& upper, size_t index) {
    // Room for what becomes zero where denormals do.
    constexpr float kLeast = std::numeric_limits<float>::min();
    BuildPrimitive p;
    for (int i = 0; i < 3; ++i) {
        p.lower[i] = next_float_down(static_cast<float>(lower[i]) - kLeast);
        p.upper[i] = next_float_up(static_cast<float>(upper[i]) + kLeast);
    }
    p.instance = kObjectPrimitive;
    p.index = static_cast<uint32_t>(index);
    return p;
}

// World box of a transformed box, widened by what rounding the ray in object space can shift a hit.
BuildPrimitive instance_primitive(const Mat4d& world_from_object, const Bounds& bounds,
                                  double reach, size_t index) {
    Vec3d lower(std::numeric_limits<double>::infinity());
    Vec3d upper(-lower);
    for (int corner = 0; corner < 8; ++corner) {
        const Vec4d p((corner & 1) != 0 ? bounds.upper.x : bounds.lower.x,
                      (corner & 2) != 0 ? bounds.upper.y : bounds.lower.y,
                      (corner & 4) != 0 ? bounds.upper.z : bounds.lower.z, 1);
        const Vec3d q(world_from_object * p);
        lower = glm::min(lower, q);
        upper = glm::max(upper, q);
    }
    const double size = std::max(max_component(glm::abs(lower)), max_component(glm::abs(upper)));
    const Vec3d pad(kInstanceBoundsPad * std::max(size, reach));
    return object_primitive(lower - pad, upper + pad, index);
}

// Of the triangles beside the objects, which share their rays.
double largest_coordinate(const AccelInput& input) {
    double reach = 0;
    for (const AccelInstance& instance : input.instances) {
        if (!instance.identity) continue;
        for (const Vec3f& p : input.meshes[instance.mesh].positions) {
            const float size = max_component(glm::abs(p));
            if (size <= kMaxCoordinate) reach = std::max<double>(reach, size);
        }
    }
    return reach;
}

}  // namespace

std::vector<BuildPrimitive> object_boxes(const AccelInput& input, const BvhScene& scene) {
    std::vector<BuildPrimitive> boxes;
    if (scene.objects.empty()) return boxes;
    boxes.reserve(scene.objects.size());
    const double reach = largest_coordinate(input);
    for (size_t i = 0; i < scene.objects.size(); ++i) {
        const SceneObject& object = scene.objects[i];
        if (object.is_sphere) {
            const double size = max_component(glm::abs(object.center)) + object.radius;
            const Vec3d half(object.radius + kSphereBoundsPad * size);
            boxes.push_back(object_primitive(object.center - half, object.center + half, i));
        } else if (scene.trees[object.tree].bounds.is_empty()) {
            boxes.push_back(
                {Vec3f(kInfinity), kObjectPrimitive, Vec3f(-kInfinity), static_cast<uint32_t>(i)});
        } else {
            boxes.push_back(instance_primitive(input.instances[object.id].world_from_object,
                                               scene.trees[object.tree].bounds, reach, i));
        }
    }
    return boxes;
}

void complete(const AccelInput& input, BvhAccel& accel) {
    BvhScene& scene = accel.scene;
    AccelStats& stats = accel.numbers;
    scene.filtered.clear();
    accel.instance_meshes.clear();
    for (const AccelInstance& instance : input.instances) {
        scene.filtered.push_back(instance.filtered ? 1 : 0);
        accel.instance_meshes.push_back(2 * instance.mesh + (instance.identity ? 1 : 0));
    }
    accel.mesh_triangles.clear();
    for (const AccelMesh& mesh : input.meshes)
        accel.mesh_triangles.push_back(mesh.indices.size() / 3);
    accel.spheres = input.spheres.size();

    stats.instances = input.instances.size();
    stats.spheres = input.spheres.size();
    stats.depth = scene.top.depth;
    stats.bytes =
        scene.objects.size() * sizeof(SceneObject) + scene.merged.bytes() + scene.top.bytes();
    stats.triangles = scene.top.triangles;
    stats.references = scene.top.references;
    stats.nodes = scene.top.nodes.size();
    uint32_t deepest = 0;
    for (const Tree& tree : scene.trees) {
        stats.triangles += tree.triangles;
        stats.references += tree.references;
        stats.nodes += tree.nodes.size();
        stats.bytes += tree.bytes();
        deepest = std::max(deepest, tree.depth);
    }
    stats.depth += deepest;
    const bool has_filtered = std::any_of(input.instances.begin(), input.instances.end(),
                                          [](const AccelInstance& i) { return i.filtered; }) ||
                              std::any_of(input.spheres.begin(), input.spheres.end(),
                                          [](const AccelSphere& s) { return s.filtered; });
    accel.kernels = choose_kernels(!scene.objects.empty(), has_filtered);
}

}  // namespace talbot
