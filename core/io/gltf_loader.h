// glTF 2.0 files (.gltf, .glb) to a SceneDesc; the only includer of tinygltf. Every index, count,
// size and number of the file is checked here: what passes cannot break the core.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/scene/scene_desc.h"

namespace talbot {

// How the file's punctual lights are taken.
struct LightReading {
    LightUnits units = LightUnits::spec;
    std::optional<double> sun_degrees;  // angular diameter of all directional lights
};

struct LoadOptions {
    std::string scene;    // name or index; empty takes the default scene, or the first
    std::string variant;  // KHR_materials_variants name; empty takes the file's own materials
    std::optional<double> animation_time;  // seconds; empty shows the rest pose
    double shutter_seconds = 0;            // motion blur: how long the shutter is open from then on
    LightReading lights;                   // of open(), for every later read()
    uint64_t max_bytes = 8ull << 30;       // over this the decoded scene is refused
    unsigned threads = 0;                  // for decoding images; 0 = all cores
    std::stop_token stop;
    std::function<void(float fraction, const char* stage)>
        progress;  // called from the loading thread

    // The second of the animations that is read, and at which the shutter opens: one without an
    // animation time opens at 0. Empty is the rest pose.
    std::optional<double> moment() const {
        if (animation_time || !(shutter_seconds > 0)) return animation_time;
        return 0.0;
    }
};

struct GltfAnimation {
    std::string name;
    double seconds = 0;  // the last key
};

// What a file offers to choose from.
struct GltfChoices {
    std::vector<std::string> scenes;
    std::size_t default_scene = 0;
    std::vector<std::string> variants;  // KHR_materials_variants
    std::vector<GltfAnimation> animations;

    double last_key() const;  // of all animations, seconds; 0 without any
};

// A file that was parsed once and can be read again in another scene, variant or moment. Its
// images, and meshes that nothing deforms, are decoded once.
class GltfFile {
  public:
    // Uses max_bytes, stop and progress of the options. Bad input gives ErrorKind::bad_input with
    // the file, the element (e.g. "accessors[3]") and what to do; a stop request gives
    // ErrorKind::cancelled.
    static Result<std::shared_ptr<GltfFile>> open(const std::filesystem::path& file,
                                                  const LoadOptions& options = {});
    ~GltfFile();

    const GltfChoices& choices() const;

    // The files beside the main one that its buffers and images name, there or not.
    const std::vector<std::filesystem::path>& other_files() const;

    // What moves from one second of the animations to a later one, in words; empty where nothing
    // does.
    Result<std::string> moving_property(double from, double to) const;

    // For any thread; one reads at a time, others wait.
    Result<SceneDesc> read(const LoadOptions& options = {});

  private:
    struct State;
    explicit GltfFile(std::unique_ptr<State> state);

    std::unique_ptr<State> state_;
};

// Opens and reads at once.
Result<SceneDesc> load_gltf(const std::filesystem::path& file, const LoadOptions& options = {});

}  // namespace talbot
