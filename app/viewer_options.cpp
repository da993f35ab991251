#include "app/viewer_options.h"

namespace talbot {

ViewerOptions viewer_options(const Options& options, const SceneSetup& setup) {
    ViewerOptions viewer;
    viewer.scene = {setup.scene, setup.camera};
    viewer.file = scene_path(options);
    viewer.settings = setup.settings;
    viewer.fixed_size = options.size.has_value();
    viewer.display = options.display;
    viewer.threads = options.threads;
    return viewer;
}

}  // namespace talbot
