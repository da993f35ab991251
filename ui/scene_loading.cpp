#include "ui/scene_loading.h"

#include <algorithm>
#include <string>

#include "core/io/gltf_loader.h"

namespace talbot {
namespace {

bool has_light(const SceneDesc& desc) {
    if (!desc.lights.empty() || desc.environment.image || desc.environment.gradient ||
        !is_black(desc.environment.color)) {
        return true;
    }
    return std::any_of(desc.materials.begin(), desc.materials.end(), [](const Material& material) {
        return material.is_emissive() || material.unlit;
    });
}

}  // namespace

Environment default_environment() {
    Environment environment;
    environment.gradient = EnvironmentGradient{Vec3f(0, 1, 0), Rgb(0.35f), Rgb(1.1f, 1.15f, 1.2f)};
    return environment;
}

bool is_environment_file(const std::filesystem::path& file) {
    std::string extension = file.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(), [](char c) {
        return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    });
    return extension == ".hdr" || extension == ".exr";
}

Result<LoadedScene> load_scene(const std::filesystem::path& file, std::stop_token stop,
                               const LoadProgress& progress, const Environment& fallback,
                               unsigned threads) {
    LoadOptions options;
    options.stop = stop;
    options.threads = threads;
    options.progress = progress;
    Result<SceneDesc> desc = load_gltf(file, options);
    if (!desc) return desc.error();
    if (!has_light(*desc)) desc->environment = fallback;

    WorkerPool pool(threads);
    SceneBuildOptions build;
    build.stop = stop;
    build.progress = [&](float fraction) {
        if (progress) progress(fraction, "building");
    };
    LoadedScene loaded;
    loaded.scene = Scene::build(std::move(*desc), pool, build);
    if (!loaded.scene)
        return Error{ErrorKind::cancelled, file.string(), "", "loading was cancelled"};
    if (!loaded.scene->cameras().empty()) {
        loaded.camera = loaded.scene->cameras().front();
    } else {
        Vec3d lower, upper;
        loaded.scene->world_bounds(lower, upper);
        loaded.camera = frame_bounds(lower, upper, 16.0 / 9.0);
    }
    return loaded;
}

}  // namespace talbot
