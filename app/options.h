// The command line as plain data. Words for enumerations come from the tables beside the
// enumerations.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/log.h"
#include "core/base/result.h"
#include "core/film/aov.h"
#include "core/film/tone_map.h"
#include "core/io/gltf_loader.h"
#include "core/scene/camera.h"
#include "core/session/settings.h"

namespace talbot {

enum class Command { render, info, effects };

struct PixelAddress {
    uint32_t x = 0;
    uint32_t y = 0;
};

struct Options {
    Command command = Command::render;
    std::string scene_file;  // empty: the built-in scene

    // Headless as soon as one of these is given.
    std::optional<uint64_t> frames;
    std::optional<double> time_seconds;
    std::optional<double> target_error_percent;
    std::vector<std::string> outputs;
    std::string screenshot;
    std::string interact;

    std::string report;
    std::string film;
    std::string checkpoint;
    double checkpoint_seconds = 0;
    std::string resume;
    std::optional<Resolution> size;
    unsigned threads = 0;
    std::string camera;
    std::optional<Orbit> orbit;
    std::string scene_name;
    std::string variant;
    std::optional<double> animation_time;
    double shutter_seconds = 0;  // motion blur
    std::string environment;
    float environment_rotation = 0;
    LightReading light_reading;
    RenderSettings render;
    DisplaySettings display;
    std::vector<Aov> aovs;  // layers of .exr outputs
    std::optional<PixelAddress> pixel;
    uint64_t sample = 0;
    bool strict = false;
    bool json = false;  // info as JSON
    LogLevel log_level = LogLevel::info;

    std::vector<std::string> command_files;  // that a command writes: reports, figures, plots

    // What a run writes; some may be empty.
    std::vector<std::string> written_files() const {
        std::vector<std::string> files = outputs;
        files.insert(files.end(), {report, film, checkpoint, screenshot});
        files.insert(files.end(), command_files.begin(), command_files.end());
        return files;
    }

    bool headless() const {
        return frames || time_seconds || target_error_percent || !outputs.empty() ||
               !report.empty() || !film.empty() || !checkpoint.empty() || !resume.empty();
    }
    // Whether they ask for more than a scene, its view and settings.
    bool acts() const { return headless() || pixel || !screenshot.empty() || !interact.empty(); }
};

// The words behind the program's name; empty when help or the version was printed.
Result<std::optional<Options>> parse_options(std::span<const std::string> words);

}  // namespace talbot
