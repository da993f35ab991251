#include "app/replay.h"

#include <cstdio>

#include "app/exit_code.h"
#include "app/scene_setup.h"
#include "core/session/retrace.h"

namespace talbot {

int run_replay(const Options& options) {
    WorkerPool pool(options.threads);
    const Result<SceneSetup> setup = set_up_scene(options, pool);
    if (!setup) {
        log_error(setup.error().line());
        return exit_code(setup.error());
    }
    const RenderSettings& settings = setup->settings;
    if (options.pixel->x >= settings.width || options.pixel->y >= settings.height) {
        log_error("--pixel: lies outside the image of " + std::to_string(settings.width) + "x" +
                  std::to_string(settings.height));
        return kExitUsage;
    }
    Retracer retracer;
    const std::string log = retracer
                                .path(setup->scene, setup->camera, settings, options.pixel->x,
                                      options.pixel->y, options.sample)
                                .log;
    std::fwrite(log.data(), 1, log.size(), stdout);
    return kExitDone;
}

}  // namespace talbot
