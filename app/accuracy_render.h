// A render that is measured: no window and no session, but the same passes, film and error figures.
// Used by `talbot accuracy`, which runs many of them in turn.
#pragma once

#include <memory>
#include <string>

#include "app/scene_setup.h"
#include "core/accuracy/calibration.h"
#include "core/base/worker_pool.h"
#include "core/session/view_moments.h"

namespace talbot {

// A scene with what all renders of it share.
struct AccuracyScene {
    std::string name;  // its file's
    SceneSetup setup;
    std::shared_ptr<const RenderScene> render_scene;
    EffectReport effects;
    float exposure_ev = 0;  // of the error metric
};

Result<AccuracyScene> load_accuracy_scene(const Options& options, WorkerPool& pool);

class MeasuredRender {
  public:
    MeasuredRender(const AccuracyScene& scene, const RenderSettings& settings, WorkerPool& pool);

    // Brings every pixel to `samples`; the error is observed at the powers of two on the way.
    void render_until(uint64_t samples);

    // Without observing.
    void render_unobserved(uint64_t samples);

    const Film& film() const { return film_; }
    const ErrorTracker& tracker() const { return tracker_; }
    uint64_t samples() const { return samples_; }
    uint64_t rays() const { return rays_; }
    double seconds() const { return seconds_; }          // of rendering
    double cpu_seconds() const { return cpu_seconds_; }  // of all workers while rendering
    ErrorEstimate estimate() const { return tracker_.at(samples_, seconds_); }

  private:
    const AccuracyScene& scene_;
    const RenderSettings settings_;
    WorkerPool& pool_;
    ViewMoments view_;
    Film film_;
    ErrorTracker tracker_;
    uint64_t samples_ = 0;
    uint64_t rays_ = 0;
    double seconds_ = 0;
    double cpu_seconds_ = 0;
};

// A reference of at least `samples` a pixel from four renders with seeds that nothing else uses.
// With a cache folder (may be empty), what was rendered there before is read instead.
Result<Reference> render_reference(const AccuracyScene& scene, const RenderSettings& settings,
                                   uint64_t samples, const std::string& cache, WorkerPool& pool);

// True relRMSE in per cent, and 0 where the difference is no more than the reference's own noise.
double true_error_percent(const Film& film, const Reference& reference, double exposure_ev);

}  // namespace talbot
