// New boxes for the trees of moved triangles: leaves in parallel, then inner nodes from the last to
// the first, as children always come after their parents.
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <limits>

#include "core/geometry/bvh_accel.h"
#include "core/geometry/scene_input.h"
#include "core/geometry/split_search.h"
#include "core/math/robust_geometry.h"

namespace talbot {
namespace {

// A tree is built anew when rays are expected to cost this many times what they did after its
// build.
constexpr double kWorthRebuilding = 1.4;
constexpr uint64_t kNodesPerTask = 256;

Box child_box(const WideNode& node, size_t i) {
    return {Float4{node.plane[0][i], node.plane[2][i], node.plane[4][i], 0},
            Float4{node.plane[1][i], node.plane[3][i], node.plane[5][i], 0}};
}

void set_child_box(WideNode& node, size_t i, const Box& box) {
    for (size_t axis = 0; axis < 3; ++axis) {
        node.plane[2 * axis][i] = box.lower[axis];
        node.plane[2 * axis + 1][i] = box.upper[axis];
    }
}

bool is_used(uint32_t child) {
    return child != kUnusedChild;
}

// What a ray that meets the tree is expected to cost in node and block tests, by surface area.
double tree_cost(const Tree& tree) {
    double sum = 0;
    for (const WideNode& node : tree.nodes) {
        for (size_t i = 0; i < kNodeWidth; ++i) {
            const uint32_t ref = node.child[i];
            if (!is_used(ref)) continue;
            const double tests = ChildRef::is_leaf(ref) ? ChildRef::count(ref) : 1;
            sum += tests * child_box(node, i).half_area();
        }
    }
    Box root;
    const Vec3f& lo = tree.bounds.lower;
    const Vec3f& hi = tree.bounds.upper;
    root.add(Float4{lo.x, lo.y, lo.z, 0}, Float4{hi.x, hi.y, hi.z, 0});
    const double area = root.half_area();
    return area > 0 ? sum / area : 0;
}

class Refit {
  public:
    // `merged` and `objects` are for the top tree.
    Refit(const AccelInput& input, const TriangleNumbers* merged,
          const std::vector<BuildPrimitive>* objects, const std::stop_token& stop)
        : input_(input), merged_(merged), objects_(objects), stop_(stop) {}

    // False when stopped, or when the tree has become too bad. `mesh` is that of all triangles, or
    // kNoId.
    bool run(Tree& tree, uint32_t mesh, WorkerPool& pool) {
        if (stop_.stop_requested()) return false;
        if (tree.is_empty) return true;
        if (tree.built_cost == 0) tree.built_cost = tree_cost(tree);
        mesh_ = mesh;
        hittable_ = 0;
        Box whole;
        if (ChildRef::is_leaf(tree.root)) {
            whole = leaf_box(tree, tree.root);
        } else {
            const uint64_t tasks = (tree.nodes.size() + kNodesPerTask - 1) / kNodesPerTask;
            pool.parallel_for(tasks, [&](uint64_t task, unsigned) {
                if (stop_.stop_requested()) return;
                const uint64_t begin = task * kNodesPerTask;
                const uint64_t end = std::min<uint64_t>(tree.nodes.size(), begin + kNodesPerTask);
                for (uint64_t n = begin; n < end; ++n) set_leaves(tree, tree.nodes[n]);
            });
            if (stop_.stop_requested()) return false;
            std::vector<Box> boxes(tree.nodes.size());
            for (size_t n = tree.nodes.size(); n-- > 0;) {
                WideNode& node = tree.nodes[n];
                for (size_t i = 0; i < kNodeWidth; ++i) {
                    const uint32_t ref = node.child[i];
                    if (!is_used(ref)) continue;
                    if (!ChildRef::is_leaf(ref)) set_child_box(node, i, boxes[ref]);
                    boxes[n].add(child_box(node, i));
                }
            }
            whole = boxes[0];
        }
        tree.set_bounds(whole.lower, whole.upper);
        return !(tree_cost(tree) > kWorthRebuilding * tree.built_cost);
    }
    uint64_t hittable() const { return hittable_; }

  private:
    void set_leaves(Tree& tree, WideNode& node) {
        for (size_t i = 0; i < kNodeWidth; ++i) {
            const uint32_t ref = node.child[i];
            if (ChildRef::is_leaf(ref)) set_child_box(node, i, leaf_box(tree, ref));
        }
    }

    Box leaf_box(Tree& tree, uint32_t ref) {
        Box box;
        const uint32_t first = ChildRef::first(ref);
        for (uint32_t k = first; k < first + ChildRef::count(ref); ++k) {
            if (ChildRef::is_objects(ref)) {
                const BuildPrimitive& object = (*objects_)[tree.objects[k]];
                box.add(lower_of(object), upper_of(object));
            } else {
                set_block(tree.blocks[k], box);
            }
        }
        return box;
    }

