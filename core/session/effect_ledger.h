// What each effect costs and brings in a view: its share of the time and of the error, and how far
// the picture changes without it. Both sides use the same random numbers and run in turn.
#pragma once

#include <functional>
#include <optional>
#include <stop_token>
#include <vector>

#include "core/accuracy/bias_floor.h"
#include "core/session/prepared_view.h"

namespace talbot {

enum class EffectState : uint8_t { automatic, on, off };

EffectState effect_state(const RenderSettings& settings, Effect effect);
void set_effect_state(RenderSettings& settings, Effect effect, EffectState state);
std::string_view effect_state_name(EffectState state);  // "auto", "on", "off"

struct EffectPrice {
    Effect effect = Effect::count;
    double time_percent = 0;   // of the time with it; below 0 where paths get shorter by it
    double time_spread = 0;    // half the distance between two independent figures of it
    double error_percent = 0;  // of the squared error with it
    BiasFloor change;          // of the picture when it is off
};

struct PricePolicy {
    uint32_t pixels = 4096;  // of the small image of the same view
    uint64_t samples = 32;   // a pixel, for error and change
    uint64_t slice_samples = 4;
    // Each slice counts with its least time of at least `rounds` rounds; they end when every share
    // of the time is told to `resolution` of itself, or to that part of one per cent for small
    // ones.
    int rounds = 10;
    int most_rounds = 60;
    double resolution = 0.03;
};

// Prices of the effects that the scene has or the settings force. Runs on the calling thread and
// counts its processor time, so other work beside it does not count. Empty when stopped. progress
// gets 0..1.
std::optional<std::vector<EffectPrice>> price_effects(
    const std::shared_ptr<const Scene>& scene, const Camera& camera, const RenderSettings& settings,
    const PricePolicy& policy, std::stop_token stop = {},
    const std::function<void(float)>& progress = {});

}  // namespace talbot
