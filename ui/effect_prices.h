// Measures the prices of effects beside the render, on one thread of low priority that counts its
// own processor time.
#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "core/session/effect_ledger.h"
#include "core/session/snapshot.h"

namespace talbot {

class EffectPriceJob {
  public:
    // Measures what the snapshot shows; replaces a measurement that still runs.
    void start(const Snapshot& snapshot);

    bool running() const { return running_; }
    float fraction() const { return fraction_; }

    // The last figures, by effect; null before the first. `generation` is that of their snapshot.
    struct Figures {
        uint64_t generation = 0;
        std::vector<EffectPrice> prices;
    };
    std::shared_ptr<const Figures> figures() const;

  private:
    mutable std::mutex mutex_;
    std::shared_ptr<const Figures> figures_;
    std::atomic<bool> running_{false};
    std::atomic<float> fraction_{0};
    std::jthread thread_;  // last: it ends before the rest goes
};

}  // namespace talbot
