#include "app/interact.h"

#include <cstdio>
#include <nlohmann/json.hpp>

#include "app/interaction_runner.h"
#include "app/output_files.h"
#include "core/scene/effects_off.h"

namespace talbot {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kMillisecondsPerSecond = 1000;

Json milliseconds(const TimeStatistics& times) {
    return {{"count", times.count},
            {"median", times.median * kMillisecondsPerSecond},
            {"p95", times.p95 * kMillisecondsPerSecond},
            {"p99", times.p99 * kMillisecondsPerSecond},
            {"worst", times.worst * kMillisecondsPerSecond}};
}

Json report_of(FrameLoop& loop, const InteractionRunner& runner, const GlContext& context,
               unsigned threads, const std::string& script, const Status& outcome) {
    Json report;
    report["schema"] = "talbot-interaction/1";
    report["script"] = script;
    report["scene"] = loop.model().scene ? loop.model().scene->file() : "";
    report["size"] = {loop.model().settings.width, loop.model().settings.height};
    report["window"] = {context.size().width, context.size().height};
    report["threads"] = threads;
    report["opengl"] = context.description();
    report["frames"] = runner.frames();
    for (std::size_t i = 0; i < kChangeKindNames.size(); ++i) {
        const ChangeKind kind = static_cast<ChangeKind>(i);
        if (loop.recorder().latencies(kind, false).count == 0) continue;
        Json& row = report["latency_ms"][std::string(kChangeKindNames[i])];
        row = milliseconds(loop.recorder().latencies(kind, false));
        row["without_gl"] = milliseconds(loop.recorder().latencies(kind, true));
    }
    report["frame_ms"] = milliseconds(loop.recorder().frame_times());
    report["gl_ms"] = milliseconds(loop.recorder().gl_times());
    report["idle"] = Json::array();
    for (const IdleRecord& idle : runner.idle_records()) {
        report["idle"].push_back(
            {{"seconds", idle.seconds}, {"samples_per_second", idle.samples_per_second}});
    }
    report["kernels"] = Json::array();
    for (const KernelRecord& record : runner.kernel_records()) {
        report["kernels"].push_back({{"frame", record.frame},
                                     {"kernel", record.kernel},
                                     {"effects", effect_names(record.effects)}});
    }
    report["unshown_changes"] = loop.recorder().pending();
    report["ok"] = outcome.ok();
    if (!outcome.ok()) report["error"] = outcome.error().line();
    return report;
}

}  // namespace

Status run_interaction(const InteractionOptions& options) {
    const Result<std::vector<ScriptStep>> steps = load_script(options.script);
    if (!steps) return steps.error();

    const ViewerOptions& viewer = options.viewer;
    PixelSize window = viewer.window;
    if (window.width <= 0 || window.height <= 0) {
        window = viewer.fixed_size ? window_for_image(viewer.settings.width, viewer.settings.height,
                                                      std::max(viewer.ui_scale, 1.0f))
                                   : PixelSize{1600, 900};
    }
    Result<std::unique_ptr<GlContext>> context = make_offscreen_context(window);
    if (!context) return context.error();

    SessionPolicy policy;
    policy.interactive = true;
    policy.threads = viewer.threads;
    InteractionRunner* listener = nullptr;
    RenderSession session(policy);
    Result<std::unique_ptr<FrameLoop>> loop =
        FrameLoop::make(session, **context, initial_model(viewer), frame_loop_options(viewer));
    if (!loop) return loop.error();
    InteractionRunner runner(**context, **loop);
    listener = &runner;
    session.on_snapshot([listener] { listener->wake(); });
    (*loop)->show(viewer.scene);

    Status outcome = Done{};
    for (const ScriptStep& step : *steps) {
        outcome = runner.run(step, options.script.string());
        if (!outcome) break;
    }
    const Json report =
        report_of(**loop, runner, **context, session.threads(), options.script.string(), outcome);
    session.stop();
    const Status written = write_text(
        options.report.empty() ? "-" : options.report.string(),
        report.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n");
    if (!outcome) return outcome;
    return written;
}

}  // namespace talbot
