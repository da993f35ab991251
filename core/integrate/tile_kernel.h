// The loop of a tile kernel; included only by the files that compile one tier each.
#pragma once

#include "core/integrate/kernel.h"
#include "core/integrate/path.h"

namespace talbot {

template <EffectSet kTier>
void render_tile(const TileJob& job, const std::stop_token& stop, TileCounts& counts) {
    NoRecorder recorder;
    for (uint32_t y = job.y0; y < job.y1; ++y) {
        for (uint32_t x = job.x0; x < job.x1; ++x) {
            FilmPixel& pixel = job.film->pixel(x, y);
            while (pixel.samples < job.target_samples) {
                if (stop.stop_requested()) return;
                const uint64_t index = job.first_sample + pixel.samples;
                const PathSample sample = trace_path<kTier>(*job.scene, *job.camera, *job.settings,
                                                            x, y, index, recorder);
                job.film->add(x, y, sample.Li, sample.covered, index, counts.nonfinite, counts.log);
                ++counts.samples;
                counts.rays += sample.rays;
            }
        }
    }
}

// One per tier, each in a file of its own so that they compile side by side.
void render_tile_matte(const TileJob& job, const std::stop_token& stop, TileCounts& counts);
void render_tile_glossy(const TileJob& job, const std::stop_token& stop, TileCounts& counts);
void render_tile_textured(const TileJob& job, const std::stop_token& stop, TileCounts& counts);
void render_tile_transmissive(const TileJob& job, const std::stop_token& stop, TileCounts& counts);
void render_tile_full(const TileJob& job, const std::stop_token& stop, TileCounts& counts);
void render_tile_filtered(const TileJob& job, const std::stop_token& stop, TileCounts& counts);

}  // namespace talbot
