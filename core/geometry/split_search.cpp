#include "core/geometry/split_search.h"

#include <algorithm>
#include <array>

namespace talbot {
namespace {

uint32_t bins_of(uint64_t primitives, BuildQuality quality) {
    if (quality == BuildQuality::fast) return 16;
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
double search_bins(std::span<const BuildPrimitive> primitives, Range& range) {
    std::array<std::array<Bin, kBins>, 3> bins{};
    const Binning binning(range.centroids, kBins);
    for (const BuildPrimitive& p : primitives) {
        const Float4 lower = lower_of(p);
        const Float4 upper = upper_of(p);
        const Float4 at = binning.bins(lower + upper);
        for (int axis = 0; axis < 3; ++axis) {
            Bin& bin = bins[static_cast<size_t>(axis)][static_cast<uint32_t>(at[axis])];
            bin.box.add(lower, upper);
            ++bin.count;
        }
    }
    double best = kInfinity;
    for (int axis = 0; axis < 3; ++axis) {
        if (binning.scale[axis] == 0) continue;
        const auto& row = bins[static_cast<size_t>(axis)];
        std::array<double, kBins> right_cost{};
        Box box;
        uint64_t count = 0;
        for (uint32_t i = kBins - 1; i > 0; --i) {
            box.add(row[i].box);
            count += row[i].count;
            right_cost[i] = box.half_area() * static_cast<double>(blocks_of(count));
        }
        box = {};
        count = 0;
        for (uint32_t i = 1; i < kBins; ++i) {
            box.add(row[i - 1].box);
            count += row[i - 1].count;
            if (count == 0 || count == primitives.size()) continue;
            const double cost =
                box.half_area() * static_cast<double>(blocks_of(count)) + right_cost[i];
            if (cost < best) {
                best = cost;
                range.axis = axis;
                range.split_bin = i;
            }
        }
    }
    return best;
}

}  // namespace

double search_split(std::span<const BuildPrimitive> primitives, BuildQuality quality,
                    Range& range) {
    switch (bins_of(primitives.size(), quality)) {
        case 16:
            return search_bins<16>(primitives, range);
        case 32:
            return search_bins<32>(primitives, range);
        default:
            return search_bins<64>(primitives, range);
    }
}

uint64_t partition_range(std::span<BuildPrimitive> primitives, BuildQuality quality,
                         const Range& range) {
    const Binning binning(range.centroids, bins_of(primitives.size(), quality));
    const auto middle =
        std::partition(primitives.begin(), primitives.end(), [&](const BuildPrimitive& p) {
            const Float4 at = binning.bins(lower_of(p) + upper_of(p));
            return static_cast<uint32_t>(at[range.axis]) < range.split_bin;
        });
    return static_cast<uint64_t>(middle - primitives.begin());
}

}  // namespace talbot
