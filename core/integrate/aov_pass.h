// Output variables of camera rays and of whole paths, from passes of their own: functions of scene,
// pixel and sample index like the image itself, of the same samples, and of no cost to it.
#pragma once

#include <stop_token>
#include <vector>

#include "core/base/worker_pool.h"
#include "core/film/aov.h"
#include "core/integrate/render_scene.h"

namespace talbot {

// One sample of a variable that is not of the film.
Rgb aov_sample(Aov aov, const RenderScene& scene, const CameraRays& camera,
               const PathSettings& settings, uint32_t x, uint32_t y, uint64_t sample_index);

// Gathers samples of one variable.
class AovBuffer {
  public:
    AovBuffer() = default;
    AovBuffer(Aov aov, uint32_t width, uint32_t height);

    Aov aov() const { return aov_; }
    uint32_t samples() const { return samples_; }
    // One more sample of every pixel, those of index first_sample + samples(). False when it was
    // stopped; then nothing counts.
    bool add_pass(const RenderScene& scene, const CameraRays& camera, const PathSettings& settings,
                  uint64_t first_sample, WorkerPool& pool, const std::stop_token& stop);
    // The means, or the first samples of what is not averaged.
    AovImage image() const;

  private:
    Aov aov_ = Aov::beauty;
    uint32_t width_ = 0;
    uint32_t height_ = 0;
    uint32_t samples_ = 0;
    std::vector<Vec3d> sums_;
    std::vector<Rgb> pass_;
};

}  // namespace talbot
