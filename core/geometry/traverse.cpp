// Single-ray traversal, compiled once for every instruction set that Highway offers. SIMD
// arithmetic on boxes is conservative only; on triangles it is bit for bit that of the scalar test
// in triangle.h. So the hits do not depend on the instruction set, the tree or the order of visits.
// References: Wald et al. 2014, "Embree: a kernel
// framework for efficient CPU ray tracing"; Ize 2013, "Robust BVH ray traversal".
// The two Highway headers come first, and lane_pack.h is read again for every target.
// clang-format off
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/geometry/traverse.cpp"
#include <algorithm>
#include <bit>

#include "hwy/foreach_target.h"
#include "hwy/highway.h"

#include "core/geometry/bvh.h"
#include "core/geometry/local_ray.h"
#include "core/geometry/sphere.h"
#include "core/geometry/triangle.h"
#include "core/geometry/lane_pack.h"
#include "core/geometry/block_test.h"
// clang-format on

HWY_BEFORE_NAMESPACE();
namespace talbot {
namespace HWY_NAMESPACE {

using Boxes = Pack<kNodeWidth>;
using Lanes = Pack<kBlockWidth>;

HWY_INLINE uint32_t take_lowest(uint32_t& bits) {
    const auto i = static_cast<uint32_t>(__builtin_ctz(bits));
    bits &= bits - 1;
    return i;
}

// One call: the ray as given, the best hit so far in world t, and what decides about hits.
struct Query {
    const BvhScene& scene;
    const Ray& ray;
    const HitFilter* filter;
    Hit best;
    bool found = false;
    uint32_t steps = 0;
};

// Takes a hit into the query if it is in range, nearer (or tied with a lower id) and not refused.
template <bool kFilter>
HWY_INLINE bool accept(Query& query, const Hit& hit, bool filtered) {
    const Hit& best = query.best;
    if (!(hit.t > 0) || !(hit.t <= best.t)) return false;
    if (hit.t == best.t && !comes_before(hit.id, best.id)) return false;
    if constexpr (kFilter) {
        if (filtered && !query.filter->accepts(query.filter->context, query.ray, hit)) return false;
    }
    query.best = hit;
    query.found = true;
    return true;
}

// What a node test needs of a ray: fl(p r - c) for each plane p, with r and c apart for near and
// far planes. Kept in memory: next to the constants of the triangle test there are not registers
// enough, and spilling costs more than operands from memory.
struct alignas(64) BoxRay {
    float reciprocal[3][kNodeWidth];
    float near_offset[3][kNodeWidth];
    float far_reciprocal[3][kNodeWidth];
    float far_offset[3][kNodeWidth];
    size_t near_plane[3];  // in bytes from the lower planes of an axis: those or the upper ones

    static constexpr size_t kToUpper = kNodeWidth * sizeof(float);

