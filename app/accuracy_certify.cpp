// `talbot accuracy certify`: scenes x seeds x milestones, each stated error against the truth.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <vector>

#include "app/accuracy.h"
#include "app/accuracy_render.h"
#include "app/exit_code.h"
#include "core/base/log.h"
#include "core/io/image_io.h"
#include "ui/data_path.h"

namespace talbot {
namespace {

using nlohmann::ordered_json;

// What --target-error is asked for in the stop test; only targets that are met on the way count.
constexpr double kTargets[] = {50, 20, 10, 5, 2, 1};
// Octaves that must have been seen before a prediction counts.
constexpr std::size_t kOctavesForPrediction = 3;

struct CertifyOptions {
    std::vector<std::string> scenes;
    uint64_t seeds = 20;
    uint64_t from = 8;
    uint64_t to = 256;
    uint64_t reference_factor = 64;
    uint64_t pixels = 5184;
    unsigned threads = 0;
    std::string environment, cache, json;
    bool quick = false;
};

Error usage(const std::string& what) {
    return {ErrorKind::usage, "", "accuracy certify", what};
}

// Empty when help was printed.
Result<std::optional<CertifyOptions>> parse(std::span<const std::string> args) {
    CertifyOptions o;
    CLI::App app("Stated errors against true ones; exit code 1 when a promise is broken",
                 "talbot accuracy certify");
    app.add_option("SCENE", o.scenes, "glTF scenes; without any, the built-in ones");
    app.add_option("--seeds", o.seeds, "renders of every scene (20)");
    app.add_option("--from", o.from, "first milestone in samples a pixel, a power of two (8)");
    app.add_option("--to", o.to, "last milestone, a power of two (256)");
    app.add_option("--reference-factor", o.reference_factor,
                   "samples of the reference over those of the last milestone (64)");
    app.add_option("--pixels", o.pixels, "about so many pixels an image (5184)");
    app.add_option("--environment", o.environment, "FILE.hdr, FILE.exr or a colour R,G,B");
    app.add_option("--cache", o.cache, "existing folder that keeps the references as raw films");
    app.add_option("--json", o.json, "write all claims as JSON; - is the standard output");
    app.add_option("--threads", o.threads, "worker threads; default all cores");
    app.add_flag("--quick", o.quick, "4 seeds up to 64 samples of 2304 pixels");
    try {
        app.parse(std::vector<std::string>(args.rbegin(), args.rend()));
    } catch (const CLI::Success& success) {
        app.exit(success);
        return std::optional<CertifyOptions>();
    } catch (const CLI::ParseError& error) {
        std::string what = error.what();
        std::replace(what.begin(), what.end(), '\n', ' ');
        return usage(what + "; see talbot accuracy certify --help");
    }
    if (o.quick) {
        o.seeds = 4;
        o.to = 64;
        o.pixels = 2304;
    }
    if (o.seeds == 0 || o.seeds > 100000) return usage("--seeds must lie between 1 and 100000");
    if (!std::has_single_bit(o.from) || !std::has_single_bit(o.to) || o.from < 2 || o.to < o.from ||
        o.to > 1u << 20)
        return usage("--from and --to must be powers of two, from 2 to 1048576, in this order");
    if (o.reference_factor < 4 || o.reference_factor > 4096)
        return usage("--reference-factor must lie between 4 and 4096");
    if (o.pixels < 64 || o.pixels > 1u << 24)
        return usage("--pixels must lie between 64 and 16777216");
    if (!o.cache.empty() && !std::filesystem::is_directory(o.cache))
        return usage("--cache: the folder '" + o.cache + "' does not exist");
    if (o.scenes.empty()) {
        for (const char* name :
             {"cornell.gltf", "hero.glb", "spheres.gltf", "report.gltf", "report-extended.gltf"})
            o.scenes.push_back(find_data(std::string("scenes/") + name).string());
    }
    return std::optional<CertifyOptions>(o);
}

// The first number of samples in (n, 2n] at which --target-error would stop, 0 if none.
uint64_t stop_within(const ErrorEstimate& at_n, const ErrorTracker& tracker, double target) {
    const uint64_t n = at_n.samples;
    for (uint64_t m = n; m <= 2 * n; ++m) {
        if (tracker.at(m, 0).hi95 <= target) return m;
    }
    return 0;
}

struct Milestone {
    ErrorEstimate error;
    double truth = 0;
    double cpu_seconds = 0;
};

// One render: its claims are added to the calibration, the milestones to the JSON.
void certify_seed(const AccuracyScene& scene, const RenderSettings& settings,
                  const CertifyOptions& options, const Reference& reference, WorkerPool& pool,
                  Calibration& calibration, ordered_json& claims) {
    MeasuredRender render(scene, settings, pool);
    render.render_until(1);
    Film half = render.film();
    std::vector<Milestone> milestones;
    std::vector<double> open(std::begin(kTargets), std::end(kTargets));
    for (uint64_t n = 2; n <= options.to; n *= 2) {
        render.render_until(n);
        Milestone m{render.tracker().estimate(), true_error_percent(render.film(), reference),
                    render.cpu_seconds()};
        const ErrorEstimate& e = m.error;
        if (n >= options.from) {
            calibration.errors.push_back({settings.seed, n, e.relrmse_percent, e.lo95, e.hi95,
                                          m.truth, e.exponent, e.trust});
        }
        ordered_json octave{
            {"seed", settings.seed},
            {"samples", n},
            {"relrmse_percent", e.relrmse_percent},
            {"lo95", e.lo95},
            {"hi95", e.hi95},
            {"truth", m.truth},
            {"exponent", e.exponent},
            {"trust", trust_name(e.trust)},
            {"difference", e.octaves.back().difference},
            {"standard_error", e.octaves.back().standard_error},
            {"difference_by_reference",
             relative_difference(render.film(), half, reference, metric_constant(0))},
            {"top_share", e.top_share},
            {"tail_index", e.tail_index},
            {"energy_drift", e.energy_drift},
            {"cpu_seconds", m.cpu_seconds}};
        claims.push_back(std::move(octave));
        half = render.film();
        milestones.push_back(std::move(m));
        if (n == options.to) break;
        // A target that is met before the first milestone says nothing about the rule.
        std::erase_if(open, [&](double target) {
            if (render.tracker().at(n, 0).hi95 <= target) return true;
            if (n < options.from) return false;
            const uint64_t stop = stop_within(e, render.tracker(), target);
            if (stop == 0 || stop == 2 * n) return false;
            MeasuredRender stopped(scene, settings, pool);
            stopped.render_unobserved(stop);
            calibration.stops.push_back({settings.seed, stop, target,
                                         true_error_percent(stopped.film(), reference), e.trust});
            return true;
        });
    }
    // CPU seconds, for the machine may have other work.
    for (std::size_t i = kOctavesForPrediction - 1; i < milestones.size(); ++i) {
        for (std::size_t j = i + 1; j < milestones.size(); ++j) {
            ErrorEstimate e = milestones[i].error;
            if (e.samples < options.from || !(milestones[j].truth < e.relrmse_percent)) continue;
            e.seconds_per_sample = milestones[i].cpu_seconds / static_cast<double>(e.samples);
            const ErrorEstimate::Prediction p = e.seconds_to(milestones[j].truth);
            if (!p.valid) continue;
            const double spent = milestones[i].cpu_seconds;
            calibration.predictions.push_back({settings.seed, e.samples, milestones[j].truth,
                                               spent + p.seconds, spent + p.lo95, spent + p.hi95,
                                               milestones[j].cpu_seconds, e.trust});
        }
    }
}

ordered_json summary_json(const CalibrationSummary& s) {
    return {{"claims", s.claims},
            {"coverage", s.coverage},
            {"coverage_sd", s.coverage_sd},
            {"estimate_over_truth", s.ratio},
            {"interval_log_width", s.mean_width},
            {"predictions", s.predictions},
            {"predictions_close", s.predictions_close},
            {"predictions_inside", s.predictions_inside},
            {"actual_over_predicted", s.prediction_ratio},
            {"stops", s.stops},
            {"stops_kept", s.stops_kept},
            {"truth_over_target", s.stop_ratio},
            {"light", {{"green", s.green}, {"amber", s.amber}, {"red", s.red}}}};
}

void print_header() {
    std::printf("%-22s %7s %9s %12s %7s %12s %10s %9s  %s\n", "scene", "claims", "coverage",
                "est./truth", "width", "pred. close", "act./pred.", "stop", "green/amber/red");
}

void print_row(const std::string& name, const CalibrationSummary& s) {
    std::printf(
        "%-22s %7zu %7.1f %% %12.3f %5.1f %% %10.1f %% %10.3f %9.3f  %3.0f/%3.0f/%3.0f %%\n",
        name.c_str(), s.claims, 100 * s.coverage, s.ratio, 100 * (std::exp(0.5 * s.mean_width) - 1),
        100 * s.predictions_close, s.prediction_ratio, s.stop_ratio, 100 * s.green, 100 * s.amber,
        100 * s.red);
    std::fflush(stdout);
}

// About as many pixels as asked for, in the camera's aspect.
Resolution scaled_size(const SceneSetup& setup, uint64_t pixels) {
    const double aspect = static_cast<double>(setup.settings.width) / setup.settings.height;
    const double height = std::sqrt(static_cast<double>(pixels) / aspect);
    return {static_cast<uint32_t>(std::max(1.0, std::round(height * aspect))),
            static_cast<uint32_t>(std::max(1.0, std::round(height)))};
}

Status certify(const CertifyOptions& options, bool& kept) {
    WorkerPool pool(options.threads);
    std::vector<Calibration> all;
    ordered_json rows = ordered_json::array();
    if (options.json != "-") print_header();
    std::vector<std::string> broken;
    for (const std::string& file : options.scenes) {
        Options scene_options;
        scene_options.scene_file = file;
        scene_options.environment = options.environment;
        Result<AccuracyScene> scene = load_accuracy_scene(scene_options, pool);
        if (!scene) return scene.error();
        RenderSettings settings = scene->setup.settings;
        const Resolution size = scaled_size(scene->setup, options.pixels);
        settings.width = size.width;
        settings.height = size.height;
        const Result<Reference> reference = render_reference(
            *scene, settings, options.reference_factor * options.to, options.cache, pool);
        if (!reference) return reference.error();
        Calibration calibration;
        calibration.scene = scene->name;
        ordered_json claims = ordered_json::array();
        for (uint64_t seed = 0; seed < options.seeds; ++seed) {
            settings.seed = seed;
            certify_seed(*scene, settings, options, *reference, pool, calibration, claims);
        }
        const CalibrationSummary summary = summarise({&calibration});
        if (options.json != "-") print_row(calibration.scene, summary);
        for (const std::string& line : broken_promises(summary, false))
            broken.push_back(calibration.scene + ": " + line);
        rows.push_back({{"scene", file},
                        {"size", {settings.width, settings.height}},
                        {"reference_samples", reference->samples},
                        {"summary", summary_json(summary)},
                        {"claims", std::move(claims)}});
        all.push_back(std::move(calibration));
    }
    std::vector<const Calibration*> parts;
    for (const Calibration& c : all) parts.push_back(&c);
    const CalibrationSummary whole = summarise(parts);
    for (const std::string& line : broken_promises(whole, true)) broken.push_back("all: " + line);
    kept = broken.empty();
    if (options.json != "-") {
        print_row("all", whole);
        for (const std::string& line : broken) std::printf("BROKEN %s\n", line.c_str());
        std::printf(kept ? "kept: the stated errors are true\n" : "broken\n");
    }
    if (options.json.empty()) return Done{};
    const ordered_json j{{"schema", "talbot-certify/1"},
                         {"seeds", options.seeds},
                         {"milestones", {options.from, options.to}},
                         {"reference_factor", options.reference_factor},
                         {"scenes", std::move(rows)},
                         {"all", summary_json(whole)},
                         {"broken", broken}};
    const std::string text = j.dump(1) + "\n";
    if (options.json == "-") {
        std::fputs(text.c_str(), stdout);
        return Done{};
    }
    return write_file_atomically(options.json,
                                 {reinterpret_cast<const uint8_t*>(text.data()), text.size()});
}

}  // namespace

int run_certify(std::span<const std::string> args) {
    const Result<std::optional<CertifyOptions>> options = parse(args);
    if (options && !*options) return kExitDone;
    bool kept = true;
    const Status status = options ? certify(**options, kept) : Status(options.error());
    if (status) return kept ? kExitDone : kExitFailed;
    log_error(status.error().line());
    return exit_code(status.error());
}

}  // namespace talbot
