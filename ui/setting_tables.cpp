// The tables of ui/parameters.h that concern the scene, the renderer, the display and the session.
#include <algorithm>

#include "ui/parameters.h"

namespace talbot {
namespace {

using Kind = ParameterKind;

constexpr double kLongestAnimation = 1e6;  // seconds

// The labels of a table of the core, as a panel's choices.
template <typename Table>
std::span<const std::string_view> labels_of(const Table& table) {
    static const std::vector<std::string_view> labels = [&] {
        std::vector<std::string_view> all;
        for (const auto& row : table) all.push_back(row.label);
        return all;
    }();
    return labels;
}

template <typename Table>
std::span<const std::string_view> names_of(const Table& table) {
    static const std::vector<std::string_view> names = [&] {
        std::vector<std::string_view> all;
        for (const auto& row : table) all.push_back(row.name);
        return all;
    }();
    return names;
}

constexpr std::string_view kChannelNames[] = {"color", "red",   "green",
                                              "blue",  "alpha", "luminance"};
constexpr std::string_view kChannels[] = {"Colour", "Red", "Green", "Blue", "Alpha", "Luminance"};

template <auto kMember>
ParameterValue read_setting(const RenderSettings& settings) {
    return {static_cast<double>(settings.*kMember)};
}
template <auto kMember>
void write_setting(RenderSettings& settings, const ParameterValue& value) {
    auto& member = settings.*kMember;
    using Member = std::remove_reference_t<decltype(member)>;
    if constexpr (std::is_same_v<Member, bool>) {
        member = value[0] != 0;
    } else if constexpr (std::is_enum_v<Member>) {
        member = static_cast<Member>(static_cast<int>(value[0]));
    } else {
        member = static_cast<Member>(value[0]);
    }
}
template <auto kMember>
Parameter<RenderSettings> setting(const ParameterInfo& info) {
    return {info, read_setting<kMember>, write_setting<kMember>};
}

}  // namespace

std::span<const Parameter<RenderSettings>> render_parameters() {
    static const Parameter<RenderSettings> table[] = {
        setting<&RenderSettings::width>({.name = "width",
                                         .label = "Width",
                                         .unit = "px",
                                         .kind = Kind::integer,
                                         .lower = 1,
                                         .upper = 16384,
                                         .slider_lower = 16,
                                         .slider_upper = 4096}),
        setting<&RenderSettings::height>({.name = "height",
                                          .label = "Height",
                                          .unit = "px",
                                          .kind = Kind::integer,
                                          .lower = 1,
                                          .upper = 16384,
                                          .slider_lower = 16,
                                          .slider_upper = 4096}),
        setting<&RenderSettings::max_depth>(
            {.name = "max_depth",
             .label = "Max depth",
             .kind = Kind::integer,
             .lower = 1,
             .upper = 65536,
             .slider_lower = 1,
             .slider_upper = 1024,
             .logarithmic = true,
             .note = "Scattering events on a path. Biased: light beyond it is missing."}),
        setting<&RenderSettings::sampler>({.name = "sampler",
                                           .label = "Sampler",
                                           .kind = Kind::choice,
                                           .upper = kSamplers.size() - 1,
                                           .choices = labels_of(kSamplers),
                                           .choice_names = names_of(kSamplers)}),
        setting<&RenderSettings::filter>({.name = "filter",
                                          .label = "Pixel filter",
                                          .kind = Kind::choice,
                                          .upper = kFilters.size() - 1,
                                          .choices = labels_of(kFilters),
                                          .choice_names = names_of(kFilters)}),
        setting<&RenderSettings::texture_filter>(
            {.name = "texture_filter",
             .label = "Texture filter",
             .kind = Kind::choice,
             .upper = kTextureFilterings.size() - 1,
             .choices = labels_of(kTextureFilterings),
             .choice_names = names_of(kTextureFilterings),
             .note = "Biased: cones blur textures by what a path covers of them."}),
        setting<&RenderSettings::lights>({.name = "lights",
                                          .label = "Light choice",
                                          .kind = Kind::choice,
                                          .upper = kLightSelections.size() - 1,
                                          .choices = labels_of(kLightSelections),
                                          .choice_names = names_of(kLightSelections),
                                          .note = "Which of many lights a point samples."}),
        setting<&RenderSettings::environment_sampling>(
            {.name = "environment_sampling",
             .label = "Sky sampling",
             .kind = Kind::choice,
             .upper = kEnvironmentSamplings.size() - 1,
             .choices = labels_of(kEnvironmentSamplings),
             .choice_names = names_of(kEnvironmentSamplings),
             .note = "How light sampling draws directions into an environment image."}),
        setting<&RenderSettings::russian_roulette>(
            {.name = "russian_roulette",
             .label = "Russian roulette",
             .kind = Kind::flag,
             .note = "Ends weak paths early, without bias."}),
        setting<&RenderSettings::next_event_estimation>(
            {.name = "next_event_estimation",
             .label = "Light sampling",
             .kind = Kind::flag,
             .note = "Next-event estimation with multiple importance sampling."}),
        setting<&RenderSettings::adaptive>(
            {.name = "adaptive",
             .label = "Adaptive sampling",
             .kind = Kind::flag,
             .note = "More samples where the noise is, by blocks of 8x8 pixels. Counts are decided "
                     "at powers of two; films made so cannot be merged."}),
        setting<&RenderSettings::transparent_background>(
            {.name = "transparent_background",
             .label = "Transparent background",
             .kind = Kind::flag,
             .note = "The background is transparent in saved images."}),
        setting<&RenderSettings::seed>({.name = "seed",
                                        .label = "Seed",
                                        .kind = Kind::integer,
                                        .upper = 4294967295.0,
                                        .slider_upper = 1000}),
        setting<&RenderSettings::tile_size>({.name = "tile_size",
                                             .label = "Tile size",
                                             .unit = "px",
                                             .kind = Kind::integer,
                                             .lower = 8,
                                             .upper = 1024,
                                             .slider_lower = 8,
                                             .slider_upper = 256,
                                             .note = "Changes no pixel."}),
    };
    return table;
}

std::span<const Parameter<ViewerModel>> display_parameters() {
    static const Parameter<ViewerModel> table[] = {
        {{.name = "exposure_ev",
          .label = "Exposure",
          .unit = "EV",
          .lower = -64,
          .upper = 64,
          .slider_lower = -10,
          .slider_upper = 10},
         [](const ViewerModel& m) { return ParameterValue{m.display.exposure_ev}; },
         [](ViewerModel& m, const ParameterValue& v) {
             m.display.exposure_ev = static_cast<float>(v[0]);
         }},
        {{.name = "tone_map",
          .label = "Tone map",
          .kind = Kind::choice,
          .upper = kToneMaps.size() - 1,
          .choices = labels_of(kToneMaps),
          .choice_names = names_of(kToneMaps)},
         [](const ViewerModel& m) {
             return ParameterValue{static_cast<double>(m.display.tone_map)};
         },
         [](ViewerModel& m, const ParameterValue& v) {
             m.display.tone_map = static_cast<ToneMap>(static_cast<int>(v[0]));
         }},
        {{.name = "channel",
          .label = "Channel",
          .kind = Kind::choice,
          .upper = 5,
          .choices = kChannels,
          .choice_names = kChannelNames},
         [](const ViewerModel& m) {
             return ParameterValue{static_cast<double>(m.display.channel)};
         },
         [](ViewerModel& m, const ParameterValue& v) {
             m.display.channel = static_cast<DisplayChannel>(static_cast<int>(v[0]));
         }},
        {{.name = "aov",
          .label = "Show",
          .kind = Kind::choice,
          .upper = kAovs.size() - 1,
          .choices = labels_of(kAovs),
          .choice_names = names_of(kAovs),
          .note = "The image, or what else is known of its pixels."},
         [](const ViewerModel& m) { return ParameterValue{static_cast<double>(m.look.aov)}; },
         [](ViewerModel& m, const ParameterValue& v) {
             m.look.aov = static_cast<Aov>(static_cast<int>(v[0]));
         }},
        {{.name = "false_color",
          .label = "False colour",
          .kind = Kind::flag,
          .note = "Luminance in stops: violet is -8 EV, green 0 EV, red +7 EV."},
         [](const ViewerModel& m) { return ParameterValue{m.look.false_color ? 1.0 : 0.0}; },
         [](ViewerModel& m, const ParameterValue& v) { m.look.false_color = v[0] != 0; }},
        {{.name = "bvh_boxes",
          .label = "Tree boxes",
          .kind = Kind::integer,
          .lower = -1,
          .upper = 255,
          .slider_lower = -1,
          .slider_upper = 16,
          .note = "Boxes of the acceleration structure at this level; -1 draws none."},
         [](const ViewerModel& m) { return ParameterValue{static_cast<double>(m.look.bvh_boxes)}; },
         [](ViewerModel& m, const ParameterValue& v) {
             m.look.bvh_boxes = static_cast<int>(v[0]);
         }},
        {{.name = "fit_window",
          .label = "Fit the window",
          .kind = Kind::flag,
          .note = "The image gets as many pixels as its part of the window."},
         [](const ViewerModel& m) { return ParameterValue{m.look.fit_window ? 1.0 : 0.0}; },
         [](ViewerModel& m, const ParameterValue& v) { m.look.fit_window = v[0] != 0; }},
    };
    return table;
}

std::span<const Parameter<ViewerModel>> scene_parameters() {
    static const Parameter<ViewerModel> table[] = {
        {{.name = "index",
          .label = "Scene",
          .kind = Kind::integer,
          .upper = 65535,
          .slider_upper = 16,
          .note = "Of the file's scenes."},
         [](const ViewerModel& m) { return ParameterValue{static_cast<double>(m.choice.scene)}; },
         [](ViewerModel& m, const ParameterValue& v) {
             const std::size_t count = m.choices().scenes.size();
             if (count > 0) m.choice.scene = std::min(static_cast<std::size_t>(v[0]), count - 1);
         }},
        {{.name = "variant",
          .label = "Variant",
          .kind = Kind::integer,
          .lower = -1,
          .upper = 65535,
          .slider_lower = -1,
          .slider_upper = 16,
          .note = "Of the file's material variants; -1 is the file's own materials."},
         [](const ViewerModel& m) {
             return ParameterValue{m.choice.variant ? static_cast<double>(*m.choice.variant) : -1};
         },
         [](ViewerModel& m, const ParameterValue& v) {
             const std::size_t count = m.choices().variants.size();
             m.choice.variant.reset();
             if (v[0] >= 0 && count > 0)
                 m.choice.variant = std::min(static_cast<std::size_t>(v[0]), count - 1);
         }},
        {{.name = "animation_seconds",
          .label = "Time",
          .unit = "s",
          .lower = -1,
          .upper = kLongestAnimation,
          .slider_lower = -1,
          .slider_upper = 10,
          .note = "Of all animations; below 0 is the rest pose."},
         [](const ViewerModel& m) { return ParameterValue{m.choice.seconds.value_or(-1)}; },
         [](ViewerModel& m, const ParameterValue& v) {
             m.choice.seconds.reset();
             if (v[0] >= 0 && m.choices().last_key() > 0) m.choice.seconds = v[0];
         }},
        {{.name = "shutter_seconds",
          .label = "Shutter",
          .unit = "s",
          .lower = 0,
          .upper = kLongestAnimation,
          .slider_lower = 0,
          .slider_upper = 1,
          .note = "Motion blur: how long of the animations the shutter is open."},
         [](const ViewerModel& m) { return ParameterValue{m.choice.shutter}; },
         [](ViewerModel& m, const ParameterValue& v) {
             m.choice.shutter = m.choices().last_key() > 0 ? v[0] : 0;
         }},
        {{.name = "playing", .label = "Playing", .kind = Kind::flag},
         [](const ViewerModel& m) { return ParameterValue{m.playing ? 1.0 : 0.0}; },
         [](ViewerModel& m, const ParameterValue& v) {
             m.playing = v[0] != 0 && m.choices().last_key() > 0;
         }},
    };
    return table;
}

std::span<const Parameter<ViewerModel>> session_parameters() {
    static const Parameter<ViewerModel> table[] = {
        {{.name = "paused", .label = "Paused", .kind = Kind::flag},
         [](const ViewerModel& m) { return ParameterValue{m.paused ? 1.0 : 0.0}; },
         [](ViewerModel& m, const ParameterValue& v) { m.paused = v[0] != 0; }},
        {{.name = "pass_limit",
          .label = "Sample limit",
          .unit = "spp",
          .kind = Kind::integer,
          .upper = 4294967295.0,
          .slider_upper = 65536,
          .logarithmic = true,
          .note = "Samples per pixel after which rendering rests; 0 is no limit."},
         [](const ViewerModel& m) { return ParameterValue{static_cast<double>(m.pass_limit)}; },
         [](ViewerModel& m, const ParameterValue& v) {
             m.pass_limit = static_cast<uint64_t>(v[0]);
         }},
        {{.name = "target_error_percent",
          .label = "Target error",
          .unit = "%",
          .lower = 0x1p-20,
          .upper = 1000,
          .slider_lower = 0.01,
          .slider_upper = 100,
          .logarithmic = true,
          .note = "Relative RMS error of the image that is aimed at."},
         [](const ViewerModel& m) { return ParameterValue{m.look.target_error_percent}; },
         [](ViewerModel& m, const ParameterValue& v) { m.look.target_error_percent = v[0]; }},
        {{.name = "stop_at_target",
          .label = "Stop when reached",
          .kind = Kind::flag,
          .note = "Rests once the upper bound of the error's 95 % interval is below the target."},
         [](const ViewerModel& m) { return ParameterValue{m.look.stop_at_target ? 1.0 : 0.0}; },
         [](ViewerModel& m, const ParameterValue& v) { m.look.stop_at_target = v[0] != 0; }},
    };
    return table;
}

}  // namespace talbot
