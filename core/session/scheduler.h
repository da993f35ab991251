// Decides what the session does next: a pure function of its state, without threads or clocks, so
// that it is tested as one.
#pragma once

#include <cstdint>

namespace talbot {

enum class WorkKind : uint8_t { idle, preview, pass };

struct Work {
    WorkKind kind = WorkKind::idle;
    uint32_t preview_divisor = 1;  // a preview renders every divisor-th pixel in x and y
    bool interruptible = true;  // the first preview after a change runs to its end, so that a drag
                                // always shows something

    bool operator==(const Work&) const = default;
};

struct ScheduleState {
    bool has_scene = false;
    bool interactive = false;
    bool paused = false;
    uint64_t passes = 0;         // whole passes done
    uint64_t pass_limit = 0;     // 0 = none
    bool stop_reached = false;   // a time or error target is met
    uint32_t previews_done = 0;  // since the last restart
    uint32_t last_preview_divisor = 0;
    double samples_per_second = 0;  // measured lately; 0 = unknown
    double preview_seconds = 0.02;  // aim for the first preview
    uint64_t pixels = 0;
};

// The coarsest and finest previews.
inline constexpr uint32_t kMaxPreviewDivisor = 16;
inline constexpr uint32_t kFirstPreviewDivisor = 8;  // when nothing was measured yet

Work next_work(const ScheduleState& state);

// The power of two by which an image of `pixels` must be divided, in each direction, to take about
// `seconds`.
uint32_t preview_divisor(uint64_t pixels, double samples_per_second, double seconds);

// Samples per second after one more measurement; too small ones change nothing.
double blended_rate(double previous, uint64_t samples, double seconds);

}  // namespace talbot
