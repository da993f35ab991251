#include "core/session/render_pass.h"

#include <algorithm>
#include <vector>

#include "core/base/check.h"

namespace talbot {
namespace {

// A tile block by block, each up to its own count.
void render_blocks(TileKernel kernel, const TileJob& tile, const RenderPass& pass,
                   const std::stop_token& stop, TileCounts& counts) {
    const std::size_t columns = (tile.film->width() + kErrorBlock - 1) / kErrorBlock;
    for (uint32_t y = tile.y0; y < tile.y1; y = (y / kErrorBlock + 1) * kErrorBlock) {
        for (uint32_t x = tile.x0; x < tile.x1; x = (x / kErrorBlock + 1) * kErrorBlock) {
            TileJob job = tile;
            job.x0 = x;
            job.y0 = y;
            job.x1 = std::min((x / kErrorBlock + 1) * kErrorBlock, tile.x1);
            job.y1 = std::min((y / kErrorBlock + 1) * kErrorBlock, tile.y1);
            const std::size_t block = y / kErrorBlock * columns + x / kErrorBlock;
            job.target_samples = pass.plan->samples(block, pass.target_samples);
            kernel(job, stop, counts);
        }
    }
}

}  // namespace

bool render_pass(const RenderPass& pass, Film& film, WorkerPool& pool, std::stop_source& stop,
                 const std::function<bool()>& out_of_time, TileCounts& counts) {
    const Scene& scene = pass.scene.scene();
    const CameraRays camera(pass.camera, scene.origin(), film.width(), film.height(),
                            scene.geometry().bounds);
    const PathSettings settings = path_settings(pass.settings);
    const TileKernel kernel = tile_kernel(pass.tier);
    const uint32_t size = pass.settings.tile_size;
    const uint32_t columns = (film.width() + size - 1) / size;
    const uint32_t rows = (film.height() + size - 1) / size;
    struct alignas(64) PaddedCounts {
        TileCounts counts;
    };
    std::vector<PaddedCounts> by_worker(pool.size());
    for (PaddedCounts& c : by_worker) c.counts.log = counts.log.fork();
    const std::stop_token token = stop.get_token();
    pool.parallel_for(
        uint64_t{columns} * rows,
        [&](uint64_t tile, unsigned worker) {
            if (out_of_time && out_of_time()) {
                stop.request_stop();
                return;
            }
            TileJob job{&pass.scene,         &camera, &settings, &film, pass.settings.first_sample,
                        pass.target_samples, 0,       0,         0,     0};
            job.x0 = static_cast<uint32_t>(tile % columns) * size;
            job.y0 = static_cast<uint32_t>(tile / columns) * size;
            job.x1 = std::min(job.x0 + size, film.width());
            job.y1 = std::min(job.y0 + size, film.height());
            if (pass.plan != nullptr && !pass.plan->empty())
                render_blocks(kernel, job, pass, token, by_worker[worker].counts);
            else
                kernel(job, token, by_worker[worker].counts);
        },
        token);
    for (const PaddedCounts& c : by_worker) {
        counts.samples += c.counts.samples;
        counts.rays += c.counts.rays;
        counts.nonfinite.merge(c.counts.nonfinite);
        counts.log.merge(c.counts.log);
    }
    return !token.stop_requested();
}

bool render_pass(ViewMoments& view, const RenderSettings& settings, uint64_t target_samples,
                 Film& film, WorkerPool& pool, std::stop_source& stop,
                 const std::function<bool()>& out_of_time, TileCounts& counts,
                 const SamplingPlan* plan) {
    const std::stop_token token = stop.get_token();
    TALBOT_DCHECK(plan == nullptr || plan->empty() || !view.moves());
    uint64_t done = view.moves() ? film.min_samples() : target_samples - 1;
    while (done < target_samples) {
        const PreparedView* at = view.at(settings.first_sample + done, settings, pool, token);
        if (!at) return false;
        ++done;
        if (!render_pass({*at->scene, at->camera, settings, at->tier, done, plan}, film, pool, stop,
                         out_of_time, counts))
            return false;
    }
    return true;
}

}  // namespace talbot
