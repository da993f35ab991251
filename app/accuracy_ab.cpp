// `talbot accuracy ab`: two configurations of one view against each other for equal time.
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "app/accuracy.h"
#include "app/exit_code.h"
#include "app/interrupt.h"
#include "app/json_figures.h"
#include "app/options.h"
#include "app/output_files.h"
#include "app/scene_setup.h"
#include "app/sub_command.h"
#include "core/base/log.h"
#include "core/io/image_io.h"
#include "core/session/ab_comparison.h"

namespace talbot {
namespace {

using nlohmann::ordered_json;

struct AbOptions {
    std::string a, b, json;
    double budget_seconds = 30;
    bool until_decided = false;
    std::vector<std::string> rest;  // SCENE and the options that both sides share
};

// Empty when help was printed.
Result<std::optional<AbOptions>> parse_ab(std::span<const std::string> args) {
    AbOptions o;
    CLI::App app("Two configurations of one view for equal time: which gives less error",
                 "talbot accuracy ab");
    app.allow_extras();
    app.add_option("--a", o.a, "settings of A, e.g. \"--max-depth 8\"; default those given");
    app.add_option("--b", o.b, "settings of B");
    app.add_option("--budget", o.budget_seconds, "seconds of rendering, both together (30)");
    app.add_flag("--until-decided", o.until_decided, "end as soon as one is better");
    app.add_option("--json", o.json, "figures; - is the standard output");
    app.footer(
        "SCENE and the options of a render (--size, --camera, --sampler, ...) hold for both.");
    const Result<bool> parsed = parse_words(app, args);
    if (!parsed) return parsed.error();
    if (!*parsed) return std::optional<AbOptions>();
    o.rest = app.remaining();
    if (!(o.budget_seconds > 0) || o.budget_seconds > 1e6)
        return usage_error("--budget", "must lie between 0 and 1000000 seconds");
    return std::optional<AbOptions>(o);
}

std::vector<std::string> words_of(const std::string& text) {
    std::vector<std::string> words(1);
    for (const char c : text) {
        if (c == ' ')
            words.emplace_back();
        else
            words.back() += c;
    }
    std::erase(words, "");
    return words;
}

Result<std::optional<Options>> parse_side(const std::vector<std::string>& shared,
                                          const std::string& own) {
    std::vector<std::string> words = shared;
    for (std::string& word : words_of(own)) words.push_back(std::move(word));
    return parse_options(words);
}

// A view is compared with itself: what differs must be settings.
Status check_same_view(const Options& base, const Options& side, const std::string& option) {
    const auto place = [](const Options& o) {
        std::string words = o.scene_file + '\n' + o.camera + '\n' + o.scene_name + '\n' +
                            o.variant + '\n' + o.environment;
        for (const double x :
             {static_cast<double>(o.environment_rotation), o.animation_time.value_or(-1),
              o.shutter_seconds, o.light_reading.sun_degrees.value_or(-1),
              static_cast<double>(o.light_reading.units), o.orbit ? o.orbit->radius : 0.0,
              static_cast<double>(o.size ? o.size->width : 0),
              static_cast<double>(o.size ? o.size->height : 0)})
            words += '\n' + std::to_string(x);
        return words;
    };
    if (place(base) != place(side) || side.headless())
        return usage_error(option,
                           "takes settings of a render only (--max-depth, --sampler, --no-nee, "
                           "--effects, ...); scene, view and size hold for both sides");
    if (side.render.adaptive)
        return usage_error(option,
                           "--adaptive begins at 32 samples and these renders are shorter; use "
                           "talbot accuracy --sweep adaptive=on");
    return Done{};
}

ordered_json side_json(const AbSide& side, const std::string& flags) {
    const auto known = [&](double x) { return json_number_if(side.relrmse_percent > 0, x); };
    return {{"flags", flags},           {"kernel", side.kernel},
            {"samples", side.samples},  {"seconds", side.seconds},
            {"rays", side.rays},        {"relrmse_percent", known(side.relrmse_percent)},
            {"lo95", known(side.lo95)}, {"hi95", known(side.hi95)}};
}

ordered_json verdict_json(const EfficiencyVerdict& v) {
    static constexpr const char* kWinners[] = {"none", "a", "b"};
    if (!v.valid) return {{"winner", "none"}, {"text", v.text}};
    return {{"winner", kWinners[static_cast<int>(v.winner)]},
            {"b_over_a", v.ratio},
            {"lo95", v.lo95},
            {"hi95", v.hi95},
            {"error_ratio", v.error_ratio},
            {"time_ratio", v.time_ratio},
            {"samples", v.samples},
            {"renders", v.renders},
            {"different", v.different},
            {"brightness_percent", v.brightness_percent},
            {"text", v.text}};
}

void print_side(const char* name, const AbSide& side, const std::string& flags) {
    char error[80] = "not known from so few samples";
    if (side.relrmse_percent > 0)
        std::snprintf(error, sizeof(error), "%.3g %% (%.3g to %.3g)", side.relrmse_percent,
                      side.lo95, side.hi95);
    std::printf("%s  %-36s %7llu samples  %8.2f s  error %s\n", name,
                flags.empty() ? "as given" : flags.c_str(),
                static_cast<unsigned long long>(side.samples), side.seconds, error);
}

Status write(const AbOptions& o, const Options& base, const AbSnapshot& s) {
    if (o.json != "-") {
        print_side("A", s.a, o.a);
        print_side("B", s.b, o.b);
        std::printf("%s\n", s.verdict.text.empty() ? "no difference yet: too few samples to compare"
                                                   : s.verdict.text.c_str());
        if (is_interrupted()) std::printf("interrupted before the budget was over\n");
    }
    if (o.json.empty()) return Done{};
    const ordered_json j{{"schema", "talbot-ab/1"},
                         {"scene", scene_path(base).string()},
                         {"size", {s.a.image->width, s.a.image->height}},
                         {"seconds", s.seconds},
                         {"interrupted", is_interrupted()},
                         {"a", side_json(s.a, o.a)},
                         {"b", side_json(s.b, o.b)},
                         {"verdict", verdict_json(s.verdict)}};
    return write_text(o.json, j.dump(2, ' ', false, ordered_json::error_handler_t::replace) + "\n");
}

Status compare(const AbOptions& o, const Options& base, const Options& a, const Options& b) {
    if (Status s = check_same_view(base, a, "--a"); !s) return s;
    if (Status s = check_same_view(base, b, "--b"); !s) return s;
    if (Status s = check_output_files({o.json}, {scene_path(base).string(), base.environment}); !s)
        return s;
    leave_on_interrupt();
    Result<SceneSetup> setup = [&] {
        WorkerPool pool(base.threads);
        return set_up_scene(base, pool);
    }();
    if (!setup) return setup.error();
    AbConfig configs[2];
    for (int i = 0; i < 2; ++i) {
        configs[i].settings = (i == 0 ? a : b).render;
        configs[i].settings.width = setup->settings.width;
        configs[i].settings.height = setup->settings.height;
    }
    AbPolicy policy;
    policy.threads = base.threads;
    policy.limit_seconds = o.budget_seconds;
    policy.stop_when_decided = o.until_decided;
    policy.exposure_ev = base.display.exposure_ev;
    note_interrupts();
    AbComparison comparison;
    comparison.start(setup->scene, setup->camera, configs[0], configs[1], policy);
    while (!comparison.wait(0.1)) {
        if (is_interrupted()) comparison.stop();
    }
    const std::shared_ptr<const AbSnapshot> last = comparison.latest();
    if (!last && is_interrupted())
        return Error{ErrorKind::cancelled, "", "", "interrupted before each side had a sample"};
    if (!last)
        return Error{ErrorKind::failed, base.scene_file, "",
                     "the budget was over before each side had one sample a pixel; give more "
                     "--budget or a smaller --size"};
    return write(o, base, *last);
}

}  // namespace

int run_ab(std::span<const std::string> args) {
    const auto fail = [](const Error& error) {
        log_error(error.line());
        return exit_code(error);
    };
    const Result<std::optional<AbOptions>> options = parse_ab(args);
    if (!options) return fail(options.error());
    if (!*options) return kExitDone;
    const AbOptions& o = **options;
    std::optional<Options> sides[3];
    for (int i = 0; i < 3; ++i) {
        const Result<std::optional<Options>> side = parse_side(o.rest, i == 0   ? std::string()
                                                                       : i == 1 ? o.a
                                                                                : o.b);
        if (!side) return fail(side.error());
        if (!*side) return kExitDone;
        sides[i] = **side;
        sides[i]->command_files = {o.json};
    }
    set_log_level(sides[0]->log_level);
    const Status status = compare(o, *sides[0], *sides[1], *sides[2]);
    if (!status) return fail(status.error());
    return is_interrupted() ? kExitInterrupted : kExitDone;
}

}  // namespace talbot
