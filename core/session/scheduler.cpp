#include "core/session/scheduler.h"

namespace talbot {

uint32_t preview_divisor(uint64_t pixels, double samples_per_second, double seconds) {
    if (!(samples_per_second > 0)) return kFirstPreviewDivisor;
    const double affordable = samples_per_second * seconds;
    uint32_t divisor = 1;
    while (divisor<kMaxPreviewDivisor&& static_cast<double>(pixels)> affordable * divisor * divisor)
        divisor *= 2;
    return divisor;
}

double blended_rate(double previous, uint64_t samples, double seconds) {
    constexpr double kBlend = 0.5;
    constexpr uint64_t kEnough = 256;
    if (samples < kEnough || !(seconds > 0)) return previous;
    const double rate = static_cast<double>(samples) / seconds;
    return previous > 0 ? (1 - kBlend) * previous + kBlend * rate : rate;
}

Work next_work(const ScheduleState& state) {
    if (!state.has_scene) return {};
    if (state.interactive && state.passes == 0) {
        if (state.previews_done == 0) {
            const uint32_t divisor =
                preview_divisor(state.pixels, state.samples_per_second, state.preview_seconds);
            if (divisor > 1) return {WorkKind::preview, divisor, false};
        } else if (!state.paused && state.last_preview_divisor > 2) {
            return {WorkKind::preview, state.last_preview_divisor / 2, true};
        }
    }
    if (state.paused || state.stop_reached) return {};
    if (state.pass_limit != 0 && state.passes >= state.pass_limit) return {};
    return {WorkKind::pass, 1, true};
}

}  // namespace talbot
