// One step of the viewer: take input, lay out panels, submit changes, take the latest snapshot,
// draw, present. The window, the offscreen screenshot and replayed scripts all run this loop; they
// differ in where input and OpenGL come from. It never waits for the session.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "core/session/session.h"
#include "ui/ab_view.h"
#include "ui/background_jobs.h"
#include "ui/box_overlay.h"
#include "ui/display.h"
#include "ui/gl_context.h"
#include "ui/input.h"
#include "ui/latency.h"
#include "ui/layout.h"
#include "ui/panel_renderer.h"
#include "ui/panels.h"
#include "ui/shortcuts.h"
#include "ui/viewer_model.h"

struct ImGuiContext;

namespace talbot {

struct FrameLoopOptions {
    SceneLoader loader;  // for files that are opened or dropped; empty takes load_scene
    float ui_scale = 0;  // 0 = the context's content scale
};

class FrameLoop {
  public:
    // Shaders and fonts are loaded here; session and context must outlive the loop.
    static Result<std::unique_ptr<FrameLoop>> make(RenderSession& session, GlContext& context,
                                                   ViewerModel model,
                                                   FrameLoopOptions options = {});
    ~FrameLoop();
    FrameLoop(const FrameLoop&) = delete;
    FrameLoop& operator=(const FrameLoop&) = delete;

    InputQueue& input() { return input_; }
    ViewerModel& model() { return model_; }
    Edits& edits() { return edits_; }

    // Puts a scene on show with the next step.
    void show(LoadedScene loaded);

    // Whether a step would draw something that the last one did not.
    bool needs_frame() const;

    // Asks for the frames that ImGui needs after an input until all that depends on it is drawn.
    void settle();

    // Asks for a frame although no input came: something was changed from outside.
    void redraw();

    // A frame in two halves: input, panels and changes; then what there is to see. Between them the
    // caller may wait for events until the image of a change that was just submitted is there, so
    // that it is not seen a frame late.
    void update();
    // Seconds that drawing may still be put off for that image; 0 = draw now.
    double draw_delay() const;
    void draw();
    // Both at once.
    void step();

    // What the last step showed; null before the first image.
    const Snapshot* snapshot() const { return snapshot_.get(); }
    PixelRect image_rect() const { return image_rect_; }
    uint64_t submitted_generation() const { return generation_; }
    bool quit_requested() const { return quit_; }
    const BackgroundJobs& jobs() const { return jobs_; }
    LatencyRecorder& recorder() { return recorder_; }
    // The message over the image, empty when there is none.
    const std::string& notice() const { return notice_; }
    // The path that is drawn over the image, if any.
    const std::optional<ReplayedPath>& path() const { return path_; }

    // Starts loading a scene or an environment, or saving what is shown.
    void open_file(const std::string& file);
    void save_file(const std::string& file);

  private:
    FrameLoop(RenderSession& session, GlContext& context, ViewerModel model,
              FrameLoopOptions options);
    Status load();

    void take_input(double now);
    void draw_ui(double seconds);
    void run_shortcuts();
    void run_command(ViewerCommand command);
    void select_at(const Vec2f& position);
    std::optional<Pick> pick_at(const Vec2f& position) const;
    void finish_jobs();
    void follow_choice(double now);
    void follow_target();
    void follow_comparison(const AbRequest& request);
    void grant(const PanelRequests& requests);
    std::optional<PixelReading> pixel_under_pointer() const;
    void follow_window(double now);
    void submit_changes(double input_time);
    void draw_and_present();
    void notify(std::string text, bool is_error);

    RenderSession& session_;
    GlContext& context_;
    FrameLoopOptions options_;
    ViewerModel model_;
    Edits edits_;
    InputQueue input_;
    ImGuiContext* imgui_ = nullptr;
    Display display_;
    PanelRenderer panels_;
    BackgroundJobs jobs_;
    AbView ab_;
    LatencyRecorder recorder_;
    FileForm form_;
    std::optional<ReplayedPath> path_;
    BoxOverlay boxes_;
    Diagnosis diagnosis_;
    uint64_t image_generation_ = 0;  // of the newest change that alters the image
    uint64_t target_met_by_ = 0;     // the one that was stopped at its target
    std::shared_ptr<const Snapshot> snapshot_;
    PixelRect area_;
    PixelRect image_rect_;
    PixelSize wanted_size_;  // of the image, while the window is being resized
    double wanted_since_ = 0;
    std::string notice_;
    bool notice_is_error_ = false;
    double notice_until_ = 0;
    double last_step_ = 0;
    double update_seconds_ = 0;
    double chosen_at_ = 0;    // when the choice was made that is being read
    double opened_at_ = 0;    // when the file was asked for that is being loaded
    double latch_until_ = 0;  // drawing waits for the image of generation_ no longer than this
    double gl_seconds_ = 0;
    float scale_ = 0;
    uint64_t generation_ = 0;
    float error_exposure_ = 0;  // as the session was told
    int settle_frames_ = 0;
    std::shared_ptr<const AbSnapshot> shown_ab_;
    bool comparing_ = false;  // the render rests meanwhile
    bool quit_ = false;
};

// Monotonic seconds.
double now_seconds();

}  // namespace talbot
