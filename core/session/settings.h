// What a render is made with. RenderSettings restart the image when they change; DisplaySettings
// (film/tone_map.h) never do.
#pragma once

#include <cstdint>

#include "core/integrate/render_scene.h"
#include "core/scene/effects.h"

namespace talbot {

struct RenderSettings {
    uint32_t width = 960;
    uint32_t height = 540;
    uint32_t max_depth = 64;  // scattering events on a path; BIAS: light beyond it is missing
    SamplerKind sampler = SamplerKind::sobol;
    FilterKind filter = FilterKind::box;
    TextureFiltering texture_filter = TextureFiltering::none;  // BIAS: cones blur
    LightSelection lights = LightSelection::tree;
    EnvironmentSampling environment_sampling = EnvironmentSampling::compensated;
    bool russian_roulette = true;
    bool next_event_estimation = true;
    bool transparent_background = false;
    bool adaptive = false;  // more samples where the noise is; not with a first_sample
    uint64_t seed = 0;
    uint64_t first_sample = 0;  // sample indices start here
    EffectSet forced_on{};      // added to what the scene asks for: costs time, changes nothing
    EffectSet forced_off{};     // taken away from the scene; BIAS where it uses them
    uint32_t tile_size = 32;    // pixels; changes no pixel

    bool operator==(const RenderSettings&) const = default;
};

// What a light table needs of it.
inline LightSampling light_sampling(const RenderSettings& settings) {
    return {settings.lights, settings.environment_sampling};
}

// What the kernels need of it.
inline PathSettings path_settings(const RenderSettings& settings) {
    PathSettings path;
    path.max_depth = settings.max_depth;
    path.sampler = settings.sampler;
    path.filter = settings.filter;
    path.russian_roulette = settings.russian_roulette;
    path.next_event_estimation = settings.next_event_estimation;
    path.transparent_background = settings.transparent_background;
    path.seed = settings.seed;
    return path;
}

}  // namespace talbot
