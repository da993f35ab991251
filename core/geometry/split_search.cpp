#include "core/geometry/split_search.h"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

namespace talbot {
namespace {

uint32_t bins_of(uint64_t primitives, BuildQuality quality) {
    // Few primitives need few bins: looking through empty ones would be most of the work.
    if (quality == BuildQuality::fast)
        return static_cast<uint32_t>(std::min<uint64_t>(16, 4 + primitives / 16));
    return primitives >= 512 ? 64 : 32;
}

struct Binning {
    Float4 offset;
    Float4 scale{0, 0, 0, 0};
    float last;

    Binning(const Box& centroids, uint32_t bins)
        : offset(centroids.lower), last(static_cast<float>(bins - 1)) {
        const Float4 e = centroids.upper - centroids.lower;
        for (int i = 0; i < 3; ++i) {
            const float s = static_cast<float>(bins) / e[i];
            if (e[i] > 0 && s < kInfinity) scale[i] = s;
        }
    }
    // Bins along the three axes, as whole numbers.
    Float4 bins(const Float4& centroid) const {
        const Float4 x = (centroid - offset) * scale;
        return min4(x, Float4{last, last, last, last});
    }
};

struct Bin {
    Box box;
    uint64_t count = 0;
};

template <uint32_t kBins>
struct Bins {
    std::array<std::array<Bin, kBins>, 3> of_axis{};

    void add(std::span<const BuildPrimitive> primitives, const Binning& binning) {
        for (const BuildPrimitive& p : primitives) {
            const Float4 lower = lower_of(p);
            const Float4 upper = upper_of(p);
            const Float4 at = binning.bins(lower + upper);
            for (int axis = 0; axis < 3; ++axis) {
                Bin& bin = of_axis[static_cast<size_t>(axis)][static_cast<uint32_t>(at[axis])];
                bin.box.add(lower, upper);
                ++bin.count;
            }
        }
    }
    void add(const Bins& other) {
        for (size_t axis = 0; axis < 3; ++axis) {
            for (size_t i = 0; i < kBins; ++i) {
                of_axis[axis][i].box.add(other.of_axis[axis][i].box);
                of_axis[axis][i].count += other.of_axis[axis][i].count;
            }
        }
    }
};

template <uint32_t kBins>
Bins<kBins> fill_bins(std::span<const BuildPrimitive> primitives, const Binning& binning,
                      WorkerPool* pool) {
    Bins<kBins> bins;
    if (pool == nullptr || primitives.size() < 2 * kPieceSize) {
        bins.add(primitives, binning);
        return bins;
    }
    std::vector<Bins<kBins>> parts((primitives.size() + kPieceSize - 1) / kPieceSize);
    pool->parallel_for(parts.size(), [&](uint64_t i, unsigned) {
        const uint64_t begin = i * kPieceSize;
        const uint64_t count = std::min<uint64_t>(kPieceSize, primitives.size() - begin);
        parts[i].add(primitives.subspan(begin, count), binning);
    });
    for (const Bins<kBins>& part : parts) bins.add(part);
    return bins;
}

double common_half_area(const Box& a, const Box& b) {
    const Box common{max4(a.lower, b.lower), min4(a.upper, b.upper)};
    for (int axis = 0; axis < 3; ++axis) {
        if (!(common.lower[axis] <= common.upper[axis])) return 0;
    }
    return common.half_area();
}

template <uint32_t kBins>
SplitCost search_bins(std::span<const BuildPrimitive> primitives, uint32_t used, WorkerPool* pool,
                      Range& range) {
    const Binning binning(range.centroids, used);
    const Bins<kBins> bins = fill_bins<kBins>(primitives, binning, pool);
    SplitCost best;
    for (int axis = 0; axis < 3; ++axis) {
        if (binning.scale[axis] == 0) continue;
        const auto& row = bins.of_axis[static_cast<size_t>(axis)];
        std::array<double, kBins> right_cost{};
        Box box;
        uint64_t count = 0;
        for (uint32_t i = used - 1; i > 0; --i) {
            box.add(row[i].box);
            count += row[i].count;
            right_cost[i] = box.half_area() * static_cast<double>(blocks_of(count));
        }
        box = {};
        count = 0;
        for (uint32_t i = 1; i < used; ++i) {
            box.add(row[i - 1].box);
            count += row[i - 1].count;
            if (count == 0 || count == primitives.size()) continue;
            const double cost =
                box.half_area() * static_cast<double>(blocks_of(count)) + right_cost[i];
            if (cost < best.cost) {
                best.cost = cost;
                range.axis = axis;
                range.split_bin = i;
            }
        }
    }
    if (range.axis != Range::kNoAxis) {
        const auto& row = bins.of_axis[static_cast<size_t>(range.axis)];
        Box parts[2];
        for (uint32_t i = 0; i < used; ++i) parts[i < range.split_bin ? 0 : 1].add(row[i].box);
        best.overlap = common_half_area(parts[0], parts[1]);
    }
    return best;
}

}  // namespace

SplitCost search_split(std::span<const BuildPrimitive> primitives, BuildQuality quality,
                       WorkerPool* pool, Range& range) {
    const uint32_t used = bins_of(primitives.size(), quality);
    if (used <= 16) return search_bins<16>(primitives, used, pool, range);
    if (used <= 32) return search_bins<32>(primitives, used, pool, range);
    return search_bins<64>(primitives, used, pool, range);
}

uint64_t partition_range(std::span<BuildPrimitive> primitives, BuildQuality quality,
                         const Range& range, Range& first, Range& second) {
    const Binning binning(range.centroids, bins_of(primitives.size(), quality));
    const auto is_first = [&](const BuildPrimitive& p) {
        const Float4 at = binning.bins(lower_of(p) + upper_of(p));
        return static_cast<uint32_t>(at[range.axis]) < range.split_bin;
    };
    uint64_t i = 0;
    uint64_t j = primitives.size();
    for (;;) {
        for (; i < j && is_first(primitives[i]); ++i) first.add(primitives[i]);
        for (; i < j && !is_first(primitives[j - 1]); --j) second.add(primitives[j - 1]);
        if (i == j) return i;
        std::swap(primitives[i], primitives[j - 1]);
        first.add(primitives[i++]);
        second.add(primitives[--j]);
    }
}

}  // namespace talbot
