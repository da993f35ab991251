// Carries out one step of a script after the other, frame by frame at the pace of a screen.
#pragma once

#include <condition_variable>
#include <mutex>
#include <random>
#include <string>
#include <vector>

#include "ui/frame_loop.h"
#include "ui/interaction_script.h"

namespace talbot {

// What an "idle" step saw.
struct IdleRecord {
    double seconds = 0;
    double samples_per_second = 0;
};

// From this frame on the image on show came from this kernel and had these effects.
struct KernelRecord {
    uint64_t frame = 0;
    std::string kernel;
    EffectSet effects;
};

class InteractionRunner {
  public:
    InteractionRunner(GlContext& context, FrameLoop& loop);

    // The error names the line of the script.
    Status run(const ScriptStep& step, const std::string& script);

    const std::vector<IdleRecord>& idle_records() const { return idle_; }
    const std::vector<KernelRecord>& kernel_records() const { return kernels_; }
    uint64_t frames() const { return frames_; }

    // To be called by the session on each new snapshot.
    void wake();

  private:
    void frame();
    void note_frame();
    bool wait_until(const ScriptStep& step, const std::function<bool()>& reached);
    Vec2f position_of(double x, double y, bool in_window) const;
    void drag(Vec2f from, Vec2f by, const ScriptStep& step);
    void press_modifiers(const ScriptStep& step, bool down);
    void click(const ScriptStep& step);
    void press_key(const ScriptStep& step);
    void type(const std::string& text);
    std::string set_value(const std::string& path, const std::vector<double>& numbers,
                          const std::string& text);
    std::string sweep(const ScriptStep& step);
    std::string wait(const ScriptStep& step);
    std::string save(const ScriptStep& step);
    std::string screenshot(const ScriptStep& step);
    std::string expect(const ScriptStep& step);
    void idle(double seconds);
    void randomly(const ScriptStep& step);
    void random_edit(std::mt19937_64& random);
    std::string carry_out(const ScriptStep& step);

    GlContext& context_;
    FrameLoop& loop_;
    std::vector<IdleRecord> idle_;
    std::vector<KernelRecord> kernels_;
    uint64_t frames_ = 0;
    double next_frame_ = 0;
    std::mutex mutex_;
    std::condition_variable woken_;
    bool has_news_ = false;
};

}  // namespace talbot
