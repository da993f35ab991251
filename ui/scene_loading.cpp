#include "ui/scene_loading.h"

#include <algorithm>
#include <string>

#include "core/io/gltf_loader.h"
#include "core/io/scene_motion.h"

namespace talbot {
namespace {

// The file's first camera, else one that frames everything.
Camera first_camera(const Scene& scene) {
    if (!scene.cameras().empty()) return scene.cameras().front();
    Vec3d lower, upper;
    scene.world_bounds(lower, upper);
    return frame_bounds(lower, upper, 16.0 / 9.0);
}

}  // namespace

bool has_light(const std::vector<PunctualLight>& lights, const Environment& environment,
               const std::vector<Material>& materials) {
    if (!lights.empty() || environment.image || environment.gradient ||
        !is_black(environment.color))
        return true;
    // An emissive texture of no more than unit strength is a glow: it lights no room.
    return std::any_of(materials.begin(), materials.end(), [](const Material& material) {
        const bool glows = material.emissive_texture.used() && !(material.emissive_strength > 1);
        return (material.is_emissive() && !glows) || material.unlit;
    });
}

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
    const Result<std::shared_ptr<GltfFile>> opened = GltfFile::open(file, options);
    if (!opened) return opened.error();
    Result<SceneDesc> desc = (*opened)->read(options);
    if (!desc) return desc.error();
    if (!has_light(desc->lights, desc->environment, desc->materials)) desc->environment = fallback;

    WorkerPool pool(threads);
    SceneBuildOptions build;
    build.quality = BuildQuality::fast;
    build.stop = stop;
    build.progress = [&](float fraction) {
        if (progress) progress(fraction, "building");
    };
    LoadedScene loaded;
    loaded.scene = Scene::build(std::move(*desc), pool, build);
    if (!loaded.scene)
        return Error{ErrorKind::cancelled, file.string(), "", "loading was cancelled"};
    loaded.file = *opened;
    loaded.choice.scene = loaded.file->choices().default_scene;
    loaded.camera = first_camera(*loaded.scene);
    return loaded;
}

Result<RereadScene> reread_scene(const std::shared_ptr<GltfFile>& file, const SceneChoice& choice,
                                 const Environment& environment,
                                 std::shared_ptr<const Scene> previous, std::stop_token stop) {
    const GltfChoices& choices = file->choices();
    LoadOptions options;
    options.stop = stop;
    if (choice.scene < choices.scenes.size()) options.scene = std::to_string(choice.scene);
    if (choice.variant && *choice.variant < choices.variants.size())
        options.variant = choices.variants[*choice.variant];
    options.animation_time = choice.seconds;
    options.shutter_seconds = choice.shutter;
    Result<SceneDesc> desc = file->read(options);
    if (!desc) return desc.error();
    desc->environment = environment;
    WorkerPool pool(0);
    SceneBuildOptions build;
    build.stop = stop;
    build.quality = BuildQuality::fast;
    build.previous = std::move(previous);
    const std::string name = desc->file;
    RereadScene reread;
    reread.loaded.scene = Scene::build(std::move(*desc), pool, build);
    if (!reread.loaded.scene) return Error{ErrorKind::cancelled, name, "", "loading was cancelled"};
    Result<std::shared_ptr<const Scene>> moving = set_in_motion(reread.loaded.scene, file, options);
    if (!moving) return moving.error();
    reread.loaded.scene = std::move(*moving);
    reread.loaded.camera = first_camera(*reread.loaded.scene);
    reread.loaded.file = file;
    reread.loaded.choice = choice;
    return reread;
}

}  // namespace talbot
