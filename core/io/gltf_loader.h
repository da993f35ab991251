// glTF 2.0 files (.gltf, .glb) to a SceneDesc; the only includer of tinygltf. Every index, count, size and number of the file
// is checked here: what passes cannot break the core.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/scene/scene_desc.h"

namespace talbot {

struct LoadOptions {
    std::string scene;    // name or index; empty takes the default scene, or the first
    std::string variant;  // KHR_materials_variants name; empty takes the file's own materials
    std::optional<double> animation_time;  // seconds; empty shows the rest pose
    uint64_t max_bytes = 8ull << 30;       // over this the decoded scene is refused
    unsigned threads = 0;                  // for decoding images; 0 = all cores
    std::stop_token stop;
    std::function<void(float fraction, const char* stage)> progress;  // called from the loading thread
};

// Bad input gives ErrorKind::bad_input with the file, the element (e.g. "accessors[3]") and what to do; a stop request gives
// ErrorKind::cancelled.
Result<SceneDesc> load_gltf(const std::filesystem::path& file, const LoadOptions& options = {});

struct GltfAnimation {
    std::string name;
    double seconds = 0;  // the last key
};

// What a file offers to choose from.
struct GltfChoices {
    std::vector<std::string> variants;  // KHR_materials_variants
    std::vector<GltfAnimation> animations;
};

Result<GltfChoices> read_gltf_choices(const std::filesystem::path& file);

}  // namespace talbot
