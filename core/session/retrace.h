// Paths of an image that is on show, again. Keeps what is costly to prepare for a scene.
#pragma once

#include <memory>
#include <mutex>

#include "core/integrate/replay.h"
#include "core/session/settings.h"
#include "core/session/view_moments.h"

namespace talbot {

class Retracer {
  public:
    // The path of one sample. For any thread; takes as long as preparing the scene's lights when it
    // is another scene than the last time.
    ReplayedPath path(const std::shared_ptr<const Scene>& scene, const Camera& camera,
                      const RenderSettings& settings, uint32_t x, uint32_t y, uint64_t sample);

  private:
    std::mutex mutex_;
    ViewMoments view_;  // of the last path
};

}  // namespace talbot
