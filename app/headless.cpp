#include "app/headless.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>

#include "app/aov_layers.h"
#include "app/checkpoint.h"
#include "app/exit_code.h"
#include "app/interrupt.h"
#include "app/output_files.h"
#include "app/progress_line.h"
#include "app/run_record.h"
#include "app/scene_assets.h"
#include "app/scene_setup.h"
#include "app/viewer.h"
#include "core/io/film_file.h"
#include "core/io/image_io.h"
#include "core/scene/effects_off.h"
#include "core/session/session.h"

namespace talbot {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

Status check_image_kinds(const Options& options) {
    for (const std::string& output : options.outputs) {
        if (!is_picture(output)) {
            return Error{
                ErrorKind::usage, output, "--output",
                "unknown kind '" + extension_of(output) + "'; use .png, .exr, .hdr or .pfm"};
        }
    }
    if (Status status = check_no_stream(options.film, "--film"); !status) return status;
    if (Status status = check_no_stream(options.checkpoint, "--checkpoint"); !status) return status;
    return check_png(options.screenshot, "--screenshot");
}

Status check_outputs(const Options& options) {
    if (Status status = check_image_kinds(options); !status) return status;
    // A film may replace the one that it goes on from; nothing else may.
    std::vector<std::string> others = options.outputs;
    others.insert(others.end(), {options.report, options.screenshot});
    if (Status status = check_not_inputs(others, {options.resume}); !status) return status;
    return check_output_files(options.written_files(),
                              {scene_path(options).string(), options.environment});
}

// --strict gives its answer by the exit code.
bool writes_nothing(const Options& o) {
    return o.outputs.empty() && o.report.empty() && o.film.empty() && o.checkpoint.empty() &&
           o.screenshot.empty() && !o.strict;
}

std::string progress_text(const Snapshot& s, uint64_t frames) {
    char text[160];
    int used = std::snprintf(text, sizeof(text), "%llu", static_cast<unsigned long long>(s.passes));
    const auto append = [&](const char* format, auto... values) {
        if (used > 0 && static_cast<std::size_t>(used) < sizeof(text)) {
            used += std::snprintf(text + used, sizeof(text) - static_cast<std::size_t>(used),
                                  format, values...);
        }
    };
    if (frames > 0) append("/%llu", static_cast<unsigned long long>(frames));
    append(" passes, %.1f s", s.render_seconds);
    if (s.error.valid) append(", error %.2f %%", s.error.relrmse_percent);
    if (frames > s.passes && s.passes > 0) {
        append(", %.0f s left", s.render_seconds / static_cast<double>(s.passes) *
                                    static_cast<double>(frames - s.passes));
    }
    return text;
}

// Waits for the end of the render, or for a signal; true when interrupted.
bool wait_for_end(RenderSession& session, uint64_t generation, const Options& options) {
    ProgressLine progress;
    Clock::time_point last = Clock::now();
    for (;;) {
        if (session.wait_for(generation, UINT64_MAX, 0.05)) break;
        if (is_interrupted()) break;
        if (progress.is_active() && seconds_since(last) > 0.5) {
            last = Clock::now();
            if (const auto snapshot = session.latest())
                progress.show(progress_text(*snapshot, options.frames.value_or(0)));
        }
    }
    progress.keep();
    return is_interrupted();
}

Metadata metadata_of(const Snapshot& s) {
    Metadata metadata{{"Software", "Talbot " TALBOT_VERSION},
                      {"Scene", s.scene->file()},
                      {"Samples", std::to_string(s.passes)},
                      {"Seed", std::to_string(s.settings.seed)}};
    if (s.settings.texture_filter != TextureFiltering::none)
        metadata.push_back({"TextureFilter", "cones"});
    const EffectSet off = s.settings.forced_off & s.effects.active;
    if (off != EffectSet{}) metadata.push_back({"EffectsForcedOff", effect_names(off)});
    return metadata;
}

// Every file, whatever becomes of the others; the first error.
Status write_files(const Options& options, const SceneSetup& setup, RenderSession& session,
                   const Snapshot& s, WorkerPool& pool, std::string& film_hash) {
    Status first = Done{};
    const auto note = [&first](Status status) {
        if (status) return;
        if (first)
            first = std::move(status);
        else
            log_error(status.error().line());
    };
    std::vector<ImageLayer> layers;
    if (!options.aovs.empty()) {
        session.with_film(
            [&](const FilmView& view) { layers = make_aov_layers(options.aovs, s, view, pool); });
    }
    for (const std::string& output : options.outputs) {
        note(save_picture(output, *s.image, options.display, layers, metadata_of(s)));
    }
    session.with_film([&](const FilmView& view) {
        if (!options.report.empty()) film_hash = view.film.hash();
        for (const std::string& file : {options.film, options.checkpoint}) {
            if (file.empty()) continue;
            note(save_film(file, view.film,
                           film_metadata(setup.identity, *s.scene, s.camera, s.settings, view),
                           view.error));
        }
    });
    if (!options.screenshot.empty()) {
        ScreenshotOptions window;
        window.display = options.display;
        note(save_window_screenshot(session, window, options.screenshot));
    }
    return first;
}

int report_error(const Error& error) {
    log_error(error.line());
    return exit_code(error);
}

// What ends the run. What writing takes is not known before; a small share of the budget is kept
// for it.
SessionPolicy policy_of(const Options& options, Clock::time_point process_start) {
    constexpr double kWriteShare = 0.02;
    SessionPolicy policy;
    policy.threads = options.threads;
    if (options.time_seconds) {
        const double left =
            *options.time_seconds * (1 - kWriteShare) - seconds_since(process_start);
        policy.time_limit_seconds = std::max(left, 1e-3);
    }
    if (options.target_error_percent) policy.target_error_percent = *options.target_error_percent;
    return policy;
}

// 0 = no limit. Without any end, one pass, or those of a film that is gone on from.
uint64_t pass_limit(const Options& options, const std::optional<FilmFile>& resumed) {
    if (options.frames) return *options.frames;
    if (options.time_seconds || options.target_error_percent) return 0;
    return resumed ? std::max<uint64_t>(1, resumed->passes()) : 1;
}

// Renders to the end or a signal; true when interrupted.
bool render(RenderSession& session, const Options& options, const SceneSetup& setup,
            std::optional<FilmFile> resumed) {
    session.submit(SetSettings{setup.settings});
    session.submit(SetPassLimit{pass_limit(options, resumed)});
    session.submit(SetErrorExposure{options.display.exposure_ev});
    if (resumed) {
        const FilmMetadata& m = resumed->metadata;
        session.submit(SetFilm{std::make_shared<FilmState>(
            FilmState{std::move(resumed->film), std::move(resumed->error), m.render_seconds, m.rays,
                      m.nonfinite})});
    }
    const uint64_t generation = session.submit(SetScene{setup.scene, setup.camera});
    std::optional<CheckpointWriter> checkpoints;
    if (!options.checkpoint.empty())
        checkpoints.emplace(session, setup, options.checkpoint, options.checkpoint_seconds);
    const bool interrupted = wait_for_end(session, generation, options);
    session.stop();
    return interrupted;
}

// A target is no promise where the light is red, and none is met where nothing differed.
void warn_of_trust(const Options& options, const ErrorEstimate& error) {
    if (!options.target_error_percent || (error.valid && error.trust != Trust::red)) return;
    if (error.valid)
        log_warning("--target-error: the error may be larger than it looks: " + error.why);
    else if (!error.why.empty())
        log_warning("--target-error: the error is not known: " + error.why);
}

int finish(const Options& options, const SceneSetup& setup, RenderSession& session,
           WorkerPool& pool, RunRecord record) {
    const Clock::time_point write_start = Clock::now();
    const Status written =
        write_files(options, setup, session, *record.snapshot, pool, record.film_hash);
    record.seconds.write = seconds_since(write_start);
    record.seconds.total += record.seconds.write;
    if (!options.report.empty()) {
        if (Status status = write_text(options.report, run_record_json(record)); !status)
            return report_error(status.error());
    }
    if (!written) return report_error(written.error());
    warn_of_trust(options, record.snapshot->error);
    const NonFiniteCount& bad = record.snapshot->nonfinite;
    if (bad.total() > 0) {
        log_warning(std::to_string(bad.total()) +
                    " samples were not usable and count as zero, or as 2^41 where they are too "
                    "bright; replay the first with --pixel " +
                    std::to_string(bad.first_x) + "," + std::to_string(bad.first_y) + " --sample " +
                    std::to_string(bad.first_sample));
        if (options.strict) {
            log_error("--strict: not every sample was usable");
            return kExitFailed;
        }
    }
    return record.interrupted ? kExitInterrupted : kExitDone;
}

}  // namespace

