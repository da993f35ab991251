#include "app/aov_layers.h"

#include <algorithm>

#include "core/integrate/aov_pass.h"
#include "core/session/prepared_view.h"

namespace talbot {
namespace {

AovImage traced_aov(Aov aov, const PreparedView& view, const Snapshot& snapshot, WorkerPool& pool) {
    const CameraRays camera(view.camera, view.given->origin(), snapshot.full_width,
                            snapshot.full_height, view.given->geometry().bounds);
    const uint64_t samples = std::clamp<uint64_t>(snapshot.passes, 1, kAovSamples);
    AovBuffer buffer(aov, snapshot.full_width, snapshot.full_height);
    for (uint64_t i = 0; i < samples; ++i) {
        buffer.add_pass(*view.scene, camera, path_settings(snapshot.settings),
                        snapshot.settings.first_sample, pool, {});
    }
    return buffer.image();
}

}  // namespace

std::vector<ImageLayer> make_aov_layers(const std::vector<Aov>& aovs, const Snapshot& snapshot,
                                        const FilmView& film, WorkerPool& pool) {
    std::vector<ImageLayer> layers;
    if (aovs.empty()) return layers;
    ErrorTracker tracker;
    tracker.restore(film.error);
    const PreparedView view =
        prepare_view(snapshot.scene, snapshot.camera, snapshot.settings, pool);
    for (const Aov aov : aovs) {
        layers.push_back(aov_layer(aov_info(aov).source == AovSource::film
                                       ? film_aov(aov, film.film, tracker.block_errors())
                                       : traced_aov(aov, view, snapshot, pool)));
    }
    return layers;
}

}  // namespace talbot
