// The viewer: a window round a RenderSession, or the same window drawn once offscreen.
#pragma once

#include <cstdint>
#include <filesystem>

#include "core/base/result.h"
#include "core/session/session.h"
#include "ui/frame_loop.h"
#include "ui/gl_context.h"
#include "ui/scene_loading.h"
#include "ui/viewer_model.h"

namespace talbot {

struct ViewerOptions {
    LoadedScene scene;  // shown first; with a null scene `file` is loaded once the window is open
    std::filesystem::path file;
    SceneLoader loader;  // for `file`, opened and dropped files; empty takes ui's load_scene
    RenderSettings settings;
    bool fixed_size = false;  // keep settings' size; else the image follows the window
    DisplaySettings display;
    unsigned threads = 0;
    uint64_t pass_limit = 0;
    PixelSize window;    // 0 = chosen from the image's size, or 1600 x 900
    float ui_scale = 0;  // 0 = the screen's
};

// How the frame loop of this viewer loads and measures.
FrameLoopOptions frame_loop_options(const ViewerOptions& options);

// Runs until the user quits.
Status run_viewer(const ViewerOptions& options);

struct ScreenshotOptions {
    DisplaySettings display;
    PixelSize window;  // 0 = the image in its own size with the panels round it
    float ui_scale = 1;
};

// Draws the window with its panels offscreen, as it would show the session's latest snapshot, and
// writes a PNG. The session is not changed.
Status save_window_screenshot(RenderSession& session, const ScreenshotOptions& options,
                              const std::filesystem::path& file);

// The window that shows an image of this size unscaled between the panels.
PixelSize window_for_image(uint32_t width, uint32_t height, float ui_scale);

// The model that the options start with; without a scene yet.
ViewerModel initial_model(const ViewerOptions& options);

}  // namespace talbot
