#include "app/window.h"

#include "app/exit_code.h"
#include "app/interact.h"
#include "app/viewer_options.h"

namespace talbot {
namespace {

// Loads what the options ask for, on workers that end before the viewer's own start.
Result<ViewerOptions> load_viewer(const Options& options) {
    WorkerPool pool(options.threads);
    const Result<SceneSetup> setup = set_up_scene(options, pool);
    if (!setup) return setup.error();
    return viewer_options(options, *setup);
}

int finish(const Status& status) {
    if (status) return kExitDone;
    log_error(status.error().line());
    return exit_code(status.error());
}

}  // namespace

int run_window(const Options& options) {
    const Result<ViewerOptions> viewer = load_viewer(options);
    if (!viewer) return finish(viewer.error());
    return finish(run_viewer(*viewer));
}

int run_script(const Options& options) {
    Result<ViewerOptions> viewer = load_viewer(options);
    if (!viewer) return finish(viewer.error());
    return finish(run_interaction({std::move(*viewer), options.interact, options.report}));
}

}  // namespace talbot
