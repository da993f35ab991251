// Single-ray traversal, compiled once for every instruction set that Highway offers. SIMD
// arithmetic here is conservative only: it discards boxes and triangles that are certainly missed,
// and the scalar tests of triangle.h and sphere.h decide. So the hits do not depend on the
// instruction set, the tree or the order of visits. References: Wald et al. 2014, "Embree: a kernel
// framework for efficient CPU ray tracing"; Ize 2013, "Robust BVH ray traversal".
// The two Highway headers come first, and lane_pack.h is read again for every target.
// clang-format off
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/geometry/traverse.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"

#include "core/geometry/bvh.h"
#include "core/geometry/local_ray.h"
#include "core/geometry/sphere.h"
#include "core/geometry/triangle.h"
#include "core/geometry/lane_pack.h"
// clang-format on

HWY_BEFORE_NAMESPACE();
namespace talbot {
namespace HWY_NAMESPACE {

using Boxes = Pack<kNodeWidth>;
using Lanes = Pack<kBlockWidth>;

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

// What a node test needs of a ray: fl(p r - c) for each plane p, with c padded apart for near and
// far planes.
struct BoxRay {
    Boxes reciprocal[3];
    Boxes near_offset[3];
    Boxes far_offset[3];
    uint32_t near_plane[3];

    HWY_INLINE BoxRay(const SlabRay& slabs) {
        for (int i = 0; i < 3; ++i) {
            reciprocal[i] = Boxes::set(slabs.reciprocal[i]);
            near_offset[i] = Boxes::set(slabs.near_offset[i]);
            far_offset[i] = Boxes::set(slabs.far_offset[i]);
            near_plane[i] = static_cast<uint32_t>(2 * i) + slabs.is_negative[i];
        }
    }
};

HWY_INLINE uint32_t hit_boxes(const WideNode& node, const BoxRay& ray, const Boxes& t_max,
                              float* t_near) {
    const auto near_t = [&](int i) HWY_ATTR {
        return mul_sub(Boxes::load(node.plane[ray.near_plane[i]]), ray.reciprocal[i],
                       ray.near_offset[i]);
    };
    const auto far_t = [&](int i) HWY_ATTR {
        return mul_sub(Boxes::load(node.plane[ray.near_plane[i] ^ 1u]), ray.reciprocal[i],
                       ray.far_offset[i]);
    };
    const Boxes enter = max(max(near_t(0), near_t(1)), max(near_t(2), Boxes::set(0)));
    const Boxes leave = min(min(far_t(0), far_t(1)), min(far_t(2), t_max));
    enter.store(t_near);
    return less_equal_bits(enter, mul(leave, Boxes::set(kSlabFarFactor)));
}

struct BlockRay {
    Lanes o[3];  // in the order kx, ky, kz
    Lanes sx, sy;
    int axis[3];

    HWY_INLINE BlockRay(const ShearedRay& ray) : axis{ray.kx, ray.ky, ray.kz} {
        for (int i = 0; i < 3; ++i) o[i] = Lanes::set(ray.o[axis[i]]);
        sx = Lanes::set(static_cast<float>(ray.sx));
        sy = Lanes::set(static_cast<float>(ray.sy));
    }
};

// Lanes whose triangle the ray may meet: all but those whose edge functions have both signs beyond
// their error.
HWY_INLINE uint32_t candidates(const TriangleBlock& block, const BlockRay& ray) {
    Lanes x[3];
    Lanes y[3];
    Lanes z0;
    for (int i = 0; i < 3; ++i) {
        const Lanes z = sub(Lanes::load(block.vertex[i][ray.axis[2]]), ray.o[2]);
        x[i] = neg_mul_add(ray.sx, z, sub(Lanes::load(block.vertex[i][ray.axis[0]]), ray.o[0]));
        y[i] = neg_mul_add(ray.sy, z, sub(Lanes::load(block.vertex[i][ray.axis[1]]), ray.o[1]));
        if (i == 0) z0 = z;
    }
    const Lanes u = mul_sub(x[2], y[1], mul(y[2], x[1]));
    const Lanes v = mul_sub(x[0], y[2], mul(y[0], x[2]));
    const Lanes w = mul_sub(x[1], y[0], mul(y[1], x[0]));
    const Lanes extent = Lanes::load(block.extent);
    const Lanes depth = mul_add(extent, Lanes::set(kEdgeErrorExtent), abs(z0));
    const Lanes error = mul_add(mul(extent, Lanes::set(kEdgeErrorDepth * kFloatEpsilon)), depth,
                                Lanes::set(kEdgeErrorFloor));
    const Lanes least = min(u, min(v, w));
    const Lanes most = max(u, max(v, w));
    return less_equal_or_bits(sub(Lanes::set(0), error), least, most, error);
}

// Tests the candidates of one block; true when an accepted hit ends the search.
template <bool kAny, bool kFilter>
HWY_INLINE bool intersect_block(Query& query, const LocalRay& ray, const TriangleBlock& block,
                                uint32_t lanes) {
    while (lanes != 0) {
        const uint32_t i = static_cast<uint32_t>(__builtin_ctz(lanes));
        lanes &= lanes - 1;
        const PrimitiveId id{ray.instance == kNoId ? block.instance[i] : ray.instance,
                             block.primitive[i]};
        if (id == query.ray.skip_from || id == query.ray.skip_to) continue;
        const auto corner = [&](int k) HWY_ATTR {
            return Vec3f(block.vertex[k][0][i], block.vertex[k][1][i], block.vertex[k][2][i]);
        };
        TriangleHit hit;
        if (!intersect_triangle(ray.sheared, corner(0), corner(1), corner(2), block.extent[i], hit))
            continue;
        const bool filtered = kFilter && query.scene.filtered[id.instance] != 0;
        if (accept<kFilter>(query, {hit.t * ray.t_scale, hit.u, hit.v, id}, filtered) && kAny)
            return true;
    }
    return false;
}

template <bool kAny, bool kFilter, bool kObjects, bool kCount>
bool traverse(Query& query, const Tree& tree, const LocalRay& ray);

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
            if (traverse<kAny, kFilter, false, kCount>(query, query.scene.trees[object.tree],
                                                       local) &&
                kAny)
                return true;
        }
    }
    return false;
}