    void set_block(TriangleBlock& block, Box& box) {
        uint64_t hittable = 0;
        for (uint32_t lane = 0; lane < kBlockWidth; ++lane) {
            const uint32_t number = block.number[lane];
            if (number == kNoId) continue;
            PrimitiveId id{kNoId, number};
            uint32_t mesh = mesh_;
            if (mesh == kNoId) {
                id = merged_->id(number);
                mesh = input_.instances[id.instance].mesh;
            }
            StoredTriangle t;
            if (load_triangle(input_.meshes[mesh], id.primitive, t)) {
                ++hittable;
                for (const Vec3f* v : {&t.a, &t.b, &t.c})
                    box.add(Float4{v->x, v->y, v->z, 0}, Float4{v->x, v->y, v->z, 0});
            } else {
                // Nothing meets it now, but it keeps its place.
                const Vec3f none(std::numeric_limits<float>::quiet_NaN());
                t = {none, none, none, 0};
            }
            store_triangle(t, number, block, lane);
        }
        hittable_.fetch_add(hittable, std::memory_order_relaxed);
    }

    const AccelInput& input_;
    const TriangleNumbers* merged_;
    const std::vector<BuildPrimitive>* objects_;
    const std::stop_token& stop_;
    uint32_t mesh_ = kNoId;
    std::atomic<uint64_t> hittable_{0};
};

bool has_same_parts(const BvhAccel& accel, const AccelInput& input) {
    if (accel.mesh_triangles.size() != input.meshes.size() ||
        accel.instance_meshes.size() != input.instances.size() ||
        accel.spheres != input.spheres.size())
        return false;
    for (size_t i = 0; i < input.meshes.size(); ++i) {
        if (accel.mesh_triangles[i] != input.meshes[i].indices.size() / 3) return false;
    }
    for (size_t i = 0; i < input.instances.size(); ++i) {
        const AccelInstance& instance = input.instances[i];
        if (accel.instance_meshes[i] != 2 * instance.mesh + (instance.identity ? 1 : 0))
            return false;
    }
    return true;
}

uint64_t count_hittable(const AccelMesh& mesh) {
    uint64_t count = 0;
    StoredTriangle t;
    for (size_t i = 0; i < mesh.indices.size() / 3; ++i) count += load_triangle(mesh, i, t) ? 1 : 0;
    return count;
}

// Whether all hittable triangles of a mesh, `found` of them, are in the tree that has `stored`.
bool is_complete(const AccelMesh& mesh, uint64_t stored, uint64_t found) {
    return stored == mesh.indices.size() / 3 || found == count_hittable(mesh);
}

}  // namespace

std::unique_ptr<const Accel> refit_accel(const Accel& previous, const AccelInput& input,
                                         WorkerPool& pool, std::stop_token stop) {
    const auto start = std::chrono::steady_clock::now();
    const auto* old = dynamic_cast<const BvhAccel*>(&previous);
    if (old == nullptr || !has_same_parts(*old, input)) return nullptr;
    if (old->numbers.references != old->numbers.triangles) return nullptr;
    auto accel = std::make_unique<BvhAccel>();
    BvhScene& scene = accel->scene;
    scene.objects = make_objects(input, scene.trees);
    scene.trees = old->scene.trees;
    scene.top = old->scene.top;
    scene.merged = old->scene.merged;

    uint64_t total = 0;
    uint64_t found = 0;
    Refit of_meshes(input, nullptr, nullptr, stop);
    size_t next_tree = 0;
    for (const uint32_t mesh : shared_meshes(input)) {
        Tree& tree = scene.trees[next_tree++];
        if (!of_meshes.run(tree, mesh, pool)) return nullptr;
        const uint64_t hittable = tree.is_empty ? 0 : of_meshes.hittable();
        if (!is_complete(input.meshes[mesh], tree.triangles, hittable)) return nullptr;
        total += input.meshes[mesh].indices.size() / 3;
        found += hittable;
    }
    const std::vector<BuildPrimitive> boxes = object_boxes(input, scene);
    Refit of_top(input, &scene.merged, &boxes, stop);
    if (!of_top.run(scene.top, kNoId, pool)) return nullptr;
    uint64_t in_top = 0;
    uint64_t expected = 0;
    for (const AccelInstance& instance : input.instances) {
        if (instance.identity) in_top += input.meshes[instance.mesh].indices.size() / 3;
    }
    if (in_top != scene.top.triangles) {
        for (const AccelInstance& instance : input.instances) {
            if (instance.identity) expected += count_hittable(input.meshes[instance.mesh]);
        }
        if (expected != of_top.hittable()) return nullptr;
    }
    accel->numbers.dropped_triangles =
        total + in_top - found - (scene.top.is_empty ? 0 : of_top.hittable());
    accel->numbers.crowd = old->numbers.crowd;
    accel->numbers.crowd_mesh = old->numbers.crowd_mesh;
    complete(input, *accel);
    accel->numbers.build_seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return accel;
}

}  // namespace talbot
