// Loading and saving beside the frame loop, which only ever polls. A newer load replaces an older
// one; saves all complete.
#pragma once

#include <atomic>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <variant>
#include <vector>

#include "core/film/tone_map.h"
#include "core/session/retrace.h"
#include "core/session/snapshot.h"
#include "ui/panels.h"
#include "ui/scene_loading.h"

namespace talbot {

// A file that was written.
struct SavedFile {
    std::filesystem::path file;
};

class BackgroundJobs {
  public:
    using Outcome =
        std::variant<LoadedScene, RereadScene, std::shared_ptr<const EnvironmentImage>, SavedFile,
                     ReplayedPath, std::vector<BiasEntry>, ErrorShares, Error>;

    BackgroundJobs() = default;
    ~BackgroundJobs();  // cancels loads, finishes saves
    BackgroundJobs(const BackgroundJobs&) = delete;
    BackgroundJobs& operator=(const BackgroundJobs&) = delete;

    void load_scene(const std::filesystem::path& file, SceneLoader loader);
    // Replaces a load that is under way; shows no status.
    void reread_scene(std::shared_ptr<GltfFile> file, const SceneChoice& choice,
                      const Environment& environment);
    void load_environment(const std::filesystem::path& file);

    // The path of one sample of what the snapshot shows.
    void retrace(std::shared_ptr<const Snapshot> snapshot, const NotedSample& sample);

    // Of what the snapshot shows, after an exposure.
    void measure_bias(std::shared_ptr<const Snapshot> snapshot, float exposure_ev);
    void measure_error_shares(std::shared_ptr<const Snapshot> snapshot, float exposure_ev);

    // PNG through the display settings, EXR and the like scene-linear.
    void save(const std::filesystem::path& file, std::shared_ptr<const ImageRgba> image,
              const DisplaySettings& display);

    // A finished job's outcome, each once; those of replaced loads are dropped.
    std::optional<Outcome> poll();

    bool busy() const { return !jobs_.empty(); }
    // Whether poll() would give something.
    bool has_outcome() const;
    // Whether a load or a rereading is under way.
    bool loading() const;

    // "loading ToyCar.gltf 40 %", or empty.
    std::string status() const;

  private:
    struct Job {
        bool load = false;
        bool must_end = false;  // what is being written is finished
        std::string title;
        std::atomic<float> fraction{0};
        std::atomic<bool> done{false};
        bool replaced = false;
        std::optional<Outcome> outcome;
        std::jthread thread;
    };
    template <typename Work>
    void start(bool load, std::string title, Work work);

    std::shared_ptr<Retracer> retracer_ = std::make_shared<Retracer>();
    std::vector<std::unique_ptr<Job>> jobs_;
};

// Writes by the name's ending: .png, .exr, .hdr or .pfm.
Status save_image(const std::filesystem::path& file, const ImageRgba& image,
                  const DisplaySettings& display);

}  // namespace talbot
