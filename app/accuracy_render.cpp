#include "app/accuracy_render.h"

#include <bit>
#include <chrono>
#include <cmath>
#include <filesystem>

#include "app/checkpoint.h"
#include "app/scene_assets.h"
#include "core/base/cpu_clock.h"
#include "core/io/image_io.h"
#include "core/session/render_pass.h"

namespace talbot {
namespace {

constexpr std::size_t kReferenceParts = 4;
constexpr std::size_t kSettingsDigits = 8;  // of their hash, in the names of cached films
constexpr uint64_t kReferenceSeed = 0x7265666572656E63;  // "referenc"

// Shares what the scene's renders have in common.
PreparedView view_of(const AccuracyScene& scene, const RenderSettings& settings, WorkerPool& pool) {
    PreparedView base;
    base.given = base.reduced = scene.setup.scene;
    base.scene = scene.render_scene;
    return prepare_view(scene.setup.scene, scene.setup.camera, settings, pool, &base);
}

}  // namespace

Result<AccuracyScene> load_accuracy_scene(const Options& options, WorkerPool& pool) {
    Result<SceneSetup> setup = set_up_scene(options, pool);
    if (!setup) return setup.error();
    AccuracyScene scene;
    scene.name = scene_path(options).filename().string();
    scene.setup = std::move(*setup);
    hash_assets(scene.setup);
    scene.render_scene = std::make_shared<const RenderScene>(scene.setup.scene);
    scene.exposure_ev = options.display.exposure_ev;
    scene.effects = analyse_effects(*scene.setup.scene, scene.setup.camera);
    return scene;
}

MeasuredRender::MeasuredRender(const AccuracyScene& scene, const RenderSettings& settings,
                               WorkerPool& pool)
    : scene_(scene),
      settings_(settings),
      pool_(pool),
      view_(view_of(scene, settings, pool)),
      film_(settings.width, settings.height) {
    tracker_.reset(scene.exposure_ev, 0, settings.adaptive && !view_.moves());
}

void MeasuredRender::render_unobserved(uint64_t samples) {
    if (samples <= samples_) return;
    using Clock = std::chrono::steady_clock;
    const Clock::time_point start = Clock::now();
    const double cpu_start = process_cpu_seconds();
    std::stop_source stop;
    TileCounts counts;
    render_pass(view_, settings_, samples, film_, pool_, stop, {}, counts, &tracker_.plan());
    seconds_ += std::chrono::duration<double>(Clock::now() - start).count();
    cpu_seconds_ += process_cpu_seconds() - cpu_start;
    rays_ += counts.rays;
    samples_ = samples;
}

void MeasuredRender::render_until(uint64_t samples) {
    while (samples_ < samples) {
        const uint64_t next = std::bit_ceil(samples_ + 1);
        render_unobserved(std::min(next, samples));
        tracker_.observe(film_, samples_, seconds_, &pool_);
    }
}

Result<Reference> render_reference(const AccuracyScene& scene, const RenderSettings& settings,
                                   uint64_t samples, const std::string& cache, WorkerPool& pool) {
    const uint64_t each = std::bit_ceil((samples + kReferenceParts - 1) / kReferenceParts);
    std::vector<Film> films;
    for (std::size_t i = 0; i < kReferenceParts; ++i) {
        RenderSettings own = settings;
        own.seed = kReferenceSeed + i;
        own.first_sample = 0;
        own.adaptive = false;
        const std::string words = sample_settings(*scene.setup.scene, scene.setup.camera, own);
        std::filesystem::path file;
        if (!cache.empty()) {
            file = std::filesystem::path(cache) / (scene.name + "-" + std::to_string(own.width) +
                                                   "x" + std::to_string(own.height) + "-" +
                                                   sha256_hex(words).substr(0, kSettingsDigits) +
                                                   "-" + std::to_string(i) + ".film");
        }
        if (!file.empty()) {
            Result<FilmFile> stored = load_film(file);
            // One that cannot be read is made anew, as one of something else is.
            if (stored && stored->metadata.settings == words &&
                stored->metadata.scene_sha256 == scene.setup.identity &&
                stored->metadata.seed == own.seed && stored->film.min_samples() >= each) {
                films.push_back(std::move(stored->film));
                continue;
            }
        }
        MeasuredRender render(scene, own, pool);
        render.render_unobserved(each);
        if (!file.empty()) {
            const ErrorTracker::State no_octaves;
            const NonFiniteCount no_count;
            const FilmView view{render.film(), no_octaves, render.seconds(), render.rays(),
                                no_count};
            const Status saved = save_film(file, view.film,
                                           film_metadata(scene.setup.identity, *scene.setup.scene,
                                                         scene.setup.camera, own, view));
            if (!saved) return saved.error();
        }
        films.push_back(render.film());
    }
    std::vector<const Film*> parts;
    for (const Film& film : films) parts.push_back(&film);
    return make_reference(parts);
}

double true_error_percent(const Film& film, const Reference& reference, double exposure_ev) {
    return 100 *
           std::sqrt(std::max(0.0, true_relmse(film, reference, metric_constant(exposure_ev))));
}

}  // namespace talbot
