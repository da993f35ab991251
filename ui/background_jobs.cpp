#include "ui/background_jobs.h"

#include <algorithm>
#include <cstdio>
#include <exception>
#include <utility>

#include "core/io/image_io.h"

namespace talbot {

BackgroundJobs::~BackgroundJobs() {
    for (const std::unique_ptr<Job>& job : jobs_) {
        if (!job->must_end) job->thread.request_stop();
    }
}

template <typename Work>
void BackgroundJobs::start(bool load, std::string title, Work work) {
    if (load) {
        for (const std::unique_ptr<Job>& job : jobs_) {
            if (!job->load) continue;
            job->thread.request_stop();
            job->replaced = true;
        }
    }
    auto job = std::make_unique<Job>();
    Job& shared = *job;
    shared.load = load;
    shared.must_end = title.starts_with("saving");
    shared.title = std::move(title);
    shared.thread = std::jthread([&shared, work = std::move(work)](std::stop_token stop) {
        try {
            shared.outcome = work(stop, shared.fraction);
        } catch (const std::exception& failure) {
            shared.outcome = Error{ErrorKind::failed, "", shared.title, failure.what()};
        }
        shared.done.store(true, std::memory_order_release);
    });
    jobs_.push_back(std::move(job));
}

void BackgroundJobs::load_scene(const std::filesystem::path& file, SceneLoader loader) {
    start(true, "loading " + file.filename().string(),
          [file, loader = std::move(loader)](std::stop_token stop,
                                             std::atomic<float>& fraction) -> Outcome {
              Result<LoadedScene> loaded = loader(file, stop, [&](float done, const char*) {
                  fraction.store(done, std::memory_order_relaxed);
              });
              if (!loaded) return loaded.error();
              return std::move(*loaded);
          });
}

void BackgroundJobs::reread_scene(std::shared_ptr<GltfFile> file, const SceneChoice& choice,
                                  const Environment& environment) {
    start(true, "",
          [file = std::move(file), choice, environment](std::stop_token stop,
                                                        std::atomic<float>&) -> Outcome {
              Result<RereadScene> reread = talbot::reread_scene(file, choice, environment, stop);
              if (!reread) return reread.error();
              return std::move(*reread);
          });
}

bool BackgroundJobs::has_outcome() const {
    return std::any_of(jobs_.begin(), jobs_.end(), [](const std::unique_ptr<Job>& job) {
        return job->done.load(std::memory_order_acquire);
    });
}

bool BackgroundJobs::loading() const {
    return std::any_of(jobs_.begin(), jobs_.end(),
                       [](const std::unique_ptr<Job>& job) { return job->load && !job->replaced; });
}

void BackgroundJobs::load_environment(const std::filesystem::path& file) {
    start(true, "loading " + file.filename().string(),
          [file](std::stop_token, std::atomic<float>&) -> Outcome {
              Result<EnvironmentImage> image = talbot::load_environment(file);
              if (!image) return image.error();
              return std::make_shared<const EnvironmentImage>(std::move(*image));
          });
}

void BackgroundJobs::retrace(std::shared_ptr<const Snapshot> snapshot, const NotedSample& sample) {
    start(false, "tracing a path",
          [snapshot = std::move(snapshot), sample, retracer = retracer_](
              std::stop_token, std::atomic<float>&) -> Outcome {
              return retracer->path(snapshot->scene, snapshot->camera, snapshot->settings, sample.x,
                                    sample.y, sample.sample);
          });
}

void BackgroundJobs::measure_bias(std::shared_ptr<const Snapshot> snapshot, float exposure_ev) {
    start(false, "measuring bias",
          [s = std::move(snapshot), exposure_ev](std::stop_token stop,
                                                 std::atomic<float>&) -> Outcome {
              WorkerPool pool(0);
              return talbot::measure_bias(s->scene, s->camera, s->settings,
                                          static_cast<double>(exposure_ev), pool, stop);
          });
}

void BackgroundJobs::measure_error_shares(std::shared_ptr<const Snapshot> snapshot,
                                          float exposure_ev) {
    start(false, "measuring the error's parts",
          [s = std::move(snapshot), exposure_ev](std::stop_token stop,
                                                 std::atomic<float>&) -> Outcome {
              WorkerPool pool(0);
              ErrorSharePolicy policy;
              policy.exposure_ev = exposure_ev;
              return talbot::measure_error_shares(s->scene, s->camera, s->settings, policy, pool,
                                                  stop);
          });
}

void BackgroundJobs::save(const std::filesystem::path& file, std::shared_ptr<const ImageRgba> image,
                          const DisplaySettings& display) {
    start(
        false, "saving " + file.filename().string(),
        [file, image = std::move(image), display](std::stop_token, std::atomic<float>&) -> Outcome {
            const Status saved = save_image(file, *image, display);
            if (!saved) return saved.error();
            return SavedFile{file};
        });
}

std::optional<BackgroundJobs::Outcome> BackgroundJobs::poll() {
    for (auto job = jobs_.begin(); job != jobs_.end(); ++job) {
        if (!(*job)->done.load(std::memory_order_acquire)) continue;
        const std::unique_ptr<Job> finished = std::move(*job);
        jobs_.erase(job);
        finished->thread.join();
        if (finished->replaced) return poll();
        return std::move(finished->outcome);
    }
    return std::nullopt;
}

std::string BackgroundJobs::status() const {
    for (const std::unique_ptr<Job>& job : jobs_) {
        if (job->replaced || job->title.empty()) continue;
        if (!job->load) return job->title;
        char percent[16];
        std::snprintf(percent, sizeof percent, " %.0f %%",
                      100.0 * static_cast<double>(job->fraction.load()));
        return job->title + percent;
    }
    return {};
}

Status save_image(const std::filesystem::path& file, const ImageRgba& image,
                  const DisplaySettings& display) {
    const std::string extension = file.extension().string();
    if (extension == ".png") return save_png(file, develop(image, display));
    if (extension == ".exr") return save_exr(file, image);
    if (extension == ".hdr") return save_hdr(file, image);
    if (extension == ".pfm") return save_pfm(file, image);
    return Error{ErrorKind::usage, file.string(), "",
                 "unknown kind of image; end the name in .png, .exr, .hdr or .pfm"};
}

}  // namespace talbot
