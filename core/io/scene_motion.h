// Motion blur of a glTF file's animations.
#pragma once

#include <memory>

#include "core/base/result.h"
#include "core/io/gltf_loader.h"
#include "core/scene/scene.h"

namespace talbot {

// The scene, which was read of the file with these options, in motion while the shutter is open:
// for options.shutter_seconds from options.moment() on. The scene itself where nothing moves
// meanwhile. Bad input where the animations cannot be read.
Result<std::shared_ptr<const Scene>> set_in_motion(std::shared_ptr<const Scene> scene,
                                                   std::shared_ptr<GltfFile> file,
                                                   const LoadOptions& options);

}  // namespace talbot
