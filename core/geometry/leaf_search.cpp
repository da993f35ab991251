// Where the structure keeps the primitive of a hit: for debug views, one node at a time and without
// the order of real traversal.
#include <algorithm>
#include <cmath>

#include "core/geometry/bvh_accel.h"
#include "core/geometry/local_ray.h"

namespace talbot {
namespace {

class LeafSearch {
  public:
    // `number` is the triangle's in the tree, or kNoId.
    LeafSearch(const Tree& tree, const LocalRay& ray, const Hit& hit, uint32_t number)
        : tree_(tree),
          slabs_(make_slab_ray<true>(ray.sheared, tree.largest_coordinate)),
          limit_(largest_t_in_tree(hit.t, ray)),
          number_(number) {
        for (int i = 0; i < 3; ++i) backward_[i] = std::signbit(ray.sheared.d[i]);
    }

    // The leaf below `ref` that holds the primitive; `object` is its object, if it is of one.
    bool find(uint32_t ref, uint32_t depth, uint32_t object, LeafPlace& place) const {
        if (ChildRef::is_leaf(ref)) {
            if (!holds(ref, object)) return false;
            place = {depth, ref};
            return true;
        }
        const WideNode& node = tree_.nodes[ref];
        for (size_t i = 0; i < kNodeWidth; ++i) {
            if (meets(node, i) && find(node.child[i], depth + 1, object, place)) return true;
        }
        return false;
    }

  private:
    bool holds(uint32_t ref, uint32_t object) const {
        const uint32_t first = ChildRef::first(ref);
        for (uint32_t k = first; k < first + ChildRef::count(ref); ++k) {
            if (ChildRef::is_objects(ref)) {
                if (tree_.objects[k] == object) return true;
                continue;
            }
            for (const uint32_t number : tree_.blocks[k].number) {
                if (number == number_ && number != kNoId) return true;
            }
        }
        return false;
    }

    bool meets(const WideNode& node, size_t child) const {
        float enter = 0;
        float leave = limit_;
        for (size_t i = 0; i < 3; ++i) {
            const int axis = static_cast<int>(i);
            const float near = node.plane[2 * i + (backward_[i] ? 1 : 0)][child];
            const float far = node.plane[2 * i + (backward_[i] ? 0 : 1)][child];
            enter = std::max(enter, near * slabs_.reciprocal[axis] - slabs_.near_offset[axis]);
            leave = std::min(leave, far * slabs_.far_reciprocal[axis] - slabs_.far_offset[axis]);
        }
        return enter <= leave;
    }

    const Tree& tree_;
    SlabRay slabs_;
    bool backward_[3];
    float limit_;
    uint32_t number_;
};

}  // namespace

bool BvhAccel::find_leaf(const Ray& ray, const Hit& hit, LeafPlace& place) const {
    LocalRay local;
    if (scene.top.is_empty || !to_world_kernel(ray, local)) return false;
    for (uint32_t i = 0; i < scene.objects.size(); ++i) {
        const SceneObject& object = scene.objects[i];
        if (object.is_sphere != hit.is_sphere() ||
            object.id != (hit.is_sphere() ? hit.id.primitive : hit.id.instance))
            continue;
        if (!LeafSearch(scene.top, local, hit, kNoId).find(scene.top.root, 0, i, place))
            return false;
        if (object.is_sphere) return true;
        const uint32_t depth = place.depth;
        const Tree& tree = scene.trees[object.tree];
        LocalRay inside;
        if (!to_object_space(ray, object, inside)) return false;
        if (!LeafSearch(tree, inside, hit, hit.id.primitive).find(tree.root, 0, kNoId, place))
            return false;
        place.depth += depth;
        return true;
    }
    return LeafSearch(scene.top, local, hit, scene.merged.number(hit.id))
        .find(scene.top.root, 0, kNoId, place);
}

}  // namespace talbot
