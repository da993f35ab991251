#include "app/hardcases/command.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <optional>

#include "app/exit_code.h"
#include "app/hardcases/report.h"
#include "app/hardcases/selection.h"
#include "app/hardcases/stress.h"
#include "app/hardcases/twin.h"
#include "app/interrupt.h"
#include "app/isa_option.h"
#include "app/output_files.h"
#include "app/progress_line.h"
#include "app/sub_command.h"
#include "core/base/log.h"
#include "core/io/image_io.h"

namespace talbot {
namespace {

using namespace hardcases;

struct HardcasesOptions {
    Effort effort = Effort::quick;
    std::vector<std::string> only;
    std::string json, html;
    RunSettings settings;
    std::string scene;              // stress mode
    std::string twin, difference;   // twin mode
    std::string scenes;             // folder for the scenes of image cases
    std::vector<std::string> rest;  // render options of stress and twin mode

    const std::string& scene_file() const { return twin.empty() ? scene : twin; }
};

Error usage(const std::string& what) {
    return {ErrorKind::usage, "", "hardcases", what};
}

// Empty when help was printed.
Result<std::optional<HardcasesOptions>> parse(std::span<const std::string> args) {
    HardcasesOptions o;
    bool quick = false;
    bool full = false;
    CLI::App app("Numerically hard cases, each beside a naive control that must fail",
                 "talbot hardcases");
    CLI::Option* quick_flag = app.add_flag("--quick", quick, "less than a minute (default)");
    app.add_flag("--full", full, "up to 20 minutes")->excludes(quick_flag);
    app.add_option("--only", o.only, "ids of rows, e.g. G01,S07")->delimiter(',');
    app.add_option("--json", o.json, "figures; - is the standard output");
    app.add_option("--html", o.html, "page with pictures and curves, in one file");
    app.add_option("--threads", o.settings.threads, "of the workers (all cores)")
        ->check(CLI::Range(0u, 1024u));
    std::string seed = "0";
    app.add_option("--seed", seed, "of the cases' random numbers (0)");
    add_isa_option(app);
    app.add_option(
        "--scene", o.scene,
        "stress mode: this scene moved, scaled, turned and mirrored, with the options of "
        "a render (--size, --frames, --environment, --camera, ...)");
    app.add_option("--twin", o.twin,
                   "twin mode: the samples of this scene in float and in double, with the options "
                   "of a render");
    app.add_option("--difference", o.difference, "twin mode: |float - double| as .exr");
    app.add_option("--save-scenes", o.scenes,
                   "folder for the scenes of image cases, as glTF for other renderers");
    app.allow_extras();
    app.footer("Exit code 1 when a P0 row fails or is blind.");
    const Result<bool> parsed = parse_words(app, args);
    if (!parsed) return parsed.error();
    if (!*parsed) return std::optional<HardcasesOptions>();
    o.rest = app.remaining();
    if (o.scene_file().empty() && !o.rest.empty())
        return usage("'" + o.rest.front() + "' is not known; see talbot hardcases --help");
    if (!o.scene.empty() && !o.twin.empty()) return usage("--scene and --twin: one at a time");
    if (!o.scene_file().empty() && (!o.only.empty() || !o.html.empty() || !o.scenes.empty()))
        return usage("--scene and --twin go with none of --only, --html and --save-scenes");
    if (!o.difference.empty() && o.twin.empty()) return usage("--difference belongs to --twin");
    if (!o.difference.empty() && extension_of(o.difference) != ".exr")
        return usage("--difference writes an .exr; '" + o.difference + "' is none");
    if (o.json == "-" && o.html == "-")
        return usage("--json and --html cannot both be the standard output");
    const Result<uint64_t> number =
        parse_whole(seed, "--seed", std::numeric_limits<uint64_t>::max());
    if (!number) return number.error();
    o.settings.seed = *number;
    if (full) o.effort = Effort::full;
    if (Status status = check_output_files({o.json, o.html, o.difference}, {o.scene_file()});
        !status)
        return status.error();
    return std::optional<HardcasesOptions>(o);
}

Status write_reports(const HardcasesOptions& options, const CaseReport& report) {
    if (Status s = write_text(options.json, cases_json(report)); !s) return s;
    if (!options.scenes.empty()) {
        if (Status s = save_scenes(options.scenes, report); !s) return s;
    }
    if (options.html.empty()) return Done{};
    const Result<std::string> html = cases_html(report);
    return html ? write_text(options.html, *html) : Status(html.error());
}

// The words of stress and twin mode that a render knows, too.
Result<Options> render_options(const HardcasesOptions& options) {
    std::vector<std::string> words{options.scene_file()};
    words.insert(words.end(), options.rest.begin(), options.rest.end());
    Result<std::optional<Options>> parsed = parse_options(words);
    if (!parsed) return parsed.error();
    if (!*parsed) return usage("see talbot hardcases --help");
    Options render = std::move(**parsed);
    if (render.time_seconds || render.target_error_percent || !render.outputs.empty())
        return usage("stress and twin mode render --frames N and write --json only");
    render.threads = options.settings.threads;
    render.render.seed = options.settings.seed;
    return render;
}

Result<int> stress(const HardcasesOptions& options) {
    const Result<Options> render = render_options(options);
    if (!render) return render.error();
    set_log_level(render->log_level);
    std::FILE* table = options.json == "-" ? nullptr : stdout;
    if (table) print_stress_columns(table);
    const Result<StressReport> report =
        run_stress(*render, options.effort, [table](const StressRow& row) {
            if (!table) return;
            print_stress_row(row, table);
            std::fflush(table);
        });
    if (!report) return report.error();
    if (table) print_stress_footer(*report, table);
    if (Status s = write_text(options.json, stress_json(*report)); !s) return s.error();
    if (report->interrupted) return kExitInterrupted;
    return report->kept() ? kExitDone : kExitFailed;
}

Result<int> twins(const HardcasesOptions& options) {
    const Result<Options> render = render_options(options);
    if (!render) return render.error();
    set_log_level(render->log_level);
    const Result<TwinReport> report = run_twin(*render);
    if (!report) return report.error();
    if (options.json != "-") print_twin(*report, stdout);
    if (Status s = write_text(options.json, twin_json(*report)); !s) return s.error();
    if (!options.difference.empty()) {
        if (Status s = save_exr(options.difference, twin_difference(report->comparison)); !s)
            return s.error();
    }
    if (report->interrupted) return kExitInterrupted;
    return broken_twin(report->comparison).empty() ? kExitDone : kExitFailed;
}

Result<int> run(const HardcasesOptions& options) {
    Result<Selection> selection = select_rows(options.only, all_cases(), all_not_simulated());
    if (!selection) return selection.error();
    set_run_settings(options.settings);
    CaseReport report;
    report.header = make_header(options.effort, options.settings);
    report.not_simulated = selection->not_simulated;

    std::FILE* table = options.json == "-" ? nullptr : stdout;
    std::size_t title_width = 0;
    for (const HardCase& row : selection->cases)
        title_width = std::max(title_width, row.title.size());
    if (table) {
        print_header(report.header, table);
        print_columns(title_width, table);
        std::fflush(table);
    }
    ProgressLine progress;
    CaseWatch watch;
    watch.interrupted = is_interrupted;
    watch.waiting = [&](std::size_t i, const HardCase& row, double seconds) {
        progress.show(std::to_string(i + 1) + "/" + std::to_string(selection->cases.size()) + " " +
                      row.id + " " + row.title + ", " + std::to_string(std::lround(seconds)) +
                      " s");
    };
    watch.done = [&](const CaseRow& row) {
        progress.wipe();
        if (!table) return;
        print_row(row, title_width, table);
        std::fflush(table);
    };
    note_interrupts();
    report.outcome = run_cases(selection->cases, options.effort, watch);
    progress.wipe();
    if (table) print_footer(report, table);
    const Status written = write_reports(options, report);
    if (report.outcome.interrupted) {
        // The case at hand runs on: no destructor may pull anything from under it.
        if (!written) log_error(written.error().line());
        std::fflush(nullptr);
        std::_Exit(kExitInterrupted);
    }
    if (!written) return written.error();
    return total(report.outcome.rows).kept ? kExitDone : kExitFailed;
}

}  // namespace

int run_hardcases(std::span<const std::string> args) {
    const Result<std::optional<HardcasesOptions>> options = parse(args);
    if (options && !*options) return kExitDone;
    const Result<int> code = !options                     ? Result<int>(options.error())
                             : !(*options)->twin.empty()  ? twins(**options)
                             : !(*options)->scene.empty() ? stress(**options)
                                                          : run(**options);
    if (code) return *code;
    log_error(code.error().line());
    return exit_code(code.error());
}

}  // namespace talbot
