#include "core/geometry/tree_boxes.h"

#include <algorithm>
#include <numeric>

#include "core/geometry/bvh_accel.h"

namespace talbot {
namespace {

// A box of the top tree or, if it is of an object, of that object's.
struct Place {
    Bounds bounds;
    uint32_t object = kNoId;
    uint32_t ref = 0;
    bool is_leaf = false;
};

std::array<Vec3d, 8> corners_of(const BvhScene& scene, const Place& place) {
    Vec3d lower(place.bounds.lower);
    Vec3d upper(place.bounds.upper);
    Mat3d linear(1.0);
    Vec3d offset(0);
    if (place.object != kNoId) {
        const SceneObject& object = scene.objects[place.object];
        if (object.is_sphere) {
            lower = object.center - object.radius;
            upper = object.center + object.radius;
        } else {
            linear = glm::inverse(object.object_from_world);
            offset = object.object_from_world_offset;
        }
    }
    std::array<Vec3d, 8> corners;
    for (size_t k = 0; k < 8; ++k) {
        const Vec3d p((k & 1) != 0 ? upper.x : lower.x, (k & 2) != 0 ? upper.y : lower.y,
                      (k & 4) != 0 ? upper.z : lower.z);
        corners[k] = linear * (p - offset);
    }
    return corners;
}

double half_area(const BvhScene& scene, const Place& place) {
    const std::array<Vec3d, 8> corners = corners_of(scene, place);
    const Vec3d x = corners[1] - corners[0];
    const Vec3d y = corners[2] - corners[0];
    const Vec3d z = corners[4] - corners[0];
    return length(cross(x, y)) + length(cross(y, z)) + length(cross(z, x));
}

void add_place(const Bounds& bounds, uint32_t object, uint32_t ref, std::vector<Place>& out) {
    if (bounds.is_empty()) return;
    out.push_back({bounds, object, ref, ChildRef::is_leaf(ref) && !ChildRef::is_objects(ref)});
}

// The box of a sphere, or of all that an instance has.
void add_object(const BvhScene& scene, uint32_t index, std::vector<Place>& out) {
    const SceneObject& object = scene.objects[index];
    if (object.is_sphere) {
        out.push_back({Bounds{}, index, 0, true});
    } else if (!scene.trees[object.tree].is_empty) {
        add_place(scene.trees[object.tree].bounds, index, scene.trees[object.tree].root, out);
    }
}

void add_below(const BvhScene& scene, const Place& place, std::vector<Place>& out) {
    if (place.is_leaf) {
        out.push_back(place);
        return;
    }
    const Tree& tree =
        place.object == kNoId ? scene.top : scene.trees[scene.objects[place.object].tree];
    if (ChildRef::is_leaf(place.ref)) {
        const uint32_t first = ChildRef::first(place.ref);
        for (uint32_t k = first; k < first + ChildRef::count(place.ref); ++k)
            add_object(scene, tree.objects[k], out);
        return;
    }
    const WideNode& node = tree.nodes[place.ref];
    for (size_t i = 0; i < kNodeWidth; ++i) {
        const auto& plane = node.plane;
        add_place({Vec3f(plane[0][i], plane[2][i], plane[4][i]),
                   Vec3f(plane[1][i], plane[3][i], plane[5][i])},
                  place.object, node.child[i], out);
    }
}

// Keeps the `most` largest, in their order; of equal ones the first.
void keep_largest(const BvhScene& scene, size_t most, std::vector<Place>& places) {
    std::vector<double> areas;
    areas.reserve(places.size());
    for (const Place& place : places) areas.push_back(half_area(scene, place));
    std::vector<size_t> order(places.size());
    std::iota(order.begin(), order.end(), size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](size_t a, size_t b) { return areas[a] > areas[b]; });
    order.resize(most);
    std::sort(order.begin(), order.end());
    for (size_t i = 0; i < most; ++i) places[i] = places[order[i]];
    places.resize(most);
}

}  // namespace

TreeBoxes tree_boxes(const Accel& accel, uint32_t level, size_t most) {
    TreeBoxes found;
    const auto* bvh = dynamic_cast<const BvhAccel*>(&accel);
    if (bvh == nullptr || bvh->scene.top.is_empty) return found;
    const BvhScene& scene = bvh->scene;
    std::vector<Place> places;
    add_place(scene.top.bounds, kNoId, scene.top.root, places);
    const auto is_leaf = [](const Place& place) { return place.is_leaf; };
    for (uint32_t k = 0; k < level; ++k) {
        if (std::all_of(places.begin(), places.end(), is_leaf)) break;
        std::vector<Place> below;
        for (const Place& place : places) add_below(scene, place, below);
        places.swap(below);
        if (places.size() <= most) continue;
        keep_largest(scene, most, places);
        found.is_cut = true;
    }
    for (const Place& place : places)
        found.boxes.push_back({corners_of(scene, place), place.is_leaf});
    return found;
}

}  // namespace talbot
