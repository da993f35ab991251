// For a given number of samples the error is least where each block's count goes with the root of
// its variance a sample.
#include "core/accuracy/sampling_plan.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "core/accuracy/octave_statistics.h"

namespace talbot {

namespace {

// The first octave in which blocks may rest, decided by what was seen half way to it.
constexpr uint64_t kFirstPlan = 32;
// A block lags behind the others by a factor of so much at most: what looks dark for a long time
// may hold a light that is found late.
constexpr double kMostLag = 8;

// The largest of the 3x3 blocks around each: an edge or a shadow does not end with a block.
std::vector<float> widened(const std::vector<float>& noise, std::size_t columns) {
    const std::size_t rows = noise.size() / columns;
    std::vector<float> most(noise.size());
    for (std::size_t y = 0; y < rows; ++y) {
        for (std::size_t x = 0; x < columns; ++x) {
            float value = 0;
            for (std::size_t v = y - std::min<std::size_t>(y, 1); v < std::min(y + 2, rows); ++v)
                for (std::size_t u = x - std::min<std::size_t>(x, 1); u < std::min(x + 2, columns);
                     ++u)
                    value = std::max(value, noise[v * columns + u]);
            most[y * columns + x] = value;
        }
    }
    return most;
}

}  // namespace

SamplingPlan next_plan(const SamplingPlan& before, uint64_t passes, OctaveMemory& memory,
                       uint32_t width, double metric_constant, WorkerPool* pool) {
    SamplingPlan plan;
    if (passes < kFirstPlan / 2 || memory.difference.empty()) return plan;
    const std::vector<float> differences =
        weigh_memory(memory, width, metric_constant, pool).blocks;
    const std::size_t columns = (width + kErrorBlock - 1) / kErrorBlock;
    const std::size_t count = differences.size();
    plan.octave = passes;
    plan.blocks.resize(count);
    for (std::size_t b = 0; b < count; ++b) {
        const uint64_t samples =
            before.empty() || before.octave * 2 != passes ? passes : before.samples(b, passes);
        plan.blocks[b] = static_cast<uint8_t>(std::countr_zero(samples));
        plan.noise.push_back(differences[b] * static_cast<float>(samples));
    }
    if (before.empty() || before.noise.size() != count || before.octave * 2 != passes) return plan;

    const std::vector<float> noise = widened(before.noise, columns);
    double mean = 0;
    for (const float s : before.noise) mean += static_cast<double>(s);
    mean /= static_cast<double>(count);
    if (!(mean > 0)) return plan;
    const double most = 2 * static_cast<double>(passes);
    for (std::size_t b = 0; b < count; ++b) {
        const double share = std::sqrt(static_cast<double>(noise[b]) / mean);
        const double wanted = most * std::clamp(share, 1 / kMostLag, 1.0);
        const double now = static_cast<double>(uint64_t{1} << plan.blocks[b]);
        // Doubled where that comes nearer to what is wanted.
        if (now * std::sqrt(2.0) > wanted) plan.blocks[b] |= SamplingPlan::kRests;
    }
    return plan;
}

}  // namespace talbot
