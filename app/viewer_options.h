// From the command line to what the viewer and the replay of scripts start with.
#pragma once

#include "app/options.h"
#include "app/scene_setup.h"
#include "app/viewer.h"

namespace talbot {

// The image follows the window unless --size was given.
ViewerOptions viewer_options(const Options& options, const SceneSetup& setup);

}  // namespace talbot
