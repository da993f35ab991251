#include "app/viewer.h"

#include <algorithm>
#include <cmath>

#include "core/io/image_io.h"
#include "ui/style.h"
#include "ui/window.h"

namespace talbot {
namespace {

constexpr PixelSize kDefaultWindow{1600, 900};
// Frames are at least this far apart, so that workers keep the cores.
constexpr double kFrameSeconds = 1.0 / 60;
// Without news the loop looks round this often.
constexpr double kIdleSeconds = 0.25;

PixelSize window_size(const ViewerOptions& options) {
    if (options.window.width > 0 && options.window.height > 0) return options.window;
    if (!options.fixed_size) return kDefaultWindow;
    const PixelSize fitting = window_for_image(options.settings.width, options.settings.height, 1);
    return {std::max(fitting.width, 1000), std::max(fitting.height, 600)};
}

SessionPolicy viewer_policy(unsigned threads) {
    SessionPolicy policy;
    policy.interactive = true;
    policy.threads = threads;
    return policy;
}

}  // namespace

PixelSize window_for_image(uint32_t width, uint32_t height, float ui_scale) {
    const int panels = 2 * static_cast<int>(std::lround(kSidePanelWidth * ui_scale));
    const int bar = static_cast<int>(std::lround(kStatusBarHeight * ui_scale));
    return {static_cast<int>(width) + panels, static_cast<int>(height) + bar};
}

ViewerModel initial_model(const ViewerOptions& options) {
    ViewerModel model;
    model.settings = options.settings;
    model.rival = options.settings;
    model.display = options.display;
    model.look.fit_window = !options.fixed_size;
    model.pass_limit = options.pass_limit;
    return model;
}

FrameLoopOptions frame_loop_options(const ViewerOptions& options) {
    FrameLoopOptions loop;
    loop.loader = options.loader;
    loop.ui_scale = options.ui_scale;
    return loop;
}

Status run_viewer(const ViewerOptions& options) {
    Result<std::unique_ptr<Window>> opened = Window::open(window_size(options), "Talbot");
    if (!opened) return opened.error();
    Window& window = **opened;

    RenderSession session(viewer_policy(options.threads));
    session.on_snapshot([] { Window::wake(); });
    Result<std::unique_ptr<FrameLoop>> made =
        FrameLoop::make(session, window, initial_model(options), frame_loop_options(options));
    if (!made) return made.error();
    FrameLoop& loop = **made;
    if (options.scene.scene) {
        loop.show(options.scene);
    } else {
        loop.open_file(options.file.string());
    }

    std::string title;
    double last_frame = 0;
    while (!loop.quit_requested()) {
        const double since = now_seconds() - last_frame;
        if (!loop.needs_frame()) {
            window.wait(loop.input(), loop.jobs().busy() ? kFrameSeconds : kIdleSeconds);
        } else if (since < kFrameSeconds) {
            window.wait(loop.input(), kFrameSeconds - since);
            continue;
        } else {
            window.wait(loop.input(), 0);
        }
        if (!loop.needs_frame()) continue;
        last_frame = now_seconds();
        loop.update();
        // Ends early when the image arrives; input that comes meanwhile is kept for the next frame.
        for (double delay = loop.draw_delay(); delay > 0; delay = loop.draw_delay())
            window.wait(loop.input(), delay);
        loop.draw();
        window.follow_panels();
        const std::string wanted =
            loop.model().scene
                ? std::filesystem::path(loop.model().scene->file()).filename().string() +
                      " - Talbot"
                : "Talbot";
        if (wanted != title) window.set_title(title = wanted);
    }
    session.stop();
    return Done{};
}

Status save_window_screenshot(RenderSession& session, const ScreenshotOptions& options,
                              const std::filesystem::path& file) {
    const std::shared_ptr<const Snapshot> snapshot = session.latest();
    if (!snapshot)
        return Error{ErrorKind::failed, file.string(), "",
                     "there is no image yet to make a screenshot of"};
    PixelSize size = options.window;
    if (size.width <= 0 || size.height <= 0) {
        size = window_for_image(snapshot->full_width, snapshot->full_height, options.ui_scale);
        size = {std::clamp(size.width, 1000, 8192), std::clamp(size.height, 860, 8192)};
    }
    Result<std::unique_ptr<GlContext>> context = make_offscreen_context(size);
    if (!context) return context.error();

    ViewerModel model;
    Edits ignored;
    show_scene(model, {snapshot->scene, snapshot->camera, nullptr, {}}, ignored);
    model.settings = snapshot->settings;
    model.display = options.display;
    model.look.fit_window = false;
    FrameLoopOptions loop_options;
    loop_options.ui_scale = options.ui_scale;
    Result<std::unique_ptr<FrameLoop>> loop =
        FrameLoop::make(session, **context, std::move(model), loop_options);
    if (!loop) return loop.error();
    // The first frames measure the panels' contents.
    for (int i = 0; i < 4; ++i) (*loop)->step();
    return save_png(file, (*context)->read_pixels());
}

}  // namespace talbot