    HWY_INLINE BoxRay(const ShearedRay& ray, const SlabRay& slabs) {
        for (int i = 0; i < 3; ++i) {
            Boxes::set(slabs.reciprocal[i]).store(reciprocal[i]);
            Boxes::set(slabs.near_offset[i]).store(near_offset[i]);
            Boxes::set(slabs.far_reciprocal[i]).store(far_reciprocal[i]);
            Boxes::set(slabs.far_offset[i]).store(far_offset[i]);
        }
        near_plane[0] = std::signbit(ray.d[0]) ? kToUpper : 0;
        near_plane[1] = std::signbit(ray.d[1]) ? kToUpper : 0;
        near_plane[2] = std::signbit(ray.d[2]) ? kToUpper : 0;
    }
};

// Bit i tells whether the ray meets child i before t_limit; t_near gets where it enters.
HWY_INLINE uint32_t hit_boxes(const WideNode& node, const BoxRay& ray, float t_limit,
                              float* t_near) {
    const auto plane = [&node](size_t axis, size_t offset) HWY_ATTR {
        const char* lower = reinterpret_cast<const char*>(node.plane[2 * axis]);
        return Boxes::load(reinterpret_cast<const float*>(lower + offset));
    };
    const auto at_near = [&](size_t i) HWY_ATTR {
        return mul_sub(plane(i, ray.near_plane[i]), Boxes::load(ray.reciprocal[i]),
                       Boxes::load(ray.near_offset[i]));
    };
    const auto at_far = [&](size_t i) HWY_ATTR {
        return mul_sub(plane(i, ray.near_plane[i] ^ BoxRay::kToUpper),
                       Boxes::load(ray.far_reciprocal[i]), Boxes::load(ray.far_offset[i]));
    };
    // In pairs: what the next branch waits for is short.
    const Boxes enter = max(max(Boxes::set(0), at_near(0)), max(at_near(1), at_near(2)));
    const Boxes leave = min(min(Boxes::set(t_limit), at_far(0)), min(at_far(1), at_far(2)));
    enter.store(t_near);
    return less_equal(enter, leave).bits();
}

// The scalar test, for lanes that are hard to decide.
HWY_NOINLINE bool intersect_lane(const ShearedRay& ray, const TriangleBlock& block, uint32_t lane,
                                 TriangleHit& hit) {
    return intersect_triangle(ray, BlockCorner{block, lane}, block.extent[lane], hit);
}

// Takes the hits in one block into the query; true when that ends the search.
template <bool kAny, bool kFilter>
HWY_INLINE bool intersect_block(Query& query, const LocalRay& ray, const TriangleBlock& block,
                                const BlockRay& lanes, float& t_limit) {
    constexpr bool kBarycentrics = !kAny || kFilter;
    BlockHits hits;
    if (!intersect_lanes<kBarycentrics>(block, lanes, t_limit, hits)) return false;
    uint32_t left = hits.hit | hits.undecided;
    do {
        const uint32_t i = take_lowest(left);
        const uint32_t number = block.number[i];
        const PrimitiveId id = ray.instance == kNoId ? query.scene.merged.id(number)
                                                     : PrimitiveId{ray.instance, number};
        if (id == query.ray.skip_from || id == query.ray.skip_to) continue;
        TriangleHit hit{hits.t[i], 0, 0};
        if constexpr (kBarycentrics) hit = {hits.t[i], hits.u[i], hits.v[i]};
        if ((hits.undecided >> i & 1) != 0 && !intersect_lane(ray.sheared, block, i, hit)) continue;
        const bool filtered = kFilter && query.scene.filtered[id.instance] != 0;
        if (!accept<kFilter>(query, {hit.t * ray.t_scale, hit.u, hit.v, id}, filtered)) continue;
        if (kAny) return true;
        t_limit = largest_t_in_tree(query.best.t, ray);
    } while (left != 0);
    return false;
}

template <bool kAny, bool kFilter, bool kObjects, bool kCount>
HWY_INLINE bool traverse(Query& query, const Tree& tree, const LocalRay& ray,
                         const WideNode* start);

template <bool kAny, bool kFilter, bool kCount>
HWY_NOINLINE bool intersect_objects(Query& query, const Tree& tree, uint32_t ref) {
    const uint32_t* object_ids = tree.objects.data() + ChildRef::first(ref);
    for (uint32_t i = 0; i < ChildRef::count(ref); ++i) {
        const SceneObject& object = query.scene.objects[object_ids[i]];
        if (object.is_sphere) {
            const PrimitiveId id{kSphereInstance, object.id};
            float t[2];
            const int count = sphere_hits(query.ray, id == query.ray.skip_from,
                                          id == query.ray.skip_to, object.center, object.radius, t);
            for (int k = 0; k < count; ++k) {
                if (accept<kFilter>(query, {t[k], 0, 0, id}, object.filtered) && kAny) return true;
            }
        } else {
            LocalRay local;
            if (!to_object_space(query.ray, object, local)) continue;
            if (traverse<kAny, kFilter, false, kCount>(query, query.scene.trees[object.tree], local,
                                                       nullptr) &&
                kAny)
                return true;
        }
    }
    return false;
}

// Makes the compiler forget copies of an object in registers.
template <class T>
HWY_INLINE void keep_in_memory(const T& object) {
#if defined(__GNUC__)
    asm volatile("" : : "r"(&object) : "memory");
#endif
}

// A child and where the ray enters it, in one integer that sorts by distance: distances are not
// negative.
using StackEntry = uint64_t;

HWY_INLINE StackEntry make_entry(const WideNode& node, const float* t_near, uint32_t child) {
    return static_cast<uint64_t>(std::bit_cast<uint32_t>(t_near[child])) << 32 | node.child[child];
}
HWY_INLINE uint32_t entry_ref(StackEntry entry) {
    return static_cast<uint32_t>(entry);
}
HWY_INLINE float entry_t(StackEntry entry) {
    return std::bit_cast<float>(static_cast<uint32_t>(entry >> 32));
}

HWY_INLINE void order(StackEntry& nearer, StackEntry& farther) {
    const StackEntry a = nearer;
    const StackEntry b = farther;
    nearer = a < b ? a : b;
    farther = a < b ? b : a;
}

// Asks for the cache lines of a child, inner node or block, while its siblings are still looked at.
HWY_INLINE void prefetch(const Tree& tree, uint32_t ref) {
    if (!tree.outgrows_cache) return;
    const char* at = ChildRef::is_leaf(ref)
                         ? reinterpret_cast<const char*>(tree.blocks.data() + ChildRef::first(ref))
                         : reinterpret_cast<const char*>(tree.nodes.data() + ref);
    __builtin_prefetch(at);
    __builtin_prefetch(at + 64);
    __builtin_prefetch(at + 128);
    __builtin_prefetch(at + 192);
}

// The nearest child; the others are pushed, nearest on top.
HWY_INLINE StackEntry push_others(const Tree& tree, StackEntry*& top, const WideNode& node,
                                  const float* t_near, uint32_t hits) {
    StackEntry a = make_entry(node, t_near, take_lowest(hits));
    prefetch(tree, entry_ref(a));
    if (hits == 0) return a;
    StackEntry b = make_entry(node, t_near, take_lowest(hits));
    prefetch(tree, entry_ref(b));
    order(a, b);
    if (hits == 0) {
        *top++ = b;
        return a;
    }
    StackEntry c = make_entry(node, t_near, take_lowest(hits));
    prefetch(tree, entry_ref(c));
    order(b, c);
    order(a, b);
    if (hits == 0) {
        top[0] = c;
        top[1] = b;
        top += 2;
        return a;
    }
    StackEntry* const first = top;
    top[0] = c;
    top[1] = b;
    top[2] = a;
    top += 3;
    do {
        const StackEntry entry = make_entry(node, t_near, take_lowest(hits));
        prefetch(tree, entry_ref(entry));
        StackEntry* place = top++;
        for (; place != first && place[-1] < entry; --place) *place = place[-1];
        *place = entry;
    } while (hits != 0);
    return *--top;
}

// All children in the order of the node, for searches that any hit ends: they need no distances.
HWY_INLINE StackEntry push_all(const Tree& tree, StackEntry*& top, const WideNode& node,
                               uint32_t hits) {
    for (;;) {
        const uint32_t ref = node.child[take_lowest(hits)];
        prefetch(tree, ref);
        if (hits == 0) return ref;
        *top++ = ref;
    }
}

template <bool kAny, bool kFilter, bool kObjects, bool kCount>
HWY_INLINE bool traverse(Query& query, const Tree& tree, const LocalRay& ray,
                         const WideNode* start) {
    if (tree.is_empty) return false;
    const BoxRay boxes(ray.sheared, make_slab_ray<kObjects>(ray.sheared, tree.largest_coordinate));
    const BlockRay lanes(ray.sheared);
    float t_limit = largest_t_in_tree(query.best.t, ray);
    StackEntry stack[kStackSize];
    StackEntry* top = stack;
    StackEntry entry = tree.root;
    alignas(64) float t_near[kNodeWidth];
    if (start != nullptr) {
        const uint32_t hits = hit_boxes(*start, boxes, t_limit, t_near);
        if (hits == 0) return false;
        entry = push_others(tree, top, *start, t_near, hits);
    }
    for (;;) {
        while (!ChildRef::is_leaf(entry_ref(entry))) {
            if (kCount) ++query.steps;
            const WideNode& node = tree.nodes[entry_ref(entry)];
            const uint32_t hits = hit_boxes(node, boxes, t_limit, t_near);
            if (hits == 0) goto pop;
            entry =
                kAny ? push_all(tree, top, node, hits) : push_others(tree, top, node, t_near, hits);
        }
        keep_in_memory(boxes);
        if (kObjects && ChildRef::is_objects(entry_ref(entry))) {
            if (intersect_objects<kAny, kFilter, kCount>(query, tree, entry_ref(entry)))
                return true;
            t_limit = largest_t_in_tree(query.best.t, ray);
        } else {
            const TriangleBlock* block = tree.blocks.data() + ChildRef::first(entry_ref(entry));
            const TriangleBlock* const end = block + ChildRef::count(entry_ref(entry));
            do {
                keep_in_memory(lanes);
                if (intersect_block<kAny, kFilter>(query, ray, *block, lanes, t_limit)) return true;
            } while (++block != end);
        }
    pop:
        do {
            if (top == stack) return false;
            entry = *--top;
        } while (!kAny && entry_t(entry) > t_limit);
    }
}

template <bool kAny, bool kFilter, bool kObjects, bool kCount>
HWY_INLINE bool run(Query& query, const WideNode* start) {
    LocalRay local;
    if (!to_world_kernel(query.ray, local)) return false;
    local.instance = query.scene.merged.only_instance();
    query.best = {query.ray.t_max, 0, 0, {0, 0}};
    traverse<kAny, kFilter, kObjects, kCount>(query, query.scene.top, local, start);
    return query.found;
}

template <bool kFilter, bool kObjects, bool kCount>
bool closest(const BvhScene& scene, const Ray& ray, Hit& hit, const HitFilter* filter,
             uint32_t* steps, const WideNode* entry) {
    Query query{scene, ray, filter, {}};
    const bool found = run<false, kFilter, kObjects, kCount>(query, entry);
    if (kCount) *steps = query.steps;
    if (found) hit = query.best;
    return found;
}

template <bool kFilter, bool kObjects>
bool occluded(const BvhScene& scene, const Ray& ray, const HitFilter* filter) {
    Query query{scene, ray, filter, {}};
    return run<true, kFilter, kObjects, false>(query, nullptr);
}

template <bool kObjects>
HWY_INLINE TraversalKernels kernels_of(bool has_filtered) {
    TraversalKernels kernels;
    kernels.closest = &closest<false, kObjects, false>;
    kernels.closest_counting = &closest<false, kObjects, true>;
    kernels.occluded = &occluded<false, kObjects>;
    kernels.closest_filtered = has_filtered ? &closest<true, kObjects, false> : kernels.closest;
    kernels.occluded_filtered = has_filtered ? &occluded<true, kObjects> : kernels.occluded;
    return kernels;
}

TraversalKernels kernels_for(bool has_objects, bool has_filtered) {
    return has_objects ? kernels_of<true>(has_filtered) : kernels_of<false>(has_filtered);
}

const char* target_name() {
    return hwy::TargetName(HWY_TARGET);
}

}  // namespace HWY_NAMESPACE
}  // namespace talbot
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace talbot {

HWY_EXPORT(kernels_for);
HWY_EXPORT(target_name);

TraversalKernels choose_kernels(bool has_objects, bool has_filtered) {
    return HWY_DYNAMIC_DISPATCH(kernels_for)(has_objects, has_filtered);
}

const char* traversal_target_name() {
    return HWY_DYNAMIC_DISPATCH(target_name)();
}

}  // namespace talbot
#endif
