// A view while the shutter is open: every sample index sees it at a moment of its own, all pixels
// at the same one, so that kernels know nothing of time and still scenes pay nothing. Moments
// follow an Owen-scrambled van der Corput sequence: any stretch of samples covers the time that the
// shutter is open evenly.
#pragma once

#include <stop_token>

#include "core/base/worker_pool.h"
#include "core/session/prepared_view.h"

namespace talbot {

class ViewMoments {
  public:
    ViewMoments() = default;
    // `view` is at the moment at which the shutter opens.
    explicit ViewMoments(PreparedView view) : view_(std::move(view)) {}

    // Where the shutter opens: also what a view without motion is at all times.
    const PreparedView& view() const { return view_; }
    bool moves() const;

    // What sample `index` of a render with these settings sees; valid until the next call. Null
    // when stopped. A moment that the file cannot give is the first one instead, with a warning.
    const PreparedView* at(uint64_t index, const RenderSettings& settings, WorkerPool& pool,
                           const std::stop_token& stop = {});

    // Seconds by the clock that at() has taken to get from moment to moment, and the least that it
    // took once, which other work on the machine hardly touches; 0 where nothing moved.
    double seconds() const { return seconds_; }
    double least_seconds() const { return least_seconds_; }

  private:
    PreparedView view_;
    PreparedView moment_;  // of the last call
    double at_ = 0;        // its seconds, where it is set
    double seconds_ = 0;
    double least_seconds_ = 0;
    bool warned_ = false;
};

}  // namespace talbot
