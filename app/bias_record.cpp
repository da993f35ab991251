#include "app/bias_record.h"

#include <cmath>
#include <cstdio>

namespace talbot {

std::vector<BiasEntry> measure_bias(const SceneSetup& setup, double exposure_ev, WorkerPool& pool) {
    return measure_bias(setup.scene, setup.camera, setup.settings, exposure_ev, pool);
}

std::string bias_sentence(const BiasFloor& floor, std::optional<double> loss_after_seconds) {
    char text[160];
    if (!(floor.hi95 > 0)) return "no difference to the base was seen";
    if (!floor.significant) {
        std::snprintf(text, sizeof(text), "no bias was seen; it would be below %.3g %%",
                      floor.hi95);
        return text;
    }
    std::snprintf(text, sizeof(text),
                  "puts a floor of %.3g %% under the error (brightness %+.3g %%)",
                  floor.relrmse_percent, floor.brightness_percent);
    std::string sentence = text;
    if (!loss_after_seconds) return sentence;
    if (*loss_after_seconds <= 0) return sentence + "; a loss from the start";
    if (!std::isfinite(*loss_after_seconds))
        return sentence + "; pays for any time that was looked at";
    std::snprintf(text, sizeof(text), "; a loss after about %.2g s", *loss_after_seconds);
    return sentence + text;
}

}  // namespace talbot
