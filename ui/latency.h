// How long the user waits: from the start of the frame that takes an input to the end of the first
// presented frame whose snapshot shows the change; and what the frames of the UI thread cost.
// OpenGL time is kept apart, because a software rasteriser's says nothing about a graphics card.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <string_view>
#include <vector>

#include "core/session/change.h"

namespace talbot {

enum class ChangeKind : uint8_t {
    camera,
    material,
    light,
    environment,
    settings,
    scene,
    animation
};
inline constexpr std::array<std::string_view, 7> kChangeKindNames{
    "camera", "material", "light", "environment", "settings", "scene", "animation"};

// The kind of a change that alters the image; false for pauses, limits, selections and restarts.
bool change_kind(const Change& change, ChangeKind& kind);

// Order statistics of seconds; all zero without values.
struct TimeStatistics {
    std::size_t count = 0;
    double median = 0;
    double p95 = 0;
    double p99 = 0;
    double worst = 0;
};
TimeStatistics statistics_of(std::vector<double> seconds);

class LatencyRecorder {
  public:
    void submitted(uint64_t generation, ChangeKind kind, double input_time);

    // A frame that shows the generation was presented; gl_seconds is all OpenGL time up to now.
    void presented(uint64_t generation, double now, double gl_seconds);

    void frame(double ui_seconds, double gl_seconds);

    // Of one kind: with OpenGL time, or without the part of it that fell into the wait.
    TimeStatistics latencies(ChangeKind kind, bool without_gl) const;
    TimeStatistics frame_times() const { return statistics_of(frames_); }
    TimeStatistics gl_times() const { return statistics_of(gl_frames_); }

    // Changes that no presented frame has shown yet.
    std::size_t pending() const { return pending_.size(); }

  private:
    struct Pending {
        uint64_t generation;
        ChangeKind kind;
        double time;
        double gl_seconds;
    };
    struct Latency {
        ChangeKind kind;
        double seconds;
        double gl_seconds;
    };
    std::deque<Pending> pending_;
    std::vector<Latency> latencies_;
    std::vector<double> frames_;
    std::vector<double> gl_frames_;
    double gl_seconds_ = 0;
};

}  // namespace talbot
