#include "core/session/render_pass.h"

#include <algorithm>
#include <vector>

namespace talbot {

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
                 const std::function<bool()>& out_of_time, TileCounts& counts) {
    const std::stop_token token = stop.get_token();
    uint64_t done = view.moves() ? film.min_samples() : target_samples - 1;
    while (done < target_samples) {
        const PreparedView* at = view.at(settings.first_sample + done, settings, pool, token);
        ++done;
        if (!at || !render_pass({*at->scene, at->camera, settings, at->tier, done}, film, pool,
                                stop, out_of_time, counts))
            return false;
    }
    return true;
}

}  // namespace talbot
