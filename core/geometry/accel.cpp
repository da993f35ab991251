// Puts the two levels together: triangles of identity instances, spheres and the other instances in
// the top tree, one tree for every mesh that is instanced under a transform.
#include "core/geometry/accel.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "core/base/check.h"
#include "core/geometry/bvh.h"
#include "core/geometry/bvh_build.h"
#include "core/geometry/scene_input.h"
#include "core/geometry/triangle.h"

namespace talbot {
namespace {

class BvhAccel final : public Accel {
  public:
    bool closest(const Ray& ray, Hit& hit) const override {
        return kernels.closest(scene, ray, hit, nullptr, nullptr);
    }
    bool closest(const Ray& ray, Hit& hit, const HitFilter& filter) const override {
        return kernels.closest_filtered(scene, ray, hit, &filter, nullptr);
    }
    bool occluded(const Ray& ray) const override { return kernels.occluded(scene, ray, nullptr); }
    bool occluded(const Ray& ray, const HitFilter& filter) const override {
        return kernels.occluded_filtered(scene, ray, &filter);
    }
    bool closest_counting(const Ray& ray, Hit& hit, uint32_t& steps) const override {
        return kernels.closest_counting(scene, ray, hit, nullptr, &steps);
    }
    const AccelStats& stats() const override { return numbers; }
    Bounds bounds() const override { return scene.top.bounds; }

