// The ray-triangle test of triangle.h for the four triangles of a block at once: the same
// operations in double, one lane each, so that the results are the same bits; lanes that rounding
// cannot decide are left to the scalar test. Included once per Highway target, hence the guard.
#include <cstddef>
#include <cstdint>

#include "core/geometry/bvh.h"
#include "core/geometry/lane_pack.h"
#include "core/geometry/triangle.h"

#if defined(TALBOT_BLOCK_TEST_TARGET) == defined(HWY_TARGET_TOGGLE)
#ifdef TALBOT_BLOCK_TEST_TARGET
#undef TALBOT_BLOCK_TEST_TARGET
#else
#define TALBOT_BLOCK_TEST_TARGET
#endif

HWY_BEFORE_NAMESPACE();
namespace talbot {
namespace HWY_NAMESPACE {

using Doubles = Pack<kBlockWidth, double>;

// What the test needs of a ray, along the axes kx, ky, kz.
struct BlockRay {
    Doubles ox, oy, oz;
    Doubles sx, sy;
    double sz;
    size_t x_plane, y_plane, z_plane;  // in floats from the start of a vertex

    HWY_INLINE explicit BlockRay(const ShearedRay& ray)
        : ox(Doubles::set(ray.o[ray.kx])),
          oy(Doubles::set(ray.o[ray.ky])),
          oz(Doubles::set(ray.o[ray.kz])),
          sx(Doubles::set(ray.sx)),
          sy(Doubles::set(ray.sy)),
          sz(ray.sz),
          x_plane(ray.kx * kBlockWidth),
          y_plane(ray.ky * kBlockWidth),
          z_plane(ray.kz * kBlockWidth) {}
};

// Lanes by outcome; t, u and v are those of the lanes in `hit`.
struct BlockHits {
    uint32_t hit = 0;
    uint32_t undecided = 0;
    alignas(16) float t[kBlockWidth];
    alignas(16) float u[kBlockWidth];
    alignas(16) float v[kBlockWidth];
};

// Whether any lane is left after sorting out those that the ray's line misses or meets at a t
// outside [0, t_limit].
template <bool kBarycentrics>
HWY_INLINE bool intersect_lanes(const TriangleBlock& block, const BlockRay& ray, float t_limit,
                                BlockHits& hits) {
    constexpr size_t kStride = 3 * kBlockWidth;
    const auto* start = reinterpret_cast<const float*>(&block.vertex);
    const float* px = start + ray.x_plane;
    const float* py = start + ray.y_plane;
    const float* pz = start + ray.z_plane;
    Doubles x[3];
    Doubles y[3];
    Doubles z[3];
    for (size_t i = 0; i < 3; ++i) {
        z[i] = sub(Doubles::load_floats(pz + i * kStride), ray.oz);
        x[i] = sub(sub(Doubles::load_floats(px + i * kStride), ray.ox), mul(ray.sx, z[i]));
        y[i] = sub(sub(Doubles::load_floats(py + i * kStride), ray.oy), mul(ray.sy, z[i]));
    }
    const Doubles u = sub(mul(x[2], y[1]), mul(y[2], x[1]));
    const Doubles v = sub(mul(x[0], y[2]), mul(y[0], x[2]));
    const Doubles w = sub(mul(x[1], y[0]), mul(y[1], x[0]));
    const Doubles least = min(u, min(v, w));
    const Doubles most = max(u, max(v, w));
    const Doubles extent = Doubles::load_floats(block.extent);
    const Doubles error = mul(mul(Doubles::set(kDoubleEpsilon * kEdgeErrorDepth), extent),
                              add(abs(z[0]), mul(Doubles::set(kEdgeErrorExtent), extent)));
    const uint32_t inside = either(less_equal(neg(error), least), less_equal(most, error)).bits();
    if (inside == 0) return false;

    const Doubles sum = add(add(u, v), w);
    const Doubles inverse = div(Doubles::set(1), sum);
    const Doubles depth = mul(add(add(mul(u, z[0]), mul(v, z[1])), mul(w, z[2])), inverse);
    const Doubles t = mul(depth, Doubles::set(ray.sz));
    // The limits hold in float: t is rounded before it is compared.
    t.store_floats(hits.t);
    const Pack<kBlockWidth> t_float = Pack<kBlockWidth>::load(hits.t);
    const uint32_t in_range = both(less(Pack<kBlockWidth>::set(0), t_float),
                                   less_equal(t_float, Pack<kBlockWidth>::set(t_limit)))
                                  .bits();
    const uint32_t decided =
        both(both(either(less(error, least), less(most, neg(error))),
                  less_equal(mul(Doubles::set(kWellShaped), error), abs(sum))),
             less_equal(mul(Doubles::set(kInPlaneShare), add(abs(z[0]), extent)), abs(depth)))
            .bits();
    hits.hit = inside & decided & in_range;
    hits.undecided = inside & ~decided;
    if (kBarycentrics) {
        mul(v, inverse).store_floats(hits.u);
        mul(w, inverse).store_floats(hits.v);
    }
    return (hits.hit | hits.undecided) != 0;
}

}  // namespace HWY_NAMESPACE
}  // namespace talbot
HWY_AFTER_NAMESPACE();

#endif
