#include "app/scene_setup.h"

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <limits>

#include "app/output_files.h"
#include "core/base/log.h"
#include "core/io/image_io.h"
#include "core/io/scene_motion.h"
#include "core/math/robust.h"
#include "ui/data_path.h"
#include "ui/scene_loading.h"

namespace talbot {
namespace {

constexpr Resolution kDefaultSize{960, 540};

// A well built structure costs some 3 us a triangle more than a fast one, and saves some 0.03 us a
// sample (docs/rays.md): from so many samples a triangle on it pays. A second of rendering counts
// as so many samples.
constexpr double kSamplesPerTriangle = 100;
constexpr double kSamplesPerSecond = 5e5;

// Images do not depend on it.
BuildQuality choose_quality(const Options& options, const SceneDesc& desc) {
    if (!options.headless()) return BuildQuality::fast;
    // The first camera stands for the one that will be chosen.
    const std::optional<Resolution> own =
        desc.cameras.empty() ? std::nullopt : desc.cameras.front().resolution;
    const Resolution size = options.size.value_or(own.value_or(kDefaultSize));
    const double pixels = static_cast<double>(size.width) * static_cast<double>(size.height);
    const bool open_end =
        options.time_seconds || options.target_error_percent || !options.resume.empty();
    double samples = std::numeric_limits<double>::infinity();
    if (options.frames || !open_end)
        samples = pixels * static_cast<double>(options.frames.value_or(1));
    if (options.time_seconds)
        samples = std::min(samples, kSamplesPerSecond * *options.time_seconds);
    double triangles = 0;
    for (const Mesh& mesh : desc.meshes) triangles += static_cast<double>(mesh.triangle_count());
    return samples >= kSamplesPerTriangle * triangles ? BuildQuality::high : BuildQuality::fast;
}

double seconds_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

LoadOptions load_options(const Options& options) {
    LoadOptions load;
    load.scene = options.scene_name;
    load.variant = options.variant;
    load.animation_time = options.animation_time;
    load.shutter_seconds = options.shutter_seconds;
    load.threads = options.threads;
    load.lights = options.light_reading;
    return load;
}

// Reads the open file and applies --environment.
Result<SceneDesc> read_scene(GltfFile& file, const LoadOptions& load, const Options& options) {
    Result<SceneDesc> desc = file.read(load);
    if (!desc) return desc.error();
    const bool dark = !has_light(desc->lights, desc->environment, desc->materials);
    if (dark && options.environment.empty()) {
        desc->environment = default_environment();
        desc->warnings.push_back(
            "the file has no light: a plain sky lights it; choose with --environment");
    }
    for (const std::string& warning : desc->warnings) log_warning(desc->file + ": " + warning);
    if (options.environment.empty()) {
        desc->environment.rotation_degrees = options.environment_rotation;
        return desc;
    }
    Result<Environment> environment =
        parse_environment(options.environment, options.environment_rotation);
    if (!environment) return environment.error();
    desc->environment = std::move(*environment);
    return desc;
}

}  // namespace

std::filesystem::path scene_path(const Options& options) {
    return options.scene_file.empty() ? find_data("scenes/hero.glb")
                                      : std::filesystem::path(options.scene_file);
}

Result<Environment> parse_environment(const std::string& text, float rotation_degrees) {
    Environment environment;
    environment.rotation_degrees = rotation_degrees;
    float color[3] = {0, 0, 0};
    int used = 0;
    if (std::sscanf(text.c_str(), "%f,%f,%f%n", &color[0], &color[1], &color[2], &used) == 3 &&
        static_cast<std::size_t>(used) == text.size()) {
        for (float c : color) {
            if (!(c >= 0) || !is_finite(c)) {
                return Error{ErrorKind::usage, "", "--environment",
                             "the colour's components must be finite and not negative"};
            }
        }
        environment.color = Rgb(color[0], color[1], color[2]);
        return environment;
    }
    std::error_code code;
    if (!std::filesystem::exists(text, code)) {
        return Error{ErrorKind::bad_input, text, "--environment",
                     "is neither a file nor a colour R,G,B"};
    }
    Result<EnvironmentImage> image = load_environment(text);
    if (!image) return image.error();
    if (image->repaired_texels > 0) {
        log_warning(text + ": " + std::to_string(image->repaired_texels) +
                    " texels were not finite or negative and are black now");
    }
    environment.image = std::make_shared<const EnvironmentImage>(std::move(*image));
    return environment;
}

Result<Camera> choose_camera(const Options& options, const Scene& scene) {
    if (options.orbit) return make_orbit_camera(*options.orbit);
    const std::vector<Camera>& cameras = scene.cameras();
    if (options.camera.empty()) {
        if (!cameras.empty()) return cameras.front();
        Vec3d lower(0);
        Vec3d upper(0);
        scene.world_bounds(lower, upper);
        const Resolution size = options.size.value_or(kDefaultSize);
        return frame_bounds(lower, upper, static_cast<double>(size.width) / size.height);
    }
    for (const Camera& camera : cameras) {
        if (camera.name == options.camera) return camera;
    }
    char* end = nullptr;
    const unsigned long index = std::strtoul(options.camera.c_str(), &end, 10);
    if (*end == '\0' && index < cameras.size()) return cameras[index];
    std::string known;
    for (const Camera& camera : cameras) known += (known.empty() ? "'" : ", '") + camera.name + "'";
    return Error{ErrorKind::usage, "", "--camera",
                 "no camera '" + options.camera + "'; the file has " +
                     (known.empty()
                          ? std::string("none")
                          : known + " (or an index below " + std::to_string(cameras.size()) + ")")};
}

Result<SceneDesc> load_scene(const Options& options) {
    const LoadOptions load = load_options(options);
    const Result<std::shared_ptr<GltfFile>> file = GltfFile::open(scene_path(options), load);
    if (!file) return file.error();
    return read_scene(**file, load, options);
}

Result<SceneSetup> set_up_scene(const Options& options, WorkerPool& pool) {
    SceneSetup setup;
    const auto start = std::chrono::steady_clock::now();
    const LoadOptions load = load_options(options);
    Result<std::shared_ptr<GltfFile>> file = GltfFile::open(scene_path(options), load);
    if (!file) return file.error();
    setup.file = std::move(*file);
    if (Status status = check_not_inputs(options.written_files(), setup.file->other_files());
        !status)
        return status.error();
    Result<SceneDesc> desc = read_scene(*setup.file, load, options);
    if (!desc) return desc.error();
    setup.load_seconds = seconds_since(start);
    const auto build_start = std::chrono::steady_clock::now();
    SceneBuildOptions build;
    build.quality = choose_quality(options, *desc);
    const std::size_t said = desc->warnings.size();
    setup.scene = Scene::build(std::move(*desc), pool, build);
    for (std::size_t i = said; i < setup.scene->warnings().size(); ++i)
        log_warning(setup.scene->file() + ": " + setup.scene->warnings()[i]);
    Result<std::shared_ptr<const Scene>> moving = set_in_motion(setup.scene, setup.file, load);
    if (!moving) return moving.error();
    setup.scene = std::move(*moving);
    setup.build_seconds = seconds_since(build_start);
    setup.identity = setup.scene->sha256();
    Result<Camera> camera = choose_camera(options, *setup.scene);
    if (!camera) return camera.error();
    setup.camera = *camera;
    setup.settings = options.render;
    const Resolution size = options.size.value_or(setup.camera.resolution.value_or(kDefaultSize));
    setup.settings.width = size.width;
    setup.settings.height = size.height;
    return setup;
}

}  // namespace talbot
