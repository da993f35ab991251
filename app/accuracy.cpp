#include "app/accuracy.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "app/accuracy_report.h"
#include "app/bias_record.h"
#include "app/exit_code.h"
#include "app/interrupt.h"
#include "app/output_files.h"
#include "app/sub_command.h"
#include "core/base/log.h"
#include "core/io/image_io.h"
#include "core/session/bias_ledger.h"

namespace talbot {
namespace {

struct AccuracyOptions {
    std::vector<std::string> sweeps;
    std::optional<double> target_percent;
    double budget_seconds = 60;
    std::string html, json, csv, png;
    bool why = false;
    std::vector<std::string> rest;  // for the render options
};

// Empty when help was printed.
Result<std::optional<AccuracyOptions>> parse_accuracy(std::span<const std::string> args) {
    AccuracyOptions o;
    CLI::App app("What accuracy costs on a scene: error against seconds for each setting",
                 "talbot accuracy");
    app.allow_extras();
    app.add_option(
           "--sweep", o.sweeps,
           "KEY=v1,v2: max-depth, sampler, filter, texture-filter, lights, "
           "environment-sampling, roulette, nee, adaptive, effects, effect.NAME, tile-size; "
           "may be repeated")
        ->allow_extra_args(false);
    app.add_option("--target-error", o.target_percent,
                   "relative error in per cent; default what the settings as given reach");
    app.add_option("--budget", o.budget_seconds, "seconds of rendering for all together (60)");
    app.add_flag("--why", o.why,
                 "what the error is made of: kinds of paths, lights, and what would help");
    app.add_option("--html", o.html, "report in one file");
    app.add_option("--json", o.json, "figures; - is the standard output");
    app.add_option("--csv", o.csv, "curves");
    app.add_option("--png", o.png, "plot");
    app.footer(
        "SCENE and the options of a render (--size, --seed, --camera, --environment, --max-depth, "
        "...) set the base.\nCommands: talbot accuracy certify [SCENE...], talbot accuracy ab "
        "SCENE --a "
        "FLAGS --b FLAGS");
    const Result<bool> parsed = parse_words(app, args);
    if (!parsed) return parsed.error();
    if (!*parsed) return std::optional<AccuracyOptions>();
    o.rest = app.remaining();
    if (o.target_percent && (!(*o.target_percent > 0) || !std::isfinite(*o.target_percent)))
        return usage_error("--target-error", "must be above 0 per cent");
    if (!(o.budget_seconds > 0) || o.budget_seconds > 1e6)
        return usage_error("--budget", "must lie between 0 and 1000000 seconds");
    return std::optional<AccuracyOptions>(o);
}

std::string quoted(const std::string& word) {
    const bool plain = !word.empty() && word.find_first_not_of(
                                            "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
                                            "0123456789_-./,=:+") == std::string::npos;
    if (plain) return word;
    std::string text = "'";
    for (const char c : word) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return text + "'";
}

std::string three_digits(double value) {
    char text[32];
    std::snprintf(text, sizeof(text), "%.3g", value);
    return text;
}

// The words of the base without what `flags` ("--KEY value") say anew.
std::string command_of(const std::vector<std::string>& words, const std::string& flags) {
    const std::string key = flags.substr(0, flags.find(' '));
    std::string text = "talbot";
    for (std::size_t i = 0; i < words.size(); ++i) {
        if (!key.empty() && words[i] == key) {
            ++i;
            continue;
        }
        if (!key.empty() && words[i].starts_with(key + "=")) continue;
        text += " " + quoted(words[i]);
    }
    return text + (flags.empty() ? "" : " " + flags);
}

// What to do, and whether a run bore it out.
void advise(AccuracyReport& report, const std::vector<std::string>& words,
            const AccuracyScene& scene, WorkerPool& pool) {
    const SweepResult* choice = advised(report.outcome);
    const std::string target = three_digits(report.outcome.target_percent) + " %";
    if (choice == nullptr) {
        report.advice = "No configuration is known to reach " + target + ": " +
                        report.outcome.results.front().to_target.why + ".";
        return;
    }
    const TimeToTarget& t = choice->to_target;
    report.advice_command = command_of(words, choice->config.flags) + " --target-error " +
                            three_digits(report.outcome.target_percent) + " --output picture.png";
    const bool is_base = choice->config.key == "base";
    report.advice =
        (is_base && report.outcome.results.size() > 1
             ? "No other configuration reaches " + target + " at less cost beyond doubt than "
             : "The cheapest configuration that reaches " + target + " is ") +
        choice->config.label() + ": " + three_digits(t.seconds) + " s (" + three_digits(t.lo95) +
        " to " + three_digits(t.hi95) + ")" + (t.measured ? "." : ", predicted.");
    // A run stops at a power of two, for which up to twice the time is needed.
    if (4 * t.hi95 > std::max(report.budget_seconds, 4.0)) {
        report.advice += " Not verified: that would take longer than the budget allows.";
        return;
    }
    report.verification =
        verify(scene, *choice, report.outcome.target_percent, 4 * t.hi95 + 1, pool);
    const Verification& v = report.verification;
    if (!v.done) return;
    if (!v.error.valid) {
        report.advice += " NOT borne out with another seed: " + v.error.why + ".";
        return;
    }
    report.advice += !v.met ? " NOT borne out with another seed: "
                     : v.error.trust == Trust::red
                         ? " Met with another seed, but not to be trusted (" + v.error.why + "): "
                         : " Verified with another seed: ";
    report.advice += three_digits(v.error.relrmse_percent) +
                     " % (95 %: " + three_digits(v.error.lo95) + " to " +
                     three_digits(v.error.hi95) + ") after " + three_digits(v.seconds) + " s.";
}

void print_shares(const ErrorShares& shares) {
    std::printf("\n%-36s %-16s %-8s %s\n", "what the error is made of", "error", "light", "help");
    for (const std::vector<ErrorShare>* list : {&shares.kinds, &shares.lights}) {
        for (const ErrorShare& s : *list) {
            char error[32];
            std::snprintf(error, sizeof(error), "%.1f +- %.1f %%", 100 * s.error, 196 * s.error_sd);
            std::printf(
                "%-36s %-16s %5.1f %%  %s\n", s.label.c_str(), error, 100 * s.light,
                s.help.empty() ? "" : (s.help + ": " + three_digits(s.help_factor) + "x").c_str());
        }
        std::printf("\n");
    }
    if (shares.help.empty())
        std::printf("No other setting helps the whole image by a tenth.\n");
    else
        std::printf("For the whole image: %s, %sx.\n", shares.help.c_str(),
                    three_digits(shares.help_factor).c_str());
}

void print_table(const AccuracyReport& report) {
    std::printf("%-26s %-30s %-10s %-9s %-8s %-12s %-6s %s\n", "configuration",
                ("seconds to " + three_digits(report.outcome.target_percent) + " %").c_str(),
                "error", "after", "exponent", "bias floor", "trust", "Pareto");
    for (const SweepResult& r : report.outcome.results) {
        const TimeToTarget& t = r.to_target;
        const std::string time = t.valid ? three_digits(t.seconds) + " (" + three_digits(t.lo95) +
                                               " to " + three_digits(t.hi95) + ")" +
                                               (t.measured ? "" : " pred.")
                                         : "never or unknown";
        const std::string floor = !r.config.may_be_biased ? "none"
                                  : !(r.floor.hi95 > 0)   ? "not seen"
                                  : r.floor.significant
                                      ? three_digits(r.floor.relrmse_percent) + " %"
                                      : "< " + three_digits(r.floor.hi95) + " %";
        std::printf(
            "%-26s %-30s %-10s %-9s %-8s %-12s %-6s %s\n", r.config.label().c_str(), time.c_str(),
            r.curve.empty() ? "-" : (three_digits(r.curve.back().relrmse_percent) + " %").c_str(),
            (three_digits(r.last.seconds) + " s").c_str(), three_digits(r.last.exponent).c_str(),
            floor.c_str(), std::string(trust_name(r.last.trust)).c_str(), r.pareto ? "yes" : "");
        if (!t.valid) std::printf("  %s\n", t.why.c_str());
        if (r.config.may_be_biased)
            std::printf("  %s\n", bias_sentence(r.floor, r.loss_after_seconds).c_str());
    }
    if (report.shares.valid) print_shares(report.shares);
    std::printf("%s\n", report.advice.c_str());
    if (!report.advice_command.empty()) std::printf("%s\n", report.advice_command.c_str());
}

// To files first: who reads the standard output may have gone.
Status write_reports(const AccuracyOptions& options, const AccuracyReport& report) {
    if (!options.png.empty()) {
        if (Status s = save_png(options.png, report_plot(report)); !s) return s;
    }
    std::vector<std::pair<std::string, std::string>> texts;  // file and what goes there
    if (!options.json.empty()) texts.emplace_back(options.json, report_json(report));
    if (!options.csv.empty()) texts.emplace_back(options.csv, report_csv(report));
    if (!options.html.empty()) {
        Result<std::string> html = report_html(report);
        if (!html) return html.error();
        texts.emplace_back(options.html, std::move(*html));
    }
    const auto stream = std::stable_partition(texts.begin(), texts.end(),
                                              [](const auto& text) { return text.first != "-"; });
    for (auto text = texts.begin(); text != stream; ++text) {
        if (Status s = write_text(text->first, text->second); !s) return s;
    }
    if (stream != texts.end()) return write_text(stream->first, stream->second);
    print_table(report);
    return Done{};
}

Status measure(const AccuracyOptions& options, const Options& base) {
    leave_on_interrupt();
    if (Status s = check_png(options.png, "--png"); !s) return s;
    if (Status s =
            check_output_files(base.command_files, {scene_path(base).string(), base.environment});
        !s)
        return s;
    WorkerPool pool(base.threads);
    Result<std::vector<SweepConfig>> configs = sweep_configs(base.render, options.sweeps);
    if (!configs) return configs.error();
    Result<AccuracyScene> scene = load_accuracy_scene(base, pool);
    if (!scene) return scene.error();
    for (SweepConfig& config : *configs) {
        config.settings.width = scene->setup.settings.width;
        config.settings.height = scene->setup.settings.height;
    }
    AccuracyReport report;
    report.scene_file = scene->name;
    report.scene_sha256 = scene->setup.scene->sha256();
    report.budget_seconds = options.budget_seconds;
    report.threads = pool.size();
    report.display = base.display;
    report.outcome = run_sweep(
        *scene, {*configs, options.budget_seconds, options.target_percent.value_or(0)}, pool);
    advise(report, options.rest, *scene, pool);
    if (!biased_switches(base.render).empty())
        report.advice +=
            " The base is biased itself: errors and floors are against its own converged picture.";
    if (options.why) {
        ErrorSharePolicy policy;
        policy.exposure_ev = scene->exposure_ev;
        RenderSettings settings = base.render;
        settings.width = scene->setup.settings.width;
        settings.height = scene->setup.settings.height;
        report.shares =
            measure_error_shares(scene->setup.scene, scene->setup.camera, settings, policy, pool);
    }
    return write_reports(options, report);
}

}  // namespace

int run_accuracy(std::span<const std::string> args) {
    if (!args.empty() && args.front() == "certify") return run_certify(args.subspan(1));
    if (!args.empty() && args.front() == "ab") return run_ab(args.subspan(1));
    const auto fail = [](const Error& error) {
        log_error(error.line());
        return exit_code(error);
    };
    const Result<std::optional<AccuracyOptions>> options = parse_accuracy(args);
    if (!options) return fail(options.error());
    if (!*options) return kExitDone;
    Result<std::optional<Options>> base = parse_options((*options)->rest);
    if (!base) return fail(base.error());
    if (!*base) return kExitDone;
    if ((*base)->acts())
        return fail(usage_error("accuracy",
                                "says itself how long it renders and what it writes; leave out "
                                "--frames, --time, --output and the like"));
    set_log_level((*base)->log_level);
    (*base)->command_files = {(*options)->json, (*options)->csv, (*options)->png, (*options)->html};
    const Status status = measure(**options, **base);
    return status ? kExitDone : fail(status.error());
}

}  // namespace talbot
