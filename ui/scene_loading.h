// From a file to something that can be shown, for any thread.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <stop_token>

#include "core/base/result.h"
#include "core/io/gltf_loader.h"
#include "core/scene/scene.h"

namespace talbot {

// Which of its file's scenes, variants and moments a scene shows.
struct SceneChoice {
    std::size_t scene = 0;
    std::optional<std::size_t> variant;  // empty: the file's own materials
    std::optional<double> seconds;       // of the animations; empty: the rest pose
    double shutter = 0;                  // motion blur: seconds of the animations from then on

    bool operator==(const SceneChoice&) const = default;
};

struct LoadedScene {
    std::shared_ptr<const Scene> scene;
    Camera camera;
    std::shared_ptr<GltfFile> file;  // null where there is nothing to choose from
    SceneChoice choice;
};

// The scene of an open file again, in another variant or at another time.
struct RereadScene {
    LoadedScene loaded;
};

using LoadProgress = std::function<void(float fraction, const char* stage)>;
using SceneLoader = std::function<Result<LoadedScene>(
    const std::filesystem::path& file, std::stop_token stop, const LoadProgress& progress)>;

// Loads and builds a glTF file. The camera is the file's first one, else one that frames
// everything; a scene without any light gets `fallback`.
Result<LoadedScene> load_scene(const std::filesystem::path& file, std::stop_token stop,
                               const LoadProgress& progress, const Environment& fallback,
                               unsigned threads);

// Whether anything shines.
bool has_light(const std::vector<PunctualLight>& lights, const Environment& environment,
               const std::vector<Material>& materials);

// Reads and builds another choice of an open file, under this environment. For the eye, not for a
// long render: the structure for rays is that of `previous` (may be null) refitted, or built fast
// rather than well.
Result<RereadScene> reread_scene(const std::shared_ptr<GltfFile>& file, const SceneChoice& choice,
                                 const Environment& environment,
                                 std::shared_ptr<const Scene> previous, std::stop_token stop);

// A soft sky for scenes without light: brighter above than below.
Environment default_environment();

// Whether the file's name says that it is an environment image.
bool is_environment_file(const std::filesystem::path& file);

}  // namespace talbot