    BvhScene scene;
    TraversalKernels kernels;
    AccelStats numbers;
};

void set_lane(TriangleBlock& block, uint32_t lane, const StoredTriangle& t, uint32_t instance,
              uint32_t primitive) {
    const Vec3f* corners[3] = {&t.a, &t.b, &t.c};
    for (size_t k = 0; k < 3; ++k) {
        for (size_t axis = 0; axis < 3; ++axis)
            block.vertex[k][axis][lane] = (*corners[k])[static_cast<int>(axis)];
    }
    block.extent[lane] = t.extent;
    block.primitive[lane] = primitive;
    block.instance[lane] = instance;
}

// Appends the boxes of a mesh's triangles and returns how many were dropped.
uint64_t add_triangles(const AccelMesh& mesh, uint32_t instance,
                       HugePageVector<BuildPrimitive>& out) {
    const size_t count = mesh.indices.size() / 3;
    uint64_t dropped = 0;
    for (size_t i = 0; i < count; ++i) {
        StoredTriangle t;
        if (!load_triangle(mesh, i, t)) {
            ++dropped;
            continue;
        }
        BuildPrimitive p;
        p.lower = glm::min(t.a, glm::min(t.b, t.c));
        p.upper = glm::max(t.a, glm::max(t.b, t.c));
        p.instance = instance;
        p.index = static_cast<uint32_t>(i);
        out.push_back(p);
    }
    return dropped;
}

BuildPrimitive object_primitive(const Vec3d& lower, const Vec3d& upper, size_t index) {
    BuildPrimitive p;
    for (int i = 0; i < 3; ++i) {
        p.lower[i] = next_float_down(static_cast<float>(lower[i]));
        p.upper[i] = next_float_up(static_cast<float>(upper[i]));
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

}  // namespace

std::unique_ptr<const Accel> build_accel(const AccelInput& input, WorkerPool& pool,
                                         std::stop_token stop,
                                         const std::function<void(float)>& progress) {
    const auto start = std::chrono::steady_clock::now();
    auto accel = std::make_unique<BvhAccel>();
    BvhScene& scene = accel->scene;
    AccelStats& stats = accel->numbers;
    scene.objects = make_objects(input, scene.trees);
    scene.filtered.reserve(input.instances.size());
    for (const AccelInstance& instance : input.instances)
        scene.filtered.push_back(instance.filtered ? 1 : 0);

    uint64_t total = input.spheres.size();
    std::vector<uint8_t> is_shared(input.meshes.size(), 0);
    for (const AccelInstance& instance : input.instances) {
        const uint64_t triangles = input.meshes[instance.mesh].indices.size() / 3;
        if (instance.identity || is_shared[instance.mesh] == 0) total += triangles;
        if (!instance.identity) is_shared[instance.mesh] = 1;
    }
    uint64_t before = 0;
    std::function<void(uint64_t)> report;
    if (progress) {
        report = [&](uint64_t done) {
            progress(static_cast<float>(static_cast<double>(before + done) /
                                        static_cast<double>(total)));
        };
    }

    // The trees of the shared meshes, in the order of make_objects.
    HugePageVector<BuildPrimitive> primitives;
    size_t next_tree = 0;
    std::vector<uint64_t> dropped_in_tree(scene.trees.size(), 0);
    for (const uint32_t mesh_index : shared_meshes(input)) {
        const AccelMesh& mesh = input.meshes[mesh_index];
        primitives.clear();
        dropped_in_tree[next_tree] = add_triangles(mesh, kNoId, primitives);
        const auto fill = [&mesh](const BuildPrimitive& p, TriangleBlock& block, uint32_t lane) {
            StoredTriangle t;
            load_triangle(mesh, p.index, t, false);
            set_lane(block, lane, t, kNoId, p.index);
        };
        if (!build_tree(primitives, input.quality, fill, &pool, stop, report,
                        scene.trees[next_tree]))
            return nullptr;
        before += mesh.indices.size() / 3;
        stats.dropped_triangles += dropped_in_tree[next_tree];
        ++next_tree;
    }

    primitives.clear();
    primitives.reserve(total);
    for (size_t i = 0; i < input.instances.size(); ++i) {
        const AccelInstance& instance = input.instances[i];
        if (!instance.identity) continue;
        stats.dropped_triangles +=
            add_triangles(input.meshes[instance.mesh], static_cast<uint32_t>(i), primitives);
    }
    double reach = 0;
    for (const BuildPrimitive& p : primitives) {
        reach =
            std::max<double>(reach, max_component(glm::max(glm::abs(p.lower), glm::abs(p.upper))));
    }
    for (size_t i = 0; i < scene.objects.size(); ++i) {
        const SceneObject& object = scene.objects[i];
        if (object.is_sphere) {
            primitives.push_back(
                object_primitive(object.center - object.radius, object.center + object.radius, i));
        } else if (!scene.trees[object.tree].is_empty) {
            primitives.push_back(instance_primitive(input.instances[object.id].world_from_object,
                                                    scene.trees[object.tree].bounds, reach, i));
        }
    }
    const auto fill = [&input](const BuildPrimitive& p, TriangleBlock& block, uint32_t lane) {
        StoredTriangle t;
        load_triangle(input.meshes[input.instances[p.instance].mesh], p.index, t, false);
        set_lane(block, lane, t, p.instance, p.index);
    };
    if (!build_tree(primitives, input.quality, fill, &pool, stop, report, scene.top))
        return nullptr;

    stats.instances = input.instances.size();
    stats.spheres = input.spheres.size();
    stats.depth = scene.top.depth;
    stats.bytes = scene.objects.size() * sizeof(SceneObject) + scene.top.bytes();
    stats.triangles = scene.top.triangles;
    stats.nodes = scene.top.nodes.size();
    uint32_t deepest = 0;
    for (const Tree& tree : scene.trees) {
        stats.triangles += tree.triangles;
        stats.nodes += tree.nodes.size();
        stats.bytes += tree.bytes();
        deepest = std::max(deepest, tree.depth);
    }
    stats.depth += deepest;
    const bool has_filtered = std::any_of(input.instances.begin(), input.instances.end(),
                                          [](const AccelInstance& i) { return i.filtered; }) ||
                              std::any_of(input.spheres.begin(), input.spheres.end(),
                                          [](const AccelSphere& s) { return s.filtered; });
    accel->kernels = choose_kernels(!scene.objects.empty(), has_filtered);
    stats.build_seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    if (progress) progress(1.0f);
    return accel;
}

}  // namespace talbot
