// The ledger of effects: who asks for each, a switch auto / on / off, and prices on request.
#include <imgui.h>

#include <cstdio>

#include "ui/effect_prices.h"
#include "ui/panels.h"
#include "ui/parameter_widgets.h"

namespace talbot {
namespace {

const EffectPrice* price_of(const EffectPriceJob::Figures* figures, Effect effect) {
    if (!figures) return nullptr;
    for (const EffectPrice& price : figures->prices) {
        if (price.effect == effect) return &price;
    }
    return nullptr;
}

void explain(const EffectInfo& info, const EffectReport& effects, EffectState state) {
    const std::string& witness = effects.witness[static_cast<std::size_t>(info.effect)];
    if (effects.active.has(info.effect)) {
        ImGui::SetTooltip(state == EffectState::off
                              ? "Asked for by %s, but off: the picture is biased"
                              : "Asked for by %s",
                          witness.empty() ? "the scene" : witness.c_str());
    } else {
        ImGui::SetTooltip("Changes no pixel here. Forced on it costs time and changes nothing.");
    }
}

bool edit_state(RenderSettings& settings, Effect effect, EffectState state) {
    const char* const names[] = {"auto", "on", "off"};
    int index = static_cast<int>(state);
    ImGui::SetNextItemWidth(-1);
    if (!ImGui::Combo("##state", &index, names, 3)) return false;
    set_effect_state(settings, effect, static_cast<EffectState>(index));
    return true;
}

void show_price(const EffectPrice* price) {
    ImGui::TableNextColumn();
    if (price) ImGui::Text("%.1f %%", price->time_percent);
    if (price && ImGui::IsItemHovered())
        ImGui::SetTooltip("Of the time, +- %.1f; %.0f %% of the squared error", price->time_spread,
                          price->error_percent);
    ImGui::TableNextColumn();
    if (!price) return;
    if (price->change.significant) {
        ImGui::Text("%.2g %%", price->change.relrmse_percent);
    } else {
        ImGui::TextDisabled("< %.1g %%", price->change.hi95);
    }
    if (ImGui::IsItemHovered())
        ImGui::SetTooltip("How far the picture moves without it; brightness %+.2g %%",
                          price->change.brightness_percent);
}

void draw_measurement(ViewerModel& model, const Snapshot& snapshot) {
    const bool running = model.effect_prices && model.effect_prices->running();
    if (running) {
        ImGui::ProgressBar(model.effect_prices->fraction(), ImVec2(-1, 0), "measuring prices");
        return;
    }
    if (ImGui::Button("Measure prices", ImVec2(-1, 0))) {
        if (!model.effect_prices) model.effect_prices = std::make_shared<EffectPriceJob>();
        model.effect_prices->start(snapshot);
    }
    if (ImGui::IsItemHovered())
        ImGui::SetTooltip(
            "Time, error and change of picture of each effect, by a small image of\n"
            "this view; runs beside the render, which goes a little slower.");
}

// In use are also effects that are forced, one way or the other.
bool is_listed(const Snapshot& snapshot, Effect effect, EffectState state) {
    return snapshot.effects.active.has(effect) || state != EffectState::automatic;
}

// A row for each effect that is in use, or for each of the others; true when a switch moved.
bool draw_rows(ViewerModel& model, const Snapshot& snapshot, const EffectPriceJob::Figures* figures,
               bool in_use) {
    if (!ImGui::BeginTable(in_use ? "in use" : "not in use", figures && in_use ? 4 : 2,
                           ImGuiTableFlags_SizingStretchProp))
        return false;
    bool changed = false;
    const float em = ImGui::GetFontSize();
    ImGui::TableSetupColumn("effect", ImGuiTableColumnFlags_WidthStretch, 2.4f);
    ImGui::TableSetupColumn("state", ImGuiTableColumnFlags_WidthFixed, 4.6f * em);
    if (figures && in_use) {
        const bool stale = figures->generation != snapshot.generation;
        ImGui::TableSetupColumn(stale ? "time (old)" : "time");
        ImGui::TableSetupColumn("change");
        ImGui::TableHeadersRow();
    }
    for (const EffectInfo& info : kEffects) {
        const EffectState state = effect_state(model.settings, info.effect);
        if (is_listed(snapshot, info.effect, state) != in_use) continue;
        ImGui::PushID(static_cast<int>(info.effect));
        ImGui::TableNextColumn();
        ImGui::AlignTextToFramePadding();
        if (in_use) {
            ImGui::TextUnformatted(info.label.data());
        } else {
            ImGui::TextDisabled("%s", info.label.data());
        }
        if (ImGui::IsItemHovered()) explain(info, snapshot.effects, state);
        ImGui::TableNextColumn();
        changed |= edit_state(model.settings, info.effect, state);
        if (figures && in_use) show_price(price_of(figures, info.effect));
        ImGui::PopID();
    }
    ImGui::EndTable();
    return changed;
}

}  // namespace

bool draw_effects_panel(ViewerModel& model, const Snapshot* snapshot) {
    if (!snapshot) return false;
    if (!snapshot->kernel.empty()) text_row("Kernel", "%s", snapshot->kernel.c_str());
    draw_measurement(model, *snapshot);
    const std::shared_ptr<const EffectPriceJob::Figures> figures =
        model.effect_prices ? model.effect_prices->figures() : nullptr;
    bool changed = draw_rows(model, *snapshot, figures.get(), true);
    if (ImGui::TreeNodeEx("Not in use", ImGuiTreeNodeFlags_SpanAvailWidth)) {
        changed |= draw_rows(model, *snapshot, nullptr, false);
        ImGui::TreePop();
    }
    return changed;
}

}  // namespace talbot
