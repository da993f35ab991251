#include "app/window.h"

#include <algorithm>
#include <cstdlib>

#include "app/exit_code.h"
#include "app/interact.h"
#include "app/interrupt.h"
#include "app/output_files.h"
#include "app/scene_setup.h"
#include "app/viewer.h"

namespace talbot {
namespace {

// What --scene, --variant and --animation-time, which were found in the file, name there.
SceneChoice choice_of(const Options& options, const GltfFile& file) {
    const GltfChoices& choices = file.choices();
    const auto index_of = [](const std::vector<std::string>& names, const std::string& name) {
        return static_cast<std::size_t>(std::find(names.begin(), names.end(), name) -
                                        names.begin());
    };
    SceneChoice choice;
    choice.scene = choices.default_scene;
    if (!options.scene_name.empty()) {
        choice.scene = index_of(choices.scenes, options.scene_name);
        if (choice.scene == choices.scenes.size())
            choice.scene = std::strtoul(options.scene_name.c_str(), nullptr, 10);
    }
    if (!options.variant.empty()) choice.variant = index_of(choices.variants, options.variant);
    choice.seconds = options.animation_time;
    choice.shutter = options.shutter_seconds;
    return choice;
}

// Loads what the options ask for, on workers that end before the viewer's own start. The image
// follows the window unless --size was given.
Result<ViewerOptions> load_viewer(const Options& options) {
    WorkerPool pool(options.threads);
    Result<SceneSetup> setup = set_up_scene(options, pool);
    if (!setup) return setup.error();
    ViewerOptions viewer;
    viewer.scene = {setup->scene, setup->camera, setup->file, choice_of(options, *setup->file)};
    viewer.file = scene_path(options);
    viewer.settings = setup->settings;
    viewer.fixed_size = options.size.has_value();
    viewer.display = options.display;
    viewer.threads = options.threads;
    viewer.pass_limit = options.frames.value_or(0);
    return viewer;
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
    leave_on_interrupt();
    if (Status status = check_output_files({options.report}, {options.interact}); !status)
        return finish(status);
    Result<ViewerOptions> viewer = load_viewer(options);
    if (!viewer) return finish(viewer.error());
    return finish(run_interaction({std::move(*viewer), options.interact, options.report}));
}

}  // namespace talbot