struct StackEntry {
    uint32_t ref;
    float t;
};

// Pushes the children in `hits` so that the nearest is on top.
HWY_INLINE void push_sorted(StackEntry*& top, const WideNode& node, const float* t_near,
                            uint32_t hits) {
    StackEntry* const first = top;
    do {
        const uint32_t i = static_cast<uint32_t>(__builtin_ctz(hits));
        hits &= hits - 1;
        const StackEntry entry{node.child[i], t_near[i]};
        StackEntry* place = top++;
        for (; place != first && place[-1].t < entry.t; --place) *place = place[-1];
        *place = entry;
    } while (hits != 0);
}

template <bool kAny, bool kFilter, bool kObjects, bool kCount>
bool traverse(Query& query, const Tree& tree, const LocalRay& ray) {
    if (tree.is_empty) return false;
    const BoxRay boxes(make_slab_ray(ray, tree.bounds));
    const BlockRay lanes(ray.sheared);
    const float to_local = 1 / ray.t_scale;
    float t_max = query.best.t * to_local;
    StackEntry stack[kStackSize];
    StackEntry* top = stack;
    *top++ = {tree.root, 0};
    alignas(64) float t_near[kNodeWidth];
    while (top != stack) {
        const StackEntry entry = *--top;
        if (entry.t > t_max * kSlabFarFactor) continue;
        if (!ChildRef::is_leaf(entry.ref)) {
            if (kCount) ++query.steps;
            const WideNode& node = tree.nodes[entry.ref];
            const uint32_t hits = hit_boxes(node, boxes, Boxes::set(t_max), t_near);
            if (hits != 0) push_sorted(top, node, t_near, hits);
            continue;
        }
        if (kObjects && ChildRef::is_objects(entry.ref)) {
            if (intersect_objects<kAny, kFilter, kCount>(query, tree, entry.ref)) return true;
        } else {
            const TriangleBlock* block = tree.blocks.data() + ChildRef::first(entry.ref);
            for (uint32_t i = ChildRef::count(entry.ref); i != 0; --i, ++block) {
                const uint32_t maybe = candidates(*block, lanes);
                if (maybe != 0 && intersect_block<kAny, kFilter>(query, ray, *block, maybe))
                    return true;
            }
        }
        t_max = query.best.t * to_local;
    }
    return false;
}

template <bool kAny, bool kFilter, bool kObjects, bool kCount>
HWY_INLINE bool run(Query& query) {
    LocalRay local;
    if (!to_world_kernel(query.ray, local)) return false;
    query.best = {query.ray.t_max, 0, 0, {0, 0}};
    traverse<kAny, kFilter, kObjects, kCount>(query, query.scene.top, local);
    return query.found;
}

template <bool kFilter, bool kObjects, bool kCount>
bool closest(const BvhScene& scene, const Ray& ray, Hit& hit, const HitFilter* filter,
             uint32_t* steps) {
    Query query{scene, ray, filter, {}};
    const bool found = run<false, kFilter, kObjects, kCount>(query);
    if (kCount) *steps = query.steps;
    if (found) hit = query.best;
    return found;
}

template <bool kFilter, bool kObjects>
bool occluded(const BvhScene& scene, const Ray& ray, const HitFilter* filter) {
    Query query{scene, ray, filter, {}};
    return run<true, kFilter, kObjects, false>(query);
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
