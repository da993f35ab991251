// Puts the two levels together: triangles of identity instances, spheres and the other instances in
// the top tree, one tree for every mesh that is instanced under a transform.
#include "core/geometry/accel.h"

#include <algorithm>
#include <chrono>

#include "core/geometry/bvh_accel.h"
#include "core/geometry/bvh_build.h"
#include "core/geometry/scene_input.h"
#include "core/geometry/triangle.h"

namespace talbot {
namespace {

// Appends the boxes of a mesh's triangles, numbered from `first` on, and returns how many were
// dropped.
uint64_t add_triangles(const AccelMesh& mesh, uint32_t instance, uint32_t first,
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
        p.index = first + static_cast<uint32_t>(i);
        out.push_back(p);
    }
    return dropped;
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
    scene.merged = TriangleNumbers(input);

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

    const auto note_crowd = [&stats](const Tree& tree, uint32_t mesh) {
        if (tree.crowd <= stats.crowd) return;
        stats.crowd = tree.crowd;
        stats.crowd_mesh = mesh;
    };

    // The trees of the shared meshes, in the order of make_objects.
    HugePageVector<BuildPrimitive> primitives;
    size_t next_tree = 0;
    std::vector<uint64_t> dropped_in_tree(scene.trees.size(), 0);
    for (const uint32_t mesh_index : shared_meshes(input)) {
        const AccelMesh& mesh = input.meshes[mesh_index];
        primitives.clear();
        primitives.reserve(places_for(mesh.indices.size() / 3, input.quality));
        dropped_in_tree[next_tree] = add_triangles(mesh, kNoId, 0, primitives);
        const auto load = [&mesh](const BuildPrimitive& p) {
            StoredTriangle t;
            load_triangle(mesh, p.index, t, false);
            return t;
        };
        if (!build_tree(primitives, input.quality, load, &pool, stop, report,
                        scene.trees[next_tree]))
            return nullptr;
        note_crowd(scene.trees[next_tree], mesh_index);
        before += mesh.indices.size() / 3;
        stats.dropped_triangles += dropped_in_tree[next_tree];
        ++next_tree;
    }

    primitives.clear();
    primitives.reserve(places_for(total, input.quality));
    for (size_t i = 0; i < input.instances.size(); ++i) {
        const AccelInstance& instance = input.instances[i];
        const AccelMesh& mesh = input.meshes[instance.mesh];
        if (!instance.identity || mesh.indices.empty()) continue;
        const auto index = static_cast<uint32_t>(i);
        stats.dropped_triangles +=
            add_triangles(mesh, index, scene.merged.number({index, 0}), primitives);
    }
    for (const BuildPrimitive& box : object_boxes(input, scene)) {
        if (box.lower.x <= box.upper.x) primitives.push_back(box);
    }
    const auto load = [&](const BuildPrimitive& p) {
        StoredTriangle t;
        const PrimitiveId id = scene.merged.id(p.index);
        load_triangle(input.meshes[input.instances[id.instance].mesh], id.primitive, t, false);
        return t;
    };
    if (!build_tree(primitives, input.quality, load, &pool, stop, report, scene.top))
        return nullptr;
    if (scene.top.crowd > 0) {
        const PrimitiveId id = scene.merged.id(scene.top.crowd_number);
        note_crowd(scene.top, input.instances[id.instance].mesh);
    }

    complete(input, *accel);
    stats.build_seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    if (progress) progress(1.0f);
    return accel;
}

}  // namespace talbot
