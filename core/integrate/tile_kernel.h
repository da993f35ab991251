// The loop of a tile kernel; included only by the files that compile one tier each.
#pragma once

#include <algorithm>
#include <vector>

#include "core/integrate/kernel.h"
#include "core/integrate/path.h"

namespace talbot {

// Pixels along a side of the blocks whose camera rays make a beam.
inline constexpr uint32_t kBeamSide = 8;

// Samples of a few neighbouring pixels, whose camera rays find the scene together.
struct PixelSample {
    uint32_t x, y;
    uint64_t index;
    CameraSample camera;
};

// The next sample of every pixel of a block that wants one.
template <EffectSet kTier>
void begin_samples(const TileJob& job, uint32_t x0, uint32_t y0, std::vector<PixelSample>& out) {
    out.clear();
    for (uint32_t y = y0; y < std::min(y0 + kBeamSide, job.y1); ++y) {
        for (uint32_t x = x0; x < std::min(x0 + kBeamSide, job.x1); ++x) {
            const FilmPixel& pixel = job.film->pixel(x, y);
            if (pixel.samples >= job.target_samples) continue;
            const uint64_t index = job.first_sample + pixel.samples;
            out.push_back(
                {x, y, index, sample_camera<kTier>(*job.camera, *job.settings, x, y, index)});
        }
    }
}

inline BeamEntry enter_scene(const Accel& accel, const std::vector<PixelSample>& samples) {
    // For fewer it does not pay.
    if (samples.size() < kBeamSide) return {};
    Beam beam;
    for (const PixelSample& sample : samples) beam.add(sample.camera.ray);
    return accel.enter(beam);
}

template <EffectSet kTier>
void render_tile(const TileJob& job, const std::stop_token& stop, TileCounts& counts) {
    NoRecorder recorder;
    std::vector<PixelSample> samples;
    samples.reserve(std::size_t{kBeamSide} * kBeamSide);
    for (uint32_t y0 = job.y0; y0 < job.y1; y0 += kBeamSide) {
        for (uint32_t x0 = job.x0; x0 < job.x1; x0 += kBeamSide) {
            for (;;) {
                begin_samples<kTier>(job, x0, y0, samples);
                if (samples.empty()) break;
                const BeamEntry entry = enter_scene(job.scene->scene().accel(), samples);
                for (const PixelSample& s : samples) {
                    if (stop.stop_requested()) return;
                    const PathSample sample = trace_path<kTier>(
                        *job.scene, *job.camera, *job.settings, s.camera, &entry, recorder);
                    job.film->add(s.x, s.y, sample.Li, sample.covered, s.index, counts.nonfinite,
                                  counts.log);
                    ++counts.samples;
                    counts.rays += sample.rays;
                }
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
