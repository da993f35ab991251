// No effect is a name without code: in a scene made for it, each is found, with its witness, and
// forced off it changes the picture by more than the interval of that change. Forced on, it changes
// no byte.
#include <gtest/gtest.h>

#include "core/accuracy/bias_floor.h"
#include "core/scene/effects_off.h"
#include "core/session/effect_ledger.h"
#include "tests/effect_scenes.h"

namespace talbot {
namespace {

WorkerPool& workers() {
    static WorkerPool pool;
    return pool;
}

RenderSettings small() {
    RenderSettings settings;
    settings.width = 64;
    settings.height = 48;
    settings.max_depth = 16;
    return settings;
}

class EffectOff : public testing::TestWithParam<EffectInfo> {};

TEST_P(EffectOff, ChangesThePictureMadeForIt) {
    const Effect effect = GetParam().effect;
    const EffectScene made = make_effect_scene(effect, workers());
    RenderSettings settings = small();
    const PreparedView with = prepare_view(made.scene, made.camera, settings, workers());
    ASSERT_TRUE(with.effects.active.has(effect));
    EXPECT_FALSE(with.effects.witness[static_cast<std::size_t>(effect)].empty());

    settings.forced_off.add(effect);
    const PreparedView without = prepare_view(made.scene, made.camera, settings, workers(), &with);
    EXPECT_TRUE(without.effects.active.has(effect)) << "it is still detected, though off";
    EXPECT_FALSE(analyse_effects(*without.reduced, without.camera).active.has(effect));

    constexpr uint64_t kPasses = 16;
    const auto film = [&](const PreparedView& view, uint64_t passes) {
        return render_view(view, settings, passes, workers());
    };
    const BiasFloor floor = measure_floor(film(without, kPasses / 2), film(without, kPasses),
                                          film(with, kPasses / 2), film(with, kPasses));
    EXPECT_TRUE(floor.significant) << "z " << floor.z << ", p " << floor.block_p_value;
    EXPECT_GT(floor.relrmse_percent, 0.1);
}

TEST_P(EffectOff, ForcedOnChangesNoByte) {
    const EffectScene made = make_effect_scene(GetParam().effect, workers());
    RenderSettings settings = small();
    const std::string hash = render_view(prepare_view(made.scene, made.camera, settings, workers()),
                                         settings, 4, workers())
                                 .hash();
    settings.forced_on = EffectSet::all();
    const PreparedView all = prepare_view(made.scene, made.camera, settings, workers());
    EXPECT_EQ(all.tier, kFullKernel);
    EXPECT_EQ(render_view(all, settings, 4, workers()).hash(), hash);
    // The control: another sample's film differs.
    settings.seed = 1;
    EXPECT_NE(render_view(all, settings, 4, workers()).hash(), hash);
}

INSTANTIATE_TEST_SUITE_P(Effects, EffectOff, testing::ValuesIn(kEffects),
                         [](const auto& tested) { return std::string(tested.param.name); });

TEST(EffectList, ReadsFromLeftToRight) {
    EffectSet on, off;
    EXPECT_FALSE(parse_effect_list("auto", on, off));
    EXPECT_EQ(on, EffectSet{});
    EXPECT_FALSE(parse_effect_list("all,-clearcoat", on, off));
    EXPECT_TRUE(on.has(Effect::sheen));
    EXPECT_FALSE(on.has(Effect::clearcoat));
    EXPECT_EQ(off, (EffectSet{} | Effect::clearcoat));
    EXPECT_FALSE(parse_effect_list("auto,-sheen,sheen,-glossy", on, off));
    EXPECT_EQ(on, (EffectSet{} | Effect::sheen));
    EXPECT_EQ(off, (EffectSet{} | Effect::glossy));
    EXPECT_EQ(parse_effect_list("auto,-gloss", on, off), "-gloss");
    EXPECT_EQ(effect_names(Effect::sheen | Effect::glossy), "glossy,sheen");
}

TEST(EffectState, GoesThroughTheSettings) {
    RenderSettings settings;
    EXPECT_EQ(effect_state(settings, Effect::sheen), EffectState::automatic);
    set_effect_state(settings, Effect::sheen, EffectState::off);
    EXPECT_EQ(effect_state(settings, Effect::sheen), EffectState::off);
    set_effect_state(settings, Effect::sheen, EffectState::on);
    EXPECT_EQ(effect_state(settings, Effect::sheen), EffectState::on);
    EXPECT_EQ(settings.forced_off, EffectSet{});
}

// A price has the sign of what it measures: a lamp that is off takes its light along, a mirror's
// coat its time.
TEST(EffectLedger, PricesWhatIsThere) {
    const EffectScene made = make_effect_scene(Effect::clearcoat, workers());
    RenderSettings settings = small();
    PricePolicy policy;
    policy.rounds = policy.most_rounds = 4;
    const auto prices = price_effects(made.scene, made.camera, settings, policy);
    ASSERT_TRUE(prices.has_value());
    EffectSet priced;
    for (const EffectPrice& price : *prices) {
        priced.add(price.effect);
        if (price.effect == Effect::clearcoat) {
            EXPECT_TRUE(price.change.significant);
            EXPECT_LT(price.change.brightness_percent, 0);
            EXPECT_GT(price.time_percent, 0);
        }
        if (price.effect == Effect::punctual_lights) {
            EXPECT_LT(price.change.brightness_percent, -5);
        }
    }
    EXPECT_EQ(priced, analyse_effects(*made.scene, made.camera).active);
}

TEST(EffectLedger, StopsWhenAsked) {
    const EffectScene made = make_effect_scene(Effect::sheen, workers());
    std::stop_source stop;
    stop.request_stop();
    EXPECT_FALSE(price_effects(made.scene, made.camera, small(), {}, stop.get_token()).has_value());
}

}  // namespace
}  // namespace talbot
