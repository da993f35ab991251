// E06: sample indices beyond 32 bits, dimensions beyond any table, products of sizes beyond 32
// bits.
#include <algorithm>
#include <bit>
#include <set>
#include <utility>
#include <vector>

#include "app/hardcases/worst.h"
#include "core/film/film.h"
#include "core/integrate/sampler.h"

namespace talbot::hardcases::e06 {
namespace {

using Point = std::pair<float, float>;

Point point_of(const Sampler& sampler, uint32_t pair) {
    const Vec2f p = sampler.pair(pair);
    return {p.x, p.y};
}

// A sampler whose index has 32 bits.
Point wrapped_point(uint64_t index, uint32_t pair) {
    return point_of(Sampler(SamplerKind::sobol, 0, 3, 5, static_cast<uint32_t>(index)), pair);
}

// Points of a window round `middle` that the first points of the sequence had already.
double repeats(uint64_t middle, uint64_t reach, bool wrapped) {
    std::set<Point> seen;
    double count = 0;
    const auto point = [&](uint64_t index) {
        return wrapped ? wrapped_point(index, 2)
                       : point_of(Sampler(SamplerKind::sobol, 0, 3, 5, index), 2);
    };
    for (uint64_t i = 0; i < reach; ++i) seen.insert(point(i));
    for (uint64_t i = middle - reach; i < middle + reach; ++i)
        count += seen.insert(point(i)).second ? 0 : 1;
    return count;
}

// Cells of all elementary partitions of 2^log_count points from `first` that do not hold one point.
double empty_intervals(SamplerKind kind, uint64_t first, uint32_t log_count, uint32_t pair) {
    const uint32_t count = 1u << log_count;
    std::vector<Point> points;
    for (uint32_t i = 0; i < count; ++i)
        points.push_back(point_of(Sampler(kind, 7, 11, 13, first + i), pair));
    double wrong = 0;
    for (uint32_t split = 0; split <= log_count; ++split) {
        std::vector<int> cells(count, 0);
        for (const Point& p : points) {
            const auto column = static_cast<uint32_t>(p.first * static_cast<float>(1u << split));
            const auto row =
                static_cast<uint32_t>(p.second * static_cast<float>(1u << (log_count - split)));
            ++cells[(row << split) + column];
        }
        wrong += static_cast<double>(
            std::count_if(cells.begin(), cells.end(), [](int n) { return n != 1; }));
    }
    return wrong;
}

CaseResult run(Effort effort) {
    const uint64_t reach = effort == Effort::full ? 1u << 18 : 1u << 12;
    CaseResult result;
    Worst naive, own;
    for (const uint64_t middle : {uint64_t{1} << 32, uint64_t{1} << 52}) {
        const auto where = [&] { return "indices round " + std::to_string(middle); };
        naive.add(repeats(middle, reach, true), where);
        own.add(repeats(middle, reach, false), where);
    }
    result.measures.push_back({"points repeated past indices of 2^32 and 2^52", naive.figure,
                               own.figure, 0, Gate::at_most, own.where});

    Worst intervals, independent;
    for (const uint64_t first :
         {uint64_t{0}, (uint64_t{1} << 32) - 256, uint64_t{1} << 32, uint64_t{1} << 52}) {
        for (const uint32_t pair : {0u, 1u, 1000u, 100000u}) {
            const auto where = [&] {
                return "from index " + std::to_string(first) + ", pair " + std::to_string(pair);
            };
            intervals.add(empty_intervals(SamplerKind::sobol, first, 8, pair), where);
            independent.add(empty_intervals(SamplerKind::independent, first, 8, pair), where);
        }
    }
    result.measures.push_back({"elementary intervals of 256 points without their one point",
                               independent.figure, intervals.figure, 0, Gate::at_most,
                               intervals.where});

    // Pairs of dimensions of one sample: a table of 1024 dimensions starts again at its end.
    constexpr uint32_t kDimensions = 100000;
    std::set<Point> naive_pairs, own_pairs;
    const Sampler sampler(SamplerKind::sobol, 0, 3, 5, 12345);
    for (uint32_t pair = 0; pair < kDimensions / 2; ++pair) {
        own_pairs.insert(point_of(sampler, pair));
        naive_pairs.insert(point_of(sampler, pair % 512));
    }
    result.measures.push_back(
        {"pairs of " + std::to_string(kDimensions) + " dimensions that repeat",
         kDimensions / 2.0 - static_cast<double>(naive_pairs.size()),
         kDimensions / 2.0 - static_cast<double>(own_pairs.size()), 0, Gate::at_most, ""});

    // 65535^2 pixels with 2^20 samples each, in the film's counts.
    Film film(2, 1);
    for (FilmPixel& pixel : film.pixels()) pixel.samples = uint64_t{65535} * 65535 / 2 << 20;
    const double exact = 2 * (65535.0 * 65535.0 - 1) / 2 * 0x1p20;
    const double wrapped = static_cast<double>(static_cast<uint32_t>(film.total_samples()));
    result.measures.push_back(
        {"samples lost in the count of 65535^2 pixels with 2^20 each", exact - wrapped,
         std::abs(exact - static_cast<double>(film.total_samples())), 0, Gate::at_most, ""});
    return result;
}

const bool kAdded = add_case({"E06", Priority::p1, "indices and dimensions beyond 32 bits",
                              "index in 32 bits, table of 1024 dimensions",
                              "64-bit index in the scramble's key, every pair hashed by itself",
                              "mitsuba3#1888, mmp/pbrt-v3#237, pytorch/pytorch#33388", run});

}  // namespace
}  // namespace talbot::hardcases::e06
