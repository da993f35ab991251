#include "core/geometry/spatial_split.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "core/math/robust_geometry.h"

namespace talbot {
namespace {

constexpr uint32_t kPlanes = 16;    // bins along an axis, at most
constexpr uint32_t kFewPlanes = 8;  // for fewer primitives than
constexpr uint64_t kFewPrimitives = 64;
constexpr float kAlmostAll = 0.9f;        // of a box's extent
constexpr uint64_t kCutPieceSize = 8192;  // primitives that a worker takes at a time

bool is_empty(const Box& box) {
    return !(box.lower[0] <= box.upper[0] && box.lower[1] <= box.upper[1] &&
             box.lower[2] <= box.upper[2]);
}

// Equal parts of a box along each axis.
struct Slices {
    uint32_t count;
    Float4 lower;
    Float4 width{0, 0, 0, 0};
    Float4 scale{0, 0, 0, 0};  // 0: not to be split along this axis
    Float4 most;               // almost the box's extents

    Slices(const Box& box, uint64_t primitives)
        : count(primitives < kFewPrimitives ? kFewPlanes : kPlanes),
          lower(box.lower),
          most(kAlmostAll * (box.upper - box.lower)) {
        for (int i = 0; i < 3; ++i) {
            const float extent = box.upper[i] - box.lower[i];
            const float s = static_cast<float>(count) / extent;
            if (!(extent > kMinSplitExtent && s < kInfinity)) continue;
            scale[i] = s;
            width[i] = extent / static_cast<float>(count);
        }
    }
    uint32_t first_of(float at, int axis) const {
        return static_cast<uint32_t>(
            std::clamp((at - lower[axis]) * scale[axis], 0.0f, static_cast<float>(count - 1)));
    }
    // The slice that ends a box: one that begins where the box ends does not count.
    uint32_t last_of(float at, int axis, uint32_t first) const {
        const float slice = std::ceil((at - lower[axis]) * scale[axis]) - 1;
        const auto last =
            static_cast<uint32_t>(std::clamp(slice, 0.0f, static_cast<float>(count - 1)));
        return std::max(first, last);
    }
    float plane(uint32_t slice, int axis) const {
        return lower[axis] + static_cast<float>(slice) * width[axis];
    }
};

// Flat, and all but as large as the box that is split: it stays whole and goes where its middle is,
// for its parts would have as much surface together and fill every leaf below. Splits by centroids
// soon give it a leaf of its own.
bool is_ground(const BuildPrimitive& p, const Slices& slices) {
    bool is_flat = false;
    for (int i = 0; i < 3; ++i) {
        const float extent = p.upper[i] - p.lower[i];
        if (extent == 0) is_flat = true;
        if (extent > 0 && extent < slices.most[i]) return false;
    }
    return is_flat;
}

// The first and the last slice of a primitive.
std::pair<uint32_t, uint32_t> slices_of(const BuildPrimitive& p, const Slices& slices, int axis) {
    if (is_ground(p, slices)) {
        const uint32_t middle = slices.first_of(0.5f * p.lower[axis] + 0.5f * p.upper[axis], axis);
        return {middle, middle};
    }
    const uint32_t first = slices.first_of(p.lower[axis], axis);
    return {first, slices.last_of(p.upper[axis], axis, first)};
}

struct Slice {
    Box box;
    uint64_t enter = 0;  // primitives whose first slice this is
    uint64_t leave = 0;  // and whose last
};

Box box_of(const BuildPrimitive& p) {
    return {lower_of(p), upper_of(p)};
}

void set_box(BuildPrimitive& p, const Box& box) {
    for (int i = 0; i < 3; ++i) {
        p.lower[i] = box.lower[i];
        p.upper[i] = box.upper[i];
    }
}

Float4 float4(const Vec3f& v) {
    return Float4{v.x, v.y, v.z, 0};
}

// Room for what clipping, the rounding of a hit and its float t may be off.
Box padded(const Box& box, float extent) {
    const Float4 zero{0, 0, 0, 0};
    const Float4 pad = zero + extent * kSplitPad;
    return {box.lower - (pad + kSplitRounding * max4(box.lower, zero - box.lower)),
            box.upper + (pad + kSplitRounding * max4(box.upper, zero - box.upper))};
}

using SliceRows = std::array<std::array<Slice, kPlanes>, 3>;

void add_to_slices(std::span<const BuildPrimitive> primitives, const LoadTriangle& load,
                   const Slices& slices, SliceRows& rows) {
    for (const BuildPrimitive& p : primitives) {
        StoredTriangle triangle;
        bool loaded = false;
        for (int axis = 0; axis < 3; ++axis) {
            if (slices.scale[axis] == 0) continue;
            auto& row = rows[static_cast<size_t>(axis)];
            const auto [begin, last] = slices_of(p, slices, axis);
            ++row[begin].enter;
            ++row[last].leave;
            Box rest = box_of(p);
            if (begin != last && !loaded) {
                triangle = load(p);
                loaded = true;
            }
            for (uint32_t i = begin; i < last && !is_empty(rest); ++i) {
                Box part;
                Box next;
                cut_triangle(triangle, rest, axis, slices.plane(i + 1, axis), part, next);
                row[i].box.add(part);
                rest = next;
            }
            row[last].box.add(rest);
        }
    }
}

SliceRows fill_slices(std::span<const BuildPrimitive> primitives, const LoadTriangle& load,
                      const Slices& slices, WorkerPool* pool) {
    SliceRows rows{};
    if (pool == nullptr || primitives.size() < 2 * kCutPieceSize) {
        add_to_slices(primitives, load, slices, rows);
        return rows;
    }
    std::vector<SliceRows> pieces((primitives.size() + kCutPieceSize - 1) / kCutPieceSize);
    pool->parallel_for(pieces.size(), [&](uint64_t i, unsigned) {
        const uint64_t begin = i * kCutPieceSize;
        const uint64_t count = std::min<uint64_t>(kCutPieceSize, primitives.size() - begin);
        add_to_slices(primitives.subspan(begin, count), load, slices, pieces[i]);
    });
    for (const SliceRows& piece : pieces) {
        for (size_t axis = 0; axis < 3; ++axis) {
            for (size_t i = 0; i < kPlanes; ++i) {
                rows[axis][i].box.add(piece[axis][i].box);
                rows[axis][i].enter += piece[axis][i].enter;
                rows[axis][i].leave += piece[axis][i].leave;
            }
        }
    }
    return rows;
}

}  // namespace

void cut_triangle(const StoredTriangle& triangle, const Box& box, int axis, float plane, Box& first,
                  Box& second) {
    first = {};
    second = {};
    const Float4 corners[3] = {float4(triangle.a), float4(triangle.b), float4(triangle.c)};
    for (int k = 0; k < 3; ++k) {
        const Float4& a = corners[k];
        const Float4& b = corners[(k + 1) % 3];
        if (a[axis] <= plane) first.add(a, a);
        if (a[axis] >= plane) second.add(a, a);
        if ((a[axis] < plane && b[axis] > plane) || (a[axis] > plane && b[axis] < plane)) {
            const float share = (plane - a[axis]) / (b[axis] - a[axis]);
            Float4 p = a + share * (b - a);
            p[axis] = plane;
            first.add(p, p);
            second.add(p, p);
        }
    }
    for (Box* part : {&first, &second}) {
        *part = padded(*part, triangle.extent);
        part->lower = max4(part->lower, box.lower);
        part->upper = min4(part->upper, box.upper);
        if (is_empty(*part)) *part = {};
    }
}

SpatialSplit search_spatial_split(std::span<const BuildPrimitive> primitives,
                                  const LoadTriangle& load, WorkerPool* pool, const Range& range) {
    const Slices slices(range.box, range.size());
    const SliceRows bins = fill_slices(primitives, load, slices, pool);
    SpatialSplit best;
    for (int axis = 0; axis < 3; ++axis) {
        if (slices.scale[axis] == 0) continue;
        const auto& row = bins[static_cast<size_t>(axis)];
        std::array<double, kPlanes> second_cost{};
        std::array<uint64_t, kPlanes> second_count{};
        Box box;
        uint64_t count = 0;
        for (uint32_t i = slices.count - 1; i > 0; --i) {
            box.add(row[i].box);
            count += row[i].leave;
            second_count[i] = count;
            second_cost[i] = box.half_area() * static_cast<double>(blocks_of(count));
        }
        box = {};
        count = 0;
        for (uint32_t i = 1; i < slices.count; ++i) {
            box.add(row[i - 1].box);
            count += row[i - 1].enter;
            // Both parts must be smaller than the whole.
            if (count == 0 || second_count[i] == 0 || count == primitives.size() ||
                second_count[i] == primitives.size())
                continue;
            const double cost =
                box.half_area() * static_cast<double>(blocks_of(count)) + second_cost[i];
            if (cost < best.cost)
                best = {cost, axis, i, count + second_count[i] - primitives.size()};
        }
    }
    return best;
}

bool partition_spatially(std::span<BuildPrimitive> primitives, const LoadTriangle& load,
                         const Range& range, Range& first, Range& second) {
    const Slices slices(range.box, range.size());
    const float plane = slices.plane(range.split_bin, range.axis);
    uint64_t i = 0;
    uint64_t j = range.size();
    uint64_t end = j;
    while (i < j) {
        BuildPrimitive& p = primitives[i];
        const auto [begin, last] = slices_of(p, slices, range.axis);
        bool is_first = last < range.split_bin;
        if (!is_first && begin < range.split_bin) {
            Box parts[2];
            cut_triangle(load(p), box_of(p), range.axis, plane, parts[0], parts[1]);
            is_first = !is_empty(parts[0]);
            if (is_first && !is_empty(parts[1])) {
                primitives[end] = p;
                set_box(primitives[end], parts[1]);
                second.add(primitives[end++]);
                set_box(p, parts[0]);
            }
        }
        if (is_first) {
            first.add(p);
            ++i;
        } else {
            second.add(p);
            std::swap(p, primitives[--j]);
        }
    }
    first.begin = range.begin;
    first.end = second.begin = range.begin + j;
    second.end = range.begin + end;
    return j > 0 && j < end;
}

}  // namespace talbot
