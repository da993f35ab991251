// The kernels behind one signature: a tile of one pass, by effect tier.
#pragma once

#include <stop_token>

#include "core/film/film.h"
#include "core/integrate/render_scene.h"
#include "core/integrate/tiers.h"

namespace talbot {

// One pass over one tile: every pixel with fewer than `target_samples` gets one more sample, with
// index first_sample + its count.
struct TileJob {
    const RenderScene* scene = nullptr;
    const CameraRays* camera = nullptr;
    const PathSettings* settings = nullptr;
    Film* film = nullptr;
    uint64_t first_sample = 0;
    uint64_t target_samples = 0;
    uint32_t x0 = 0, y0 = 0, x1 = 0, y1 = 0;
};

struct TileCounts {
    uint64_t samples = 0;
    uint64_t rays = 0;
    NonFiniteCount nonfinite;
    SampleLog log;
};

// Stops between two samples when asked to.
using TileKernel = void (*)(const TileJob& job, const std::stop_token& stop, TileCounts& counts);
TileKernel tile_kernel(std::size_t tier);

}  // namespace talbot
