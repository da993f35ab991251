// One side of an A/B comparison: many renders of the same view with a few samples each, one after
// the other, in slices of time. The scatter between the renders is their error, for any sampler and
// without an exponent.
#pragma once

#include <memory>
#include <stop_token>
#include <vector>

#include "core/base/worker_pool.h"
#include "core/film/film.h"
#include "core/film/image.h"
#include "core/integrate/kernel.h"
#include "core/scene/camera.h"
#include "core/session/settings.h"
#include "core/session/view_moments.h"

namespace talbot {

class AbRender {
  public:
    // A null kernel stands for the view's own.
    AbRender(PreparedView view, const RenderSettings& settings, TileKernel kernel,
             WorkerPool& pool);

    // Renders for about `seconds`, at least one tile.
    void run_slice(double seconds, WorkerPool& pool, const std::stop_token& stop);

    // From the next render on, renders have so many samples a pixel, and the moments begin anew.
    void start_level(uint64_t samples);

    uint64_t level_samples() const { return level_samples_; }
    uint64_t renders() const { return renders_; }  // whole ones at this level
    // Whole renders of every level so far.
    std::vector<uint64_t> level_renders() const;
    uint64_t samples() const { return samples_; }  // a pixel, whole passes, of all levels
    uint64_t rays() const { return rays_; }
    double seconds() const { return cpu_seconds_ / static_cast<double>(threads_); }

    // Seconds a sample over the passes that ended since the last call; 0 where none did.
    double take_sample_seconds();

    // The mean of all whole renders, and of the samples of the one at hand.
    ImageRgba image() const;

    // Mean of a pixel's renders at this level, and the variance of one of them; 3 values a pixel.
    const std::vector<double>& means() const { return mean_; }
    double variance(std::size_t i) const {
        return renders_ < 2 ? 0 : square_[i] / static_cast<double>(renders_ - 1);
    }

  private:
    void run_tiles(double deadline, WorkerPool& pool, const std::stop_token& stop);
    void begin_pass(WorkerPool& pool);
    void finish_pass();
    void finish_render();
    void begin_render();

    ViewMoments view_;
    const PreparedView* at_;  // what the pass at hand sees of it
    RenderSettings settings_;
    PathSettings path_;
    TileKernel kernel_;        // null: the view's own
    uint32_t columns_, rows_;  // of tiles
    Film film_;                // of the render at hand
    uint64_t passes_ = 0;      // whole ones in film_
    std::vector<uint8_t> tile_done_;
    std::vector<double> total_;             // sums of all whole renders' samples
    std::vector<double> mean_, square_;     // running moments of the renders (Welford 1962)
    std::vector<uint64_t> earlier_levels_;  // their numbers of renders
    uint64_t total_samples_ = 0;
    uint64_t level_samples_ = 1;
    uint64_t renders_ = 0;
    uint64_t all_renders_ = 0;
    uint64_t samples_ = 0;
    uint64_t rays_ = 0;
    unsigned threads_ = 1;
    double cpu_seconds_ = 0;
    double pass_start_ = 0;     // cpu_seconds_ then
    double ended_seconds_ = 0;  // CPU time of the passes that ended since they were asked for
    uint64_t ended_passes_ = 0;
};

}  // namespace talbot
