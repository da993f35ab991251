// Films of the headless driver: what identifies them, checkpoints while rendering, and going on
// from one.
#pragma once

#include <condition_variable>
#include <mutex>
#include <optional>
#include <thread>

#include "app/options.h"
#include "app/scene_setup.h"
#include "core/io/film_file.h"
#include "core/session/session.h"

namespace talbot {

// Everything but scene, size, seed and sample range that a sample depends on, as words "key=value"
// with numbers exact to the bit.
std::string sample_settings(const Scene& scene, const Camera& camera,
                            const RenderSettings& settings);

// `identity` is that of the scene's files (SceneSetup).
FilmMetadata film_metadata(const std::string& identity, const Scene& scene, const Camera& camera,
                           const RenderSettings& settings, const FilmView& view);

// The film of --resume, empty without the option. Gives options its size where none was asked for.
Result<std::optional<FilmFile>> load_resume(Options& options);

// Whether the film is a beginning of what the options ask for; names what differs.
Status check_resume(const Options& options, const FilmFile& film, const SceneSetup& setup);

// Saves the session's film every so often on a thread of its own: the render waits only for a copy
// in memory, between two passes. A save that fails is a warning, and the next one is tried.
class CheckpointWriter {
  public:
    CheckpointWriter(RenderSession& session, const SceneSetup& setup, std::string file,
                     double every_seconds);
    // After a save that is under way.
    ~CheckpointWriter();
    CheckpointWriter(const CheckpointWriter&) = delete;
    CheckpointWriter& operator=(const CheckpointWriter&) = delete;

  private:
    void run();
    void save();

    RenderSession& session_;
    const SceneSetup& setup_;
    const std::string file_;
    const double every_seconds_;
    std::mutex mutex_;
    std::condition_variable wake_;
    bool quit_ = false;
    std::thread thread_;
};

}  // namespace talbot
