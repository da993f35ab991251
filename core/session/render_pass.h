// One pass over a film by all workers, tile by tile.
#pragma once

#include <functional>
#include <stop_token>

#include "core/base/worker_pool.h"
#include "core/film/film.h"
#include "core/integrate/kernel.h"
#include "core/session/settings.h"
#include "core/session/view_moments.h"

namespace talbot {

struct RenderPass {
    const RenderScene& scene;
    const Camera& camera;
    const RenderSettings& settings;
    std::size_t tier = 0;
    uint64_t target_samples = 0;  // every pixel is brought up to this count
};

// Adds to `counts`; returns whether every tile was finished. `out_of_time`, where given, is asked
// before each tile and ends the pass.
bool render_pass(const RenderPass& pass, Film& film, WorkerPool& pool, std::stop_source& stop,
                 const std::function<bool()>& out_of_time, TileCounts& counts);

// The same of a view that may move: then sample by sample, from the film's least count on.
bool render_pass(ViewMoments& view, const RenderSettings& settings, uint64_t target_samples,
                 Film& film, WorkerPool& pool, std::stop_source& stop,
                 const std::function<bool()>& out_of_time, TileCounts& counts);

}  // namespace talbot
