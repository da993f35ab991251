// RenderSession: owns scene, film and workers behind four verbs: submit a change, give the latest
// snapshot, wait for passes, stop. The viewer and the headless driver use the same object. A caller
// never waits for a worker except in wait_*.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "core/session/snapshot.h"

namespace talbot {

// How the session spends its time.
struct SessionPolicy {
    bool interactive =
        false;  // low-resolution passes first after a change; a snapshot after every pass
    double preview_seconds = 0.020;  // aimed-at time of such a pass
    unsigned threads = 0;            // 0 = all cores
    double time_limit_seconds =
        0;  // of rendering by this session; 0 = none. Ends the current pass early.
    // Stops after the pass at which the error meets it, or after 64 passes and 4 million samples of
    // which no two differed; 0 = off.
    double target_error_percent = 0;
};

class RenderSession {
  public:
    explicit RenderSession(const SessionPolicy& policy);
    // With an own pool (then policy.threads is ignored), so that loading and rendering share the
    // workers.
    RenderSession(const SessionPolicy& policy, std::shared_ptr<WorkerPool> pool);
    ~RenderSession();
    RenderSession(const RenderSession&) = delete;
    RenderSession& operator=(const RenderSession&) = delete;

    // Queues the change and returns its generation at once. Nothing is rendered before the first
    // SetScene.
    uint64_t submit(Change change);

    // The newest snapshot; null before the first.
    std::shared_ptr<const Snapshot> latest() const;

    // Waits until a snapshot of at least this generation with at least this many passes exists, or
    // the render has finished, or the time is over (negative = no limit); returns whether the first
    // or second holds.
    bool wait_for(uint64_t generation, uint64_t passes, double seconds = -1) const;

    // Ends all work soon (within the pixel at hand) and publishes what there is; later submits do
    // nothing.
    void stop();

    // Called on the session's thread after each new snapshot, e.g. to wake an event loop. Set
    // before the first submit.
    void on_snapshot(std::function<void()> callback);

    // Runs f on the raw film between two passes, on the session's thread, and waits for it.
    void with_film(const std::function<void(const FilmView&)>& f);

    unsigned threads() const;

  private:
    class Impl;
    std::unique_ptr<Impl> impl_;
};

// What lies under an image position of a size: nullopt for background.
struct Pick {
    uint32_t object = 0;
    uint32_t material = 0;
    Vec3d point{0};  // world
};
std::optional<Pick> pick(const Scene& scene, const Camera& camera, uint32_t width, uint32_t height,
                         float px, float py);

}  // namespace talbot
