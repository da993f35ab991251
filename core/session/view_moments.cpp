#include "core/session/view_moments.h"

#include <algorithm>
#include <chrono>

#include "core/base/log.h"
#include "core/integrate/sampler.h"

namespace talbot {

bool ViewMoments::moves() const {
    return view_.given && view_.given->motion() && !view_.forced_off.has(Effect::motion);
}

const PreparedView* ViewMoments::at(uint64_t index, const RenderSettings& settings,
                                    WorkerPool& pool, const std::stop_token& stop) {
    if (!moves()) return &view_;
    const auto start = std::chrono::steady_clock::now();
    const SceneMotion& motion = *view_.given->motion();
    const Sampler sampler(SamplerKind::sobol, settings.seed, 0, 0, index);
    const double seconds =
        motion.open + motion.shutter * static_cast<double>(sampler.single(Purpose::time));
    if (moment_.scene && at_ == seconds) return &moment_;
    const PreparedView& last = moment_.scene ? moment_ : view_;
    const std::shared_ptr<const Scene> scene =
        scene_at(*view_.given, seconds, pool, last.given, stop);
    if (!scene) {
        if (stop.stop_requested()) return nullptr;
        if (!warned_) {
            log_warning(view_.given->file() + ": cannot be shown at " + std::to_string(seconds) +
                        " s of its animations; it is shown as the shutter opens instead");
        }
        warned_ = true;
        return &view_;
    }
    moment_ = prepare_view(scene, camera_at(view_.camera, motion, *scene), settings, pool, &last);
    at_ = seconds;
    const double taken =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    seconds_ += taken;
    least_seconds_ = least_seconds_ > 0 ? std::min(least_seconds_, taken) : taken;
    return &moment_;
}

}  // namespace talbot
