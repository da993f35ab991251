// Two configurations of one view against each other for equal time: short slices of A and B in
// turn, so that other work on the machine hits both, and a verdict on which gives less error for
// its time. Runs on threads of its own; no call waits for a sample.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "core/accuracy/efficiency_verdict.h"
#include "core/film/image.h"
#include "core/integrate/kernel.h"
#include "core/scene/scene.h"
#include "core/session/settings.h"

namespace talbot {

struct AbConfig {
    RenderSettings settings;      // width and height are those of A for both
    TileKernel kernel = nullptr;  // null: the smallest one that covers the scene
};

struct AbPolicy {
    unsigned threads = 0;           // 0 = all cores
    double slice_seconds = 0.1;     // of one side before the other has its turn
    double publish_seconds = 0.25;  // between two snapshots, at least
    double limit_seconds = 0;       // of rendering, both sides together; 0 = none
    double limit_side_seconds = 0;  // of AbSide::seconds, on the side that had less; 0 = none
    bool stop_when_decided = false;
    float exposure_ev = 0;  // of the error metric
};

struct AbSide {
    std::shared_ptr<const ImageRgba> image;  // the mean of all samples so far
    uint64_t samples = 0;                    // a pixel
    double seconds = 0;                      // its threads' CPU time over their number
    uint64_t rays = 0;
    double relrmse_percent = 0;  // of the image; 0 before there is something to measure
    double lo95 = 0;
    double hi95 = 0;
    std::string kernel;  // name of the tier; empty for a given kernel
};

struct AbSnapshot {
    AbSide a, b;
    EfficiencyVerdict verdict;
    double seconds = 0;     // of rendering, by the clock
    bool finished = false;  // limit reached, decided, or stopped
};

class AbComparison {
  public:
    AbComparison();
    ~AbComparison();
    AbComparison(const AbComparison&) = delete;
    AbComparison& operator=(const AbComparison&) = delete;

    // Begins anew, in the background, with nothing kept of an earlier comparison. Where both
    // settings have one seed, both sides draw the same random numbers, so a difference shows
    // sooner.
    void start(std::shared_ptr<const Scene> scene, const Camera& camera, const AbConfig& a,
               const AbConfig& b, const AbPolicy& policy);

    // The newest state; null until both sides have their first whole pass.
    std::shared_ptr<const AbSnapshot> latest() const;

    // Asks it to end, within a sample of every thread; latest() stays.
    void stop();

    // Waits until it is finished, or `seconds` are over (negative: no limit); whether it is.
    bool wait(double seconds = -1) const;

  private:
    class Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace talbot