// Effects that are forced off although the scene has them.
void warn_of_bias(const std::vector<BiasEntry>& bias) {
    for (const BiasEntry& entry : bias) {
        if (!entry.name.starts_with("effects ")) continue;
        char size[120];
        if (entry.floor.significant) {
            std::snprintf(size, sizeof(size),
                          "is biased: it cannot come nearer than %.3g %% to the true picture "
                          "(brightness %+.3g %%)",
                          entry.floor.relrmse_percent, entry.floor.brightness_percent);
        } else {
            std::snprintf(size, sizeof(size), "may be biased, by at most %.3g %%",
                          entry.floor.hi95);
        }
        log_warning("--" + entry.name + ": the picture " + size);
    }
}

int run_headless(const Options& given, Clock::time_point process_start) {
    leave_on_interrupt();
    if (Status status = check_outputs(given); !status) return report_error(status.error());
    Options options = given;
    Result<std::optional<FilmFile>> resumed = load_resume(options);
    if (!resumed) return report_error(resumed.error());
    const auto pool = std::make_shared<WorkerPool>(options.threads);
    Result<SceneSetup> setup = set_up_scene(options, *pool);
    if (!setup) return report_error(setup.error());
    if (!options.report.empty() || !options.film.empty() || !options.checkpoint.empty() || *resumed)
        hash_assets(*setup);
    setup->file.reset();
    if (*resumed) {
        if (Status status = check_resume(options, **resumed, *setup); !status)
            return report_error(status.error());
    }

    RunRecord record;
    if (!options.report.empty() || setup->settings.forced_off != EffectSet{}) {
        record.bias = measure_bias(*setup, static_cast<double>(options.display.exposure_ev), *pool);
        warn_of_bias(record.bias);
    }
    if (writes_nothing(options))
        log_warning("nothing will be written; name a file with --output, --report or --film");
    RenderSession session(policy_of(options, process_start), pool);
    note_interrupts();
    record.interrupted = render(session, options, *setup, std::move(*resumed));
    const std::shared_ptr<const Snapshot> snapshot = session.latest();
    if (!snapshot) {
        log_error(std::string("interrupted within the first pass: there is no picture to write") +
                  (options.checkpoint.empty() ? "" : "; the checkpoint has what it last saved"));
        return kExitInterrupted;
    }
    record.snapshot = snapshot.get();
    record.threads = pool->size();
    record.assets = setup->assets;
    record.target_error_percent = options.target_error_percent;
    record.seconds = {setup->load_seconds, setup->build_seconds, snapshot->render_seconds, 0,
                      seconds_since(process_start)};
    return finish(options, *setup, session, *pool, record);
}

}  // namespace talbot
