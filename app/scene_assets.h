// What a scene is made of besides its main file: buffers and images in files of their own.
#pragma once

#include "app/scene_setup.h"

namespace talbot {

// Reads the files that the scene's file names and sets `assets` and `identity`, which changes with
// any of them. A file that cannot be read, for nothing needs it, counts as unread.
void hash_assets(SceneSetup& setup);

}  // namespace talbot
