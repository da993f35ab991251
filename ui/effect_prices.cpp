#include "ui/effect_prices.h"

#include <sys/resource.h>

namespace talbot {

void EffectPriceJob::start(const Snapshot& snapshot) {
    thread_ = {};  // stops and joins a running one
    running_ = true;
    fraction_ = 0;
    thread_ = std::jthread([this, scene = snapshot.scene, camera = snapshot.camera,
                            settings = snapshot.settings,
                            generation = snapshot.generation](const std::stop_token& stop) {
        setpriority(PRIO_PROCESS, 0, 10);  // of this thread; the render goes first
        enter_worker_float_mode();
        std::optional<std::vector<EffectPrice>> prices =
            price_effects(scene, camera, settings, PricePolicy{}, stop,
                          [this](float fraction) { fraction_ = fraction; });
        if (prices) {
            const std::lock_guard lock(mutex_);
            figures_ = std::make_shared<const Figures>(Figures{generation, std::move(*prices)});
        }
        running_ = false;
    });
}

std::shared_ptr<const EffectPriceJob::Figures> EffectPriceJob::figures() const {
    const std::lock_guard lock(mutex_);
    return figures_;
}

}  // namespace talbot
