// Samples worth a second look: those that were not usable, and those far above their pixel's mean.
// Bounded lists that hold the same samples whatever the number of threads and the order of tiles.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "core/math/vec.h"

namespace talbot {

class Film;

enum class SampleFault : uint8_t { none, nan, infinite, negative, overflow };
std::string_view fault_name(SampleFault fault);

struct NotedSample {
    uint32_t x = 0;
    uint32_t y = 0;
    uint64_t sample = 0;
    Rgb radiance{0};  // as it arrived
    SampleFault fault = SampleFault::none;

    float largest() const { return max_component(radiance); }
};

// An outlier is this many times the mean of its pixel's other samples.
inline constexpr double kOutlierRatio = 16;

class SampleLog {
  public:
    static constexpr std::size_t kMostUnusable = 64;
    static constexpr std::size_t kMostOutliers = 256;

    void note_unusable(const NotedSample& sample);
    void note_outlier(const NotedSample& sample);
    // Weaker ones cannot enter the list any more.
    float outlier_threshold() const { return threshold_; }

    // A log for one worker, to be merged later; it leaves out what this one would not keep.
    SampleLog fork() const;
    void merge(const SampleLog& other);
    // Drops outliers that their pixel has caught up with.
    void prune(const Film& film);

    // The first ones, by sample and then from the top left.
    const std::vector<NotedSample>& unusable() const { return unusable_; }
    // The largest ones, in falling order.
    std::vector<NotedSample> outliers(std::size_t most) const;

  private:
    void trim();

    std::vector<NotedSample> unusable_;  // in order
    std::vector<NotedSample> outliers_;  // in no order; at most twice kMostOutliers
    float threshold_ = 0;
};

}  // namespace talbot
