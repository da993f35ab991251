#include "app/effects.h"

#include <cstdio>
#include <nlohmann/json.hpp>

#include "app/exit_code.h"
#include "app/interrupt.h"
#include "app/progress_line.h"
#include "app/scene_setup.h"
#include "core/integrate/tiers.h"
#include "core/scene/effects_off.h"
#include "core/session/effect_ledger.h"

namespace talbot {
namespace {

using nlohmann::ordered_json;

ordered_json price_json(const EffectPrice& p) {
    return {{"time_percent", p.time_percent},
            {"time_spread", p.time_spread},
            {"error_percent", p.error_percent},
            {"change_percent", p.change.relrmse_percent},
            {"change_hi95", p.change.hi95},
            {"change_significant", p.change.significant},
            {"brightness_percent", p.change.brightness_percent}};
}

ordered_json ledger_json(const SceneSetup& setup, const PreparedView& view,
                         const std::vector<EffectPrice>& prices) {
    ordered_json list = ordered_json::array();
    for (const EffectInfo& info : kEffects) {
        ordered_json row;
        row["effect"] = info.name;
        row["detected"] = view.effects.active.has(info.effect);
        row["state"] = effect_state_name(effect_state(setup.settings, info.effect));
        row["witness"] = view.effects.witness[static_cast<std::size_t>(info.effect)];
        row["without"] = without_effect_text(info.effect);
        row["price"] = nullptr;
        for (const EffectPrice& p : prices) {
            if (p.effect == info.effect) row["price"] = price_json(p);
        }
        list.push_back(row);
    }
    return {{"schema", "talbot-effects/1"},
            {"scene", {{"file", setup.scene->file()}, {"sha256", setup.scene->sha256()}}},
            {"kernel", kTiers[view.tier].name},
            {"effects", list}};
}

void print_text(const SceneSetup& setup, const PreparedView& view,
                const std::vector<EffectPrice>& prices) {
    std::printf("%-27s %-5s %-16s %-8s %-18s %s\n", "effect", "state", "time", "error",
                "picture without it", "asked for by");
    std::string unused;
    for (const EffectInfo& info : kEffects) {
        const EffectPrice* price = nullptr;
        for (const EffectPrice& p : prices) {
            if (p.effect == info.effect) price = &p;
        }
        if (!price) {
            unused += (unused.empty() ? "" : ", ") + std::string(info.name);
            continue;
        }
        char time[40], error[24], change[40];
        std::snprintf(time, sizeof(time), "%+.1f +- %.1f %%", price->time_percent,
                      price->time_spread);
        std::snprintf(error, sizeof(error), "%+.0f %%", price->error_percent);
        if (price->change.significant) {
            std::snprintf(change, sizeof(change), "%.2g %%", price->change.relrmse_percent);
        } else {
            std::snprintf(change, sizeof(change), "below %.2g %%", price->change.hi95);
        }
        const std::string& witness = view.effects.witness[static_cast<std::size_t>(info.effect)];
        std::printf(
            "%-27s %-5s %-16s %-8s %-18s %s\n", std::string(info.name).c_str(),
            std::string(effect_state_name(effect_state(setup.settings, info.effect))).c_str(), time,
            error, change, witness.empty() ? "nobody" : witness.c_str());
    }
    std::printf("kernel %s; not used: %s\n", std::string(kTiers[view.tier].name).c_str(),
                unused.c_str());
}

}  // namespace

int run_effects(const Options& options) {
    leave_on_interrupt();
    WorkerPool pool(options.threads);
    const Result<SceneSetup> setup = set_up_scene(options, pool);
    if (!setup) {
        log_error(setup.error().line());
        return exit_code(setup.error());
    }
    enter_worker_float_mode();
    const PreparedView view = prepare_view(setup->scene, setup->camera, setup->settings, pool);
    PricePolicy policy;
    if (options.frames) policy.samples = std::max<uint64_t>(2, *options.frames);
    ProgressLine progress;
    const std::vector<EffectPrice> prices =
        *price_effects(setup->scene, setup->camera, setup->settings, policy, {}, [&](float done) {
            progress.show("pricing effects, " + std::to_string(static_cast<int>(100 * done)) +
                          " %");
        });
    progress.wipe();
    if (options.json) {
        std::printf("%s\n", ledger_json(*setup, view, prices)
                                .dump(2, ' ', false, ordered_json::error_handler_t::replace)
                                .c_str());
    } else {
        print_text(*setup, view, prices);
    }
    return kExitDone;
}

}  // namespace talbot
