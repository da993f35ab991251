// From a file to something that can be shown, for any thread.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <stop_token>

#include "core/base/result.h"
#include "core/scene/scene.h"

namespace talbot {

struct LoadedScene {
    std::shared_ptr<const Scene> scene;
    Camera camera;
};

using LoadProgress = std::function<void(float fraction, const char* stage)>;
using SceneLoader = std::function<Result<LoadedScene>(
    const std::filesystem::path& file, std::stop_token stop, const LoadProgress& progress)>;

// Loads and builds a glTF file. The camera is the file's first one, else one that frames
// everything; a scene without any light gets `fallback`.
Result<LoadedScene> load_scene(const std::filesystem::path& file, std::stop_token stop,
                               const LoadProgress& progress, const Environment& fallback,
                               unsigned threads);

// A soft sky for scenes without light: brighter above than below.
Environment default_environment();

// Whether the file's name says that it is an environment image.
bool is_environment_file(const std::filesystem::path& file);

}  // namespace talbot
