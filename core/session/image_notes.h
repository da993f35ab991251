// What a session notes about its image beside the film: samples to look at, and where the error is.
#pragma once

#include <memory>
#include <vector>

#include "core/accuracy/error_estimate.h"
#include "core/film/sample_log.h"

namespace talbot {

struct ImageNotes {
    std::vector<NotedSample> unusable;  // the first ones
    std::vector<NotedSample> outliers;  // the largest ones, largest first
    std::vector<float>
        block_errors;  // relRMSE in per cent of 8x8 pixels, at the last octave; or empty
};

class NoteKeeper {
  public:
    SampleLog fork() const { return log_.fork(); }
    void merge(const SampleLog& log) { log_.merge(log); }
    // After a whole pass.
    void observe(const Film& film, const ErrorTracker& tracker);

    const std::shared_ptr<const ImageNotes>& latest() const { return latest_; }

  private:
    SampleLog log_;
    std::shared_ptr<const ImageNotes> latest_ = std::make_shared<const ImageNotes>();
};

}  // namespace talbot
