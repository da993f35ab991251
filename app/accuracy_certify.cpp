// `talbot accuracy certify`: scenes x seeds x milestones, each stated error against the truth.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <iterator>
#include <nlohmann/json.hpp>
#include <sstream>
#include <vector>

#include "app/accuracy.h"
#include "app/accuracy_claims.h"
#include "app/exit_code.h"
#include "app/interrupt.h"
#include "app/json_figures.h"
#include "app/output_files.h"
#include "app/sub_command.h"
#include "core/base/log.h"
#include "core/io/image_io.h"
#include "ui/data_path.h"

namespace talbot {
namespace {

using nlohmann::ordered_json;

struct CertifyOptions {
    std::vector<std::string> scenes;
    uint64_t seeds = 20;
    uint64_t from = 4;
    uint64_t to = 128;
    uint64_t reference_factor = 64;
    uint64_t pixels = 2304;
    unsigned threads = 0;
    uint64_t stop_to = 0;
    std::string environment, cache, json, list;
    bool quick = false;
};

// Empty when help was printed.
Result<std::optional<CertifyOptions>> parse_certify(std::span<const std::string> args) {
    CertifyOptions o;
    CLI::App app("Stated errors against true ones; exit code 1 when a promise is broken",
                 "talbot accuracy certify");
    app.add_option("SCENE", o.scenes, "glTF scenes; without any, the built-in ones");
    const CLI::Option* seeds =
        app.add_option("--seeds", o.seeds, "renders of every scene (20; with --quick 4)");
    app.add_option("--from", o.from, "first milestone in samples a pixel, a power of two (4)");
    const CLI::Option* to =
        app.add_option("--to", o.to, "last milestone, a power of two (128; with --quick 64)");
    app.add_option("--reference-factor", o.reference_factor,
                   "samples of the reference over those of the last milestone (64)");
    const CLI::Option* pixels =
        app.add_option("--pixels", o.pixels,
                       "about so many pixels an image (2304; with --quick 1024), where a list "
                       "gives no --size");
    app.add_option(
        "--stop-to", o.stop_to,
        "samples up to which every fifth render goes on for the stop rule (4 times --to)");
    app.add_option("--list", o.list,
                   "text file: on each line a scene and options of a render, for all of which the "
                   "promises must hold");
    app.add_option("--environment", o.environment, "FILE.hdr, FILE.exr or a colour R,G,B");
    app.add_option("--cache", o.cache, "existing folder that keeps the references as raw films");
    app.add_option("--json", o.json, "write all claims as JSON; - is the standard output");
    app.add_option("--threads", o.threads, "worker threads; default all cores");
    app.add_flag("--quick", o.quick, "fewer and smaller renders: minutes");
    const Result<bool> parsed = parse_words(app, args);
    if (!parsed) return parsed.error();
    if (!*parsed) return std::optional<CertifyOptions>();
    if (o.quick && seeds->empty()) o.seeds = 4;
    if (o.quick && to->empty()) o.to = std::max<uint64_t>(o.from, 64);
    if (o.quick && pixels->empty()) o.pixels = 1024;
    if (o.seeds == 0 || o.seeds > 100000)
        return usage_error("accuracy certify", "--seeds must lie between 1 and 100000");
    if (!std::has_single_bit(o.from) || !std::has_single_bit(o.to) || o.from < 2 || o.to < o.from ||
        o.to > 1u << 20)
        return usage_error(
            "accuracy certify",
            "--from and --to must be powers of two, from 2 to 1048576, in this order");
    if (o.stop_to == 0) o.stop_to = std::min<uint64_t>(4 * o.to, 1u << 20);
    if (!std::has_single_bit(o.stop_to) || o.stop_to < o.to || o.stop_to > 1u << 20)
        return usage_error("accuracy certify",
                           "--stop-to must be a power of two, from --to to 1048576");
    if (o.reference_factor < 4 || o.reference_factor > 4096)
        return usage_error("accuracy certify", "--reference-factor must lie between 4 and 4096");
    if (o.pixels < 64 || o.pixels > 1u << 24)
        return usage_error("accuracy certify", "--pixels must lie between 64 and 16777216");
    if (!o.cache.empty() && !std::filesystem::is_directory(o.cache))
        return usage_error("accuracy certify",
                           "--cache: the folder '" + o.cache + "' does not exist");
    if (!o.cache.empty() && o.json.ends_with(".film"))
        return usage_error("--json", "must not end in .film, as the references in the cache do");
    if (o.scenes.empty() && o.list.empty()) {
        for (const char* name : {"cornell.gltf", "hero.glb", "spheres.gltf", "report.gltf",
                                 "report-extended.gltf", "rare-light.gltf"})
            o.scenes.push_back(find_data(std::string("scenes/") + name).string());
    }
    return std::optional<CertifyOptions>(o);
}

// Figures of nothing are null.
ordered_json summary_json(const CalibrationSummary& s) {
    return {{"claims", s.claims},
            {"coverage", json_number_if(s.claims > 0, s.coverage)},
            {"coverage_sd", json_number_if(s.claims > 0, s.coverage_sd)},
            {"estimate_over_truth", json_number_if(s.claims > 0, s.ratio)},
            {"interval_log_width", json_number_if(s.claims > 0, s.mean_width)},
            {"predictions", s.predictions},
            {"predictions_firm", s.predictions_firm},
            {"predictions_close", json_number_if(s.predictions_firm > 0, s.predictions_close)},
            {"predictions_close_in_seconds",
             json_number_if(s.predictions_firm > 0, s.predictions_close_seconds)},
            {"predictions_inside", json_number_if(s.predictions > 0, s.predictions_inside)},
            {"all_predictions_close", json_number_if(s.predictions > 0, s.all_predictions_close)},
            {"actual_over_predicted", json_number_if(s.predictions_firm > 0, s.prediction_ratio)},
            {"stops", s.stops},
            {"stops_kept", json_number_if(s.stops > 0, s.stops_kept)},
            {"truth_over_target", json_number_if(s.stops > 0, s.stop_ratio)},
            {"stop_brightness_percent", json_number_if(s.lit_stops > 0, s.stop_brightness_percent)},
            {"stop_brightness_sd", json_number_if(s.lit_stops > 0, s.stop_brightness_sd)},
            {"light", {{"green", s.green}, {"amber", s.amber}, {"red", s.red}}}};
}

void print_header() {
    std::printf("%-26s %7s %9s %11s %7s %10s %9s %12s %11s %10s %7s %11s  %s\n", "scene", "claims",
                "coverage", "est./truth", "width", "pred. band", "firm", "firm close", "by seconds",
                "act./pred.", "stop", "brightness", "green/amber/red");
    std::fflush(stdout);
}

std::string figure_or_dash(const char* format, double value, std::size_t of) {
    char text[32] = "-";
    if (of > 0) std::snprintf(text, sizeof(text), format, value);
    return text;
}

std::string percent_or_dash(double share, std::size_t of) {
    return figure_or_dash("%.1f %%", 100 * share, of);
}

void print_row(const std::string& name, const CalibrationSummary& s) {
    const std::string firm =
        std::to_string(s.predictions_firm) + "/" + std::to_string(s.predictions);
    std::printf(
        "%-26s %7zu %9s %11s %7s %10s %9s %12s %11s %10s %7s %11s  "
        "%3.0f/%3.0f/%3.0f %%\n",
        name.c_str(), s.claims, percent_or_dash(s.coverage, s.claims).c_str(),
        figure_or_dash("%.3f", s.ratio, s.claims).c_str(),
        percent_or_dash(std::exp(0.5 * s.mean_width) - 1, s.claims).c_str(),
        percent_or_dash(s.predictions_inside, s.predictions).c_str(), firm.c_str(),
        percent_or_dash(s.predictions_close, s.predictions_firm).c_str(),
        percent_or_dash(s.predictions_close_seconds, s.predictions_firm).c_str(),
        figure_or_dash("%.3f", s.prediction_ratio, s.predictions_firm).c_str(),
        figure_or_dash("%.3f", s.stop_ratio, s.stops).c_str(),
        figure_or_dash("%+.2f %%", s.stop_brightness_percent, s.lit_stops).c_str(), 100 * s.green,
        100 * s.amber, 100 * s.red);
    std::fflush(stdout);
}

// About as many pixels as asked for, in the camera's aspect.
Resolution scaled_size(const SceneSetup& setup, uint64_t pixels) {
    const double aspect = static_cast<double>(setup.settings.width) / setup.settings.height;
    const double height = std::sqrt(static_cast<double>(pixels) / aspect);
    return {static_cast<uint32_t>(std::max(1.0, std::round(height * aspect))),
            static_cast<uint32_t>(std::max(1.0, std::round(height)))};
}

// The scenes given, and those of the list with their options.
Result<std::vector<Options>> scenes_of(const CertifyOptions& options) {
    std::vector<Options> scenes;
    for (const std::string& file : options.scenes) {
        Options scene;
        scene.scene_file = file;
        scene.environment = options.environment;
        scenes.push_back(std::move(scene));
    }
    if (options.list.empty()) return scenes;
    const Result<std::vector<uint8_t>> text = read_file(options.list);
    if (!text) return text.error();
    std::istringstream lines(std::string(text->begin(), text->end()));
    int number = 0;
    for (std::string line; std::getline(lines, line);) {
        ++number;
        std::istringstream words(line.substr(0, line.find('#')));
        const std::vector<std::string> given{std::istream_iterator<std::string>(words), {}};
        if (given.empty()) continue;
        const Result<std::optional<Options>> scene = parse_options(given);
        if (!scene)
            return Error{ErrorKind::bad_input, options.list, "line " + std::to_string(number),
                         scene.error().line()};
        if (!*scene || (*scene)->scene_file.empty())
            return Error{ErrorKind::bad_input, options.list, "line " + std::to_string(number),
                         "begins with no scene"};
        if ((*scene)->acts() || (*scene)->command != Command::render)
            return Error{ErrorKind::bad_input, options.list, "line " + std::to_string(number),
                         "certify says itself how long it renders and what it writes; leave out "
                         "--frames, --time, --output and the like"};
        scenes.push_back(**scene);
    }
    if (scenes.empty()) return Error{ErrorKind::bad_input, options.list, "", "contains no scene"};
    return scenes;
}

std::string words_of(const Options& o) {
    std::string name = scene_path(o).filename().string();
    if (!o.render.next_event_estimation) name += " no-nee";
    if (o.render.adaptive) name += " adaptive";
    if (o.display.exposure_ev != 0) {
        char text[32];
        std::snprintf(text, sizeof(text), " %+.3g EV", static_cast<double>(o.display.exposure_ev));
        name += text;
    }
    return name;
}

ordered_json stops_json(const Calibration& calibration) {
    ordered_json rows = ordered_json::array();
    for (const StopClaim& s : calibration.stops) {
        rows.push_back({{"seed", s.seed},
                        {"samples", s.samples},
                        {"target_percent", s.target_percent},
                        {"truth", s.truth},
                        {"brightness_percent", s.brightness_percent},
                        {"trust", trust_name(s.trust)}});
    }
    return rows;
}

Status certify(const CertifyOptions& options, bool& kept) {
    leave_on_interrupt();
    Result<std::vector<Options>> scenes = scenes_of(options);
    if (!scenes) return scenes.error();
    std::vector<std::string> inputs{options.list};
    for (Options& scene : *scenes) {
        scene.command_files = {options.json};
        inputs.insert(inputs.end(), {scene_path(scene).string(), scene.environment});
    }
    if (Status s = check_output_files({options.json}, inputs); !s) return s;
    WorkerPool pool(options.threads);
    std::vector<Calibration> all;
    ordered_json rows = ordered_json::array();
    bool has_header = options.json == "-";
    std::vector<std::string> broken;
    for (const Options& scene_options : *scenes) {
        Result<AccuracyScene> scene = load_accuracy_scene(scene_options, pool);
        if (!scene) return scene.error();
        // References of the same scene with other settings are other files of the cache.
        if (!scene_options.render.next_event_estimation) scene->name += "-no-nee";
        RenderSettings settings = scene->setup.settings;
        const Resolution size =
            scene_options.size ? *scene_options.size : scaled_size(scene->setup, options.pixels);
        settings.width = size.width;
        settings.height = size.height;
        const Result<Reference> reference = render_reference(
            *scene, settings, options.reference_factor * options.to, options.cache, pool);
        if (!reference) return reference.error();
        if (!has_header) print_header();
        has_header = true;
        Calibration calibration;
        calibration.scene = words_of(scene_options);
        ordered_json claims = ordered_json::array();
        for (uint64_t seed = 0; seed < options.seeds; ++seed) {
            constexpr uint64_t kLongRenders = 5;  // one in so many
            settings.seed = seed;
            ClaimPlan plan{options.from, options.to, options.to};
            if (seed % kLongRenders == 0) plan.stop_to = options.stop_to;
            claim_seed(*scene, settings, plan, *reference, pool, calibration, claims);
        }
        const CalibrationSummary summary = summarise({&calibration});
        if (options.json != "-") print_row(calibration.scene, summary);
        for (const std::string& line : broken_promises(summary, false))
            broken.push_back(calibration.scene + ": " + line);
        rows.push_back({{"scene", calibration.scene},
                        {"file", scene_path(scene_options).string()},
                        {"size", {settings.width, settings.height}},
                        {"exposure_ev", scene->exposure_ev},
                        {"reference_samples", reference->samples},
                        {"summary", summary_json(summary)},
                        {"stops", stops_json(calibration)},
                        {"claims", std::move(claims)}});
        all.push_back(std::move(calibration));
    }
    std::vector<const Calibration*> parts;
    for (const Calibration& c : all) parts.push_back(&c);
    const CalibrationSummary whole = summarise(parts);
    for (const std::string& line : broken_promises(whole, true)) broken.push_back("all: " + line);
    kept = broken.empty() && whole.claims > 0;
    if (options.json != "-") {
        print_row("all", whole);
        for (const std::string& line : broken) std::printf("BROKEN %s\n", line.c_str());
        std::printf("%s\n", whole.claims == 0 ? "nothing was proved: no claim had a green light"
                            : kept            ? "kept: the stated errors are true"
                                              : "broken");
    }
    if (options.json.empty()) return Done{};
    const ordered_json j{{"schema", "talbot-certify/1"},
                         {"seeds", options.seeds},
                         {"milestones", {options.from, options.to}},
                         {"stop_to", options.stop_to},
                         {"reference_factor", options.reference_factor},
                         {"scenes", std::move(rows)},
                         {"all", summary_json(whole)},
                         {"broken", broken},
                         {"kept", kept}};
    return write_text(options.json, j.dump(1) + "\n");
}

}  // namespace

int run_certify(std::span<const std::string> args) {
    const Result<std::optional<CertifyOptions>> options = parse_certify(args);
    if (options && !*options) return kExitDone;
    bool kept = true;
    const Status status = options ? certify(**options, kept) : Status(options.error());
    if (status) return kept ? kExitDone : kExitFailed;
    log_error(status.error().line());
    return exit_code(status.error());
}

}  // namespace talbot
