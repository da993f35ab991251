// From options to a scene, a camera and settings: what the viewer and the headless driver share.
#pragma once

#include <filesystem>
#include <memory>

#include "app/options.h"
#include "core/base/result.h"
#include "core/base/worker_pool.h"
#include "core/io/gltf_loader.h"
#include "core/scene/scene.h"

namespace talbot {

// A file that the scene's file names, and the SHA-256 of its bytes in hex.
struct AssetHash {
    std::string file;
    std::string sha256;
};

struct SceneSetup {
    std::shared_ptr<GltfFile> file;  // for reading it again; holds its bytes
    std::shared_ptr<const Scene> scene;
    Camera camera;
    RenderSettings settings;
    double load_seconds = 0;
    double build_seconds = 0;
    std::vector<AssetHash> assets;  // once hash_assets() was called
    std::string identity;           // SHA-256 of the main file; after that call, of all
};

// The scene file that is meant: the argument, or the built-in default.
std::filesystem::path scene_path(const Options& options);

// Loads the file and applies --environment, without building anything; a file without any light
// gets the viewer's default. Reports warnings of the file to the log.
Result<SceneDesc> load_scene(const Options& options);

// --camera and --orbit, or the file's first camera, or one that frames everything.
Result<Camera> choose_camera(const Options& options, const Scene& scene);

// Loads, builds, applies --environment, --camera, --orbit, --size. Reports warnings of the file to
// the log.
Result<SceneSetup> set_up_scene(const Options& options, WorkerPool& pool);

// FILE.hdr, FILE.exr or R,G,B.
Result<Environment> parse_environment(const std::string& text, float rotation_degrees);

}  // namespace talbot
