#include "app/options.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <limits>

#include "app/exit_code.h"
#include "app/isa_option.h"
#include "app/sub_command.h"
#include "core/scene/effects_off.h"

namespace talbot {
namespace {

// Above this a film would not fit into the memory of an ordinary machine.
constexpr uint64_t kMaxPixels = uint64_t{1} << 26;
constexpr uint32_t kMaxSide = 65535;

struct RawOptions {
    std::string size, orbit, tone_map, background = "environment", sampler, filter, pixel,
                                       effects = "auto", log = "info", aovs;
    std::string frames, seed, first_sample, threads, max_depth, tile_size, sample;
    std::optional<double> every;
    double exposure = 0;
    std::string lights;
    std::string environment_sampling;
    std::string texture_filter;
    std::string light_units;
    bool quiet = false;
    bool no_roulette = false;
    bool no_nee = false;
};

template <typename Table>
std::string names_of(const Table& table) {
    std::string text;
    for (const auto& row : table) text += (text.empty() ? "" : ", ") + std::string(row.name);
    return text;
}

// Looks a word up in a table of {enum, name, label} rows.
template <typename Enum, typename Table, typename Member>
Status set_from_table(const std::string& word, const std::string& option, const Table& table,
                      Member member, Enum& value) {
    if (word.empty()) return Done{};
    for (const auto& row : table) {
        if (row.name == word) {
            value = row.*member;
            return Done{};
        }
    }
    return usage_error(option, "'" + word + "' is not known; use one of " + names_of(table));
}

// Comma-separated finite numbers, exactly `count` of them.
Result<std::vector<double>> parse_numbers(const std::string& text, const std::string& option,
                                          std::size_t count) {
    std::vector<double> numbers;
    std::size_t start = 0;
    while (start <= text.size()) {
        const std::size_t comma = std::min(text.find(',', start), text.size());
        const std::string part = text.substr(start, comma - start);
        char* end = nullptr;
        const double value = std::strtod(part.c_str(), &end);
        if (part.empty() || *end != '\0' || !std::isfinite(value)) {
            return usage_error(option, "'" + part + "' is not a number; give " +
                                           std::to_string(count) + " numbers with commas");
        }
        numbers.push_back(value);
        start = comma + 1;
    }
    if (numbers.size() != count) {
        return usage_error(option, "needs " + std::to_string(count) + " numbers with commas, got " +
                                       std::to_string(numbers.size()));
    }
    return numbers;
}

// A whole number from 0 up to `most`; empty text leaves the value alone.
template <typename T>
Status set_whole(const std::string& text, const std::string& option, uint64_t most, T& value) {
    if (text.empty()) return Done{};
    const Result<uint64_t> number = parse_whole(text, option, most);
    if (!number) return number.error();
    value = static_cast<T>(*number);
    return Done{};
}

Status convert_whole_numbers(const RawOptions& raw, Options& o) {
    constexpr uint64_t kMost64 = std::numeric_limits<uint64_t>::max();
    constexpr uint64_t kMostSamples = uint64_t{1} << 53;
    uint64_t frames = 0;
    if (Status s = set_whole(raw.frames, "--frames", kMostSamples, frames); !s) return s;
    if (!raw.frames.empty()) {
        if (frames == 0) return usage_error("--frames", "must be at least 1");
        o.frames = frames;
    }
    if (Status s = set_whole(raw.seed, "--seed", kMost64, o.render.seed); !s) return s;
    if (Status s =
            set_whole(raw.first_sample, "--first-sample", kMostSamples, o.render.first_sample);
        !s)
        return s;
    if (o.render.adaptive && o.render.first_sample > 0) {
        return usage_error("--adaptive",
                           "cannot be used for a part of a render; leave out --first-sample");
    }
    if (o.render.first_sample + frames > kMostSamples)
        return usage_error("--first-sample",
                           "with --frames goes beyond sample " + std::to_string(kMostSamples));
    if (Status s = set_whole(raw.sample, "--sample", kMostSamples, o.sample); !s) return s;
    if (Status s = set_whole(raw.threads, "--threads", 1024, o.threads); !s) return s;
    if (Status s = set_whole(raw.max_depth, "--max-depth", 1 << 20, o.render.max_depth); !s)
        return s;
    if (Status s = set_whole(raw.tile_size, "--tile-size", kMaxSide, o.render.tile_size); !s)
        return s;
    if (o.render.tile_size == 0) return usage_error("--tile-size", "must be at least 1");
    return Done{};
}

Result<Resolution> parse_size(const std::string& text) {
    unsigned long long width = 0;
    unsigned long long height = 0;
    char tail = 0;
    const bool digits = text.find_first_not_of("0123456789x") == std::string::npos;
    if (!digits || text.size() > 16 ||
        std::sscanf(text.c_str(), "%llux%llu%c", &width, &height, &tail) != 2) {
        return usage_error("--size", "'" + text + "' is not WIDTHxHEIGHT, e.g. 960x540");
    }
    if (width == 0 || height == 0)
        return usage_error("--size", "'" + text + "' has no pixels; both sides must be at least 1");
    if (width > kMaxSide || height > kMaxSide || width * height > kMaxPixels) {
        return usage_error("--size", "'" + text + "' is too large; at most " +
                                         std::to_string(kMaxSide) + " a side and " +
                                         std::to_string(kMaxPixels) + " pixels in all");
    }
    return Resolution{static_cast<uint32_t>(width), static_cast<uint32_t>(height)};
}

void declare(CLI::App& app, Options& o, RawOptions& raw) {
    app.add_option("SCENE", o.scene_file,
                   "glTF scene (.gltf or .glb); without it the built-in scene");
    app.add_option("--frames", raw.frames, "headless: N passes of one sample per pixel, then exit");
    app.add_option("--time", o.time_seconds, "headless: stop at this wall-clock budget in seconds");
    app.add_option("--target-error", o.target_error_percent,
                   "headless: stop when the relative RMSE is below PCT with a probability of 90 %");
    app.add_option("--output", o.outputs, "write .png, .exr, .hdr or .pfm; may be repeated")
        ->allow_extra_args(false);
    app.add_option("--screenshot", o.screenshot,
                   "PNG of the viewer window with its panels, drawn offscreen");
    app.add_option("--interact", o.interact,
                   "replay an interaction script offscreen and report latencies");
    app.add_option("--report", o.report, "JSON run record");
    app.add_option("--film", o.film, "write the raw film, for `talbot merge`");
    app.add_option("--checkpoint", o.checkpoint,
                   "save the whole film here while rendering and at the end, for --resume");
    app.add_option("--every", raw.every, "seconds between two checkpoints; default 60");
    app.add_option("--resume", o.resume,
                   "go on from a checkpoint or film; --frames counts from its first sample");
    app.add_option("--size", raw.size, "image size WxH; default the camera's, else 960x540");
    app.add_option("--threads", raw.threads, "worker threads; default all cores");
    app.add_option("--seed", raw.seed, "seed of the random numbers");
    app.add_option("--first-sample", raw.first_sample, "sample indices start here");
    app.add_option("--camera", o.camera, "camera of the file, by name or index");
    app.add_option("--orbit", raw.orbit,
                   "camera X,Y,Z,THETA,PHI,RADIUS,FOVY: target, angles in degrees, vertical fov");
    app.add_option("--scene", o.scene_name, "scene of the file, by name or index");
    app.add_option("--variant", o.variant, "material variant by name");
    app.add_option("--animation-time", o.animation_time,
                   "seconds into the animations; default the rest pose");
    app.add_option("--shutter", o.shutter_seconds,
                   "motion blur: seconds of the animations, from --animation-time (default 0) on");
    app.add_option("--environment", o.environment, "FILE.hdr, FILE.exr or a colour R,G,B");
    app.add_option("--environment-rotation", o.environment_rotation,
                   "degrees, counter-clockwise seen from +Y");
    app.add_option("--exposure", raw.exposure, "exposure in EV");
    app.add_option("--tone-map", raw.tone_map, names_of(kToneMaps));
    app.add_option("--background", raw.background, "environment or transparent");
    app.add_option("--max-depth", raw.max_depth, "most scattering events on a path");
    app.add_option("--sampler", raw.sampler, names_of(kSamplers));
    app.add_option("--filter", raw.filter, names_of(kFilters));
    app.add_option("--texture-filter", raw.texture_filter,
                   "how textures are looked up: none, or cones, which blur them by what a path "
                   "covers (biased)");
    app.add_option("--lights", raw.lights,
                   "how one of many lights is chosen: " + names_of(kLightSelections));
    app.add_option(
        "--environment-sampling", raw.environment_sampling,
        "how directions into an environment image are drawn: " + names_of(kEnvironmentSamplings));
    app.add_option("--light-units", raw.light_units,
                   "what the file's intensities are: spec (candela, lux) or radiometric (watts, "
                   "without 683 lm/W)");
    app.add_option("--sun-angle", o.light_reading.sun_degrees,
                   "angular diameter of directional lights in degrees; the sun's is 0.53");
    app.add_flag("--no-roulette", raw.no_roulette,
                 "follow every path to its end or to --max-depth");
    app.add_flag("--no-nee", raw.no_nee, "no next-event estimation: find lights by chance only");
    app.add_flag("--adaptive", o.render.adaptive,
                 "more samples where the noise is, by blocks of 8x8 pixels");
    app.add_option("--tile-size", raw.tile_size, "pixels a side of a work tile; changes no pixel");
    app.add_option("--effects", raw.effects,
                   "auto, all, or a list of effects to force on, or with -NAME off");
    app.add_option("--aov", raw.aovs,
                   "all, or a list of layers for .exr outputs: " + names_of(kAovs));
    app.add_option("--pixel", raw.pixel,
                   "X,Y: replay one sample of one pixel with a log of its steps");
    app.add_option("--sample", raw.sample, "the sample index that --pixel replays");
    app.add_flag("--strict", o.strict, "fail when any sample was not finite");
    app.add_flag("--json", o.json, "info, effects: print JSON");
    add_isa_option(app);
    app.add_flag("--quiet", raw.quiet, "errors only");
    app.add_option("--log", raw.log, "error, warning, info or debug");
    app.set_version_flag("--version", "talbot " TALBOT_VERSION);
    app.footer(
        "Commands: talbot info SCENE [--json], talbot effects SCENE [--json], talbot accuracy "
        "SCENE, "
        "talbot hardcases, talbot compare A B, talbot merge OUT IN...\n"
        "Exit codes: 0 done, 1 failed, 2 usage, 3 bad input file, 4 cannot write, 130 "
        "interrupted.");
}

Status convert_effects(const std::string& text, Options& o) {
    if (const std::optional<std::string> word =
            parse_effect_list(text, o.render.forced_on, o.render.forced_off)) {
        return usage_error("--effects", "'" + *word +
                                            "' is not an effect; use auto, all, or with commas and "
                                            "with - to take it away " +
                                            names_of(kEffects));
    }
    return Done{};
}

Status convert_aovs(const std::string& text, Options& o) {
    if (text.empty()) return Done{};
    std::size_t start = 0;
    while (text != "all" && start <= text.size()) {
        const std::size_t comma = std::min(text.find(',', start), text.size());
        const std::string word = text.substr(start, comma - start);
        start = comma + 1;
        const std::optional<Aov> aov = aov_from_name(word);
        if (!aov)
            return usage_error("--aov",
                               "'" + word + "' is not known; use all or of " + names_of(kAovs));
        if (std::find(o.aovs.begin(), o.aovs.end(), *aov) == o.aovs.end()) o.aovs.push_back(*aov);
    }
    for (const AovInfo& info : kAovs) {
        if (text == "all") o.aovs.push_back(info.aov);
    }
    // The image is in the file as R, G and B.
    std::erase(o.aovs, Aov::beauty);
    const bool has_exr =
        std::any_of(o.outputs.begin(), o.outputs.end(),
                    [](const std::string& file) { return file.ends_with(".exr"); });
    if (!has_exr)
        return usage_error("--aov", "goes into .exr files; name one with --output FILE.exr");
    return Done{};
}

Status convert_numbers(const RawOptions& raw, Options& o) {
    if (!raw.size.empty()) {
        const Result<Resolution> size = parse_size(raw.size);
        if (!size) return size.error();
        o.size = *size;
    }
    if (!raw.orbit.empty()) {
        const Result<std::vector<double>> n = parse_numbers(raw.orbit, "--orbit", 7);
        if (!n) return n.error();
        const std::vector<double>& v = *n;
        if (!(v[5] > 0)) return usage_error("--orbit", "the radius must be above 0");
        if (!(v[6] > 0 && v[6] < 180))
            return usage_error("--orbit", "the field of view must lie between 0 and 180 degrees");
        o.orbit = Orbit{Vec3d(v[0], v[1], v[2]), v[3], v[4], v[5], v[6]};
    }
    if (!raw.pixel.empty()) {
        const Result<std::vector<double>> n = parse_numbers(raw.pixel, "--pixel", 2);
        if (!n) return n.error();
        for (const double x : *n) {
            if (!(x >= 0 && x <= kMaxSide && x == std::floor(x)))
                return usage_error("--pixel", "'" + raw.pixel + "' is not two whole numbers X,Y");
        }
        o.pixel = PixelAddress{static_cast<uint32_t>((*n)[0]), static_cast<uint32_t>((*n)[1])};
    }
    const auto positive = [](const std::optional<double>& value) {
        return !value || (std::isfinite(*value) && *value > 0);
    };
    if (o.animation_time && !std::isfinite(*o.animation_time))
        return usage_error("--animation-time", "must be a number of seconds");
    if (!(o.shutter_seconds >= 0) || !std::isfinite(o.shutter_seconds))
        return usage_error("--shutter", "must be a number of seconds, 0 or more");
    if (o.render.adaptive && o.shutter_seconds > 0)
        return usage_error("--adaptive", "does not go with motion blur; leave out --shutter");
    if (!positive(o.time_seconds)) return usage_error("--time", "must be above 0 seconds");
    if (!positive(o.target_error_percent))
        return usage_error("--target-error", "must be above 0 per cent");
    if (!positive(raw.every)) return usage_error("--every", "must be above 0 seconds");
    if (raw.every && o.checkpoint.empty())
        return usage_error("--every",
                           "says how often to save; name the file with --checkpoint FILE");
    constexpr double kCheckpointSeconds = 60;
    o.checkpoint_seconds = raw.every.value_or(kCheckpointSeconds);
    if (!std::isfinite(raw.exposure) || std::abs(raw.exposure) > 64)
        return usage_error("--exposure", "must lie between -64 and 64 EV");
    if (!std::isfinite(o.environment_rotation))
        return usage_error("--environment-rotation", "must be a finite angle");
    o.display.exposure_ev = static_cast<float>(raw.exposure);
    return Done{};
}

Status convert_lights(const RawOptions& raw, Options& o) {
    if (Status s = set_from_table(raw.lights, "--lights", kLightSelections,
                                  &LightSelectionInfo::kind, o.render.lights);
        !s)
        return s;
    if (Status s = set_from_table(raw.environment_sampling, "--environment-sampling",
                                  kEnvironmentSamplings, &EnvironmentSamplingInfo::kind,
                                  o.render.environment_sampling);
        !s)
        return s;
    if (Status s = set_from_table(raw.light_units, "--light-units", kLightUnits,
                                  &LightUnitsInfo::units, o.light_reading.units);
        !s)
        return s;
    const std::optional<double>& sun = o.light_reading.sun_degrees;
    if (sun && !(*sun >= 0 && *sun <= 180))
        return usage_error("--sun-angle", "must lie between 0 and 180 degrees");
    return Done{};
}

Status convert(const RawOptions& raw, Options& o) {
    if (Status s = convert_whole_numbers(raw, o); !s) return s;
    if (Status s = convert_numbers(raw, o); !s) return s;
    if (Status s = set_from_table(raw.tone_map, "--tone-map", kToneMaps, &ToneMapInfo::tone_map,
                                  o.display.tone_map);
        !s)
        return s;
    if (Status s = set_from_table(raw.sampler, "--sampler", kSamplers, &SamplerInfo::kind,
                                  o.render.sampler);
        !s)
        return s;
    if (Status s =
            set_from_table(raw.filter, "--filter", kFilters, &FilterInfo::kind, o.render.filter);
        !s)
        return s;
    if (Status s = set_from_table(raw.texture_filter, "--texture-filter", kTextureFilterings,
                                  &TextureFilteringInfo::kind, o.render.texture_filter);
        !s)
        return s;
    if (Status s = convert_lights(raw, o); !s) return s;
    if (Status s = convert_effects(raw.effects, o); !s) return s;
    if (Status s = convert_aovs(raw.aovs, o); !s) return s;
    if (raw.background != "environment" && raw.background != "transparent") {
        return usage_error("--background",
                           "'" + raw.background + "' is not known; use environment or transparent");
    }
    o.render.transparent_background = raw.background == "transparent";
    o.render.russian_roulette = !raw.no_roulette;
    o.render.next_event_estimation = !raw.no_nee;
    const std::vector<std::pair<std::string, LogLevel>> levels{{"error", LogLevel::error},
                                                               {"warning", LogLevel::warning},
                                                               {"info", LogLevel::info},
                                                               {"debug", LogLevel::debug}};
    bool known = false;
    for (const auto& [name, level] : levels) {
        if (name == raw.log) {
            o.log_level = level;
            known = true;
        }
    }
    if (!known)
        return usage_error("--log",
                           "'" + raw.log + "' is not known; use error, warning, info or debug");
    if (raw.quiet) o.log_level = LogLevel::error;
    return Done{};
}

// Options that would be ignored beside each other are refused.
Status check_combination(const RawOptions& raw, const Options& o) {
    const bool writes = !o.outputs.empty() || !o.film.empty() || !o.checkpoint.empty() ||
                        !o.resume.empty() || !o.screenshot.empty();
    const bool ends = o.frames || o.time_seconds || o.target_error_percent;
    if (o.json && o.command == Command::render)
        return usage_error("--json", "goes with info and effects; use --report FILE");
    if (o.command != Command::render &&
        (writes || o.pixel || !o.report.empty() || !o.interact.empty()))
        return usage_error("command line",
                           "info and effects print and write no file; leave out "
                           "--output and the like");
    if (o.pixel && (writes || ends || !o.report.empty() || !o.interact.empty()))
        return usage_error("--pixel",
                           "replays one sample and writes no file; leave out the others");
    if (!o.pixel && !raw.sample.empty())
        return usage_error("--sample", "says which sample --pixel X,Y replays; give that, too");
    if (!o.interact.empty() && writes)
        return usage_error("--interact",
                           "writes files by its own steps (save, screenshot); leave out "
                           "--output and the like");
    if (o.orbit && !o.camera.empty())
        return usage_error("--orbit", "is itself a camera; leave out --camera");
    return Done{};
}

}  // namespace

Result<std::optional<Options>> parse_options(std::span<const std::string> words) {
    Options options;
    RawOptions raw;
    CLI::App app("Talbot: an interactive progressive path tracer for glTF scenes", "talbot");
    if (!words.empty() && (words.front() == "info" || words.front() == "effects")) {
        options.command = words.front() == "info" ? Command::info : Command::effects;
        words = words.subspan(1);
    }
    declare(app, options, raw);
    const Result<bool> parsed = parse_words(app, words);
    if (!parsed) return parsed.error();
    if (!*parsed) return std::optional<Options>();
    if (Status status = convert(raw, options); !status) return status.error();
    if (Status status = check_combination(raw, options); !status) return status.error();
    return std::optional<Options>(std::move(options));
}

}  // namespace talbot
