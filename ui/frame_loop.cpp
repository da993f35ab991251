#include "ui/frame_loop.h"

#include <imgui.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "ui/layout.h"
#include "ui/style.h"
#include "ui/viewport.h"

namespace talbot {
namespace {

// ImGui needs a few frames after an input until everything that depends on it is drawn.
constexpr int kSettleFrames = 3;
// The window's size must rest this long before the image follows.
constexpr double kResizeRest = 0.12;
// A frame is put off this long for the image that its own change asked for.
constexpr double kLatchSeconds = 0.03;
constexpr double kNoticeSeconds = 6;
constexpr float kExposureStep = 1.0f / 3.0f;

}  // namespace

double now_seconds() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
}

FrameLoop::FrameLoop(RenderSession& session, GlContext& context, ViewerModel model,
                     FrameLoopOptions options)
    : session_(session),
      context_(context),
      options_(std::move(options)),
      model_(std::move(model)),
      display_(context.gl()),
      panels_(context.gl()) {
    if (!options_.loader) {
        options_.loader = [](const std::filesystem::path& file, std::stop_token stop,
                             const LoadProgress& progress) {
            return load_scene(file, stop, progress, default_environment(), 0);
        };
    }
}

FrameLoop::~FrameLoop() {
    if (imgui_) ImGui::DestroyContext(imgui_);
}

Result<std::unique_ptr<FrameLoop>> FrameLoop::make(RenderSession& session, GlContext& context,
                                                   ViewerModel model, FrameLoopOptions options) {
    std::unique_ptr<FrameLoop> loop(
        new FrameLoop(session, context, std::move(model), std::move(options)));
    if (Status loaded = loop->load(); !loaded) return loaded.error();
    return loop;
}

Status FrameLoop::load() {
    imgui_ = ImGui::CreateContext();
    ImGui::SetCurrentContext(imgui_);
    ImGuiIO& io = ImGui::GetIO();
    io.IniFilename = nullptr;
    io.LogFilename = nullptr;
    io.BackendFlags |= ImGuiBackendFlags_RendererHasVtxOffset | ImGuiBackendFlags_HasMouseCursors;
    io.MousePos = ImVec2(-1, -1);
    set_up_panel_keys();
    if (Status loaded = display_.load(); !loaded) return loaded;
    if (Status loaded = panels_.load(); !loaded) return loaded;
    last_step_ = now_seconds();
    return Done{};
}

void FrameLoop::show(std::shared_ptr<const Scene> scene, const Camera& camera) {
    show_scene(model_, std::move(scene), camera, edits_);
}

bool FrameLoop::needs_frame() const {
    if (settle_frames_ > 0 || !input_.empty() || edits_.any() || jobs_.busy() || !notice_.empty())
        return true;
    if (session_.latest() != snapshot_) return true;
    if (wanted_size_ != PixelSize{}) return true;
    const ImGuiIO& io = ImGui::GetIO();
    // Held keys fly, held buttons drag, a text box's cursor blinks.
    return io.WantTextInput ||
           std::any_of(std::begin(io.KeysDown), std::end(io.KeysDown), [](bool b) { return b; }) ||
           std::any_of(std::begin(io.MouseDown), std::end(io.MouseDown), [](bool b) { return b; });
}

void FrameLoop::redraw() {
    settle_frames_ = std::max(settle_frames_, 1);
}

void FrameLoop::step() {
    update();
    draw();
}

void FrameLoop::update() {
    const double start = now_seconds();
    ImGui::SetCurrentContext(imgui_);
    take_input(start);
    draw_ui(start - last_step_);
    finish_jobs();
    follow_window(start);
    submit_changes(start);
    last_step_ = start;
    update_seconds_ = now_seconds() - start;
}

double FrameLoop::draw_delay() const {
    const std::shared_ptr<const Snapshot> latest = session_.latest();
    if (latest && latest->generation >= generation_) return 0;
    return std::max(0.0, latch_until_ - now_seconds());
}

void FrameLoop::draw() {
    const double start = now_seconds();
    const double gl_before = gl_seconds_;
    ImGui::SetCurrentContext(imgui_);
    draw_and_present();
    latch_until_ = 0;
    const double end = now_seconds();
    const double gl_seconds = gl_seconds_ - gl_before;
    recorder_.frame(update_seconds_ + (end - start) - gl_seconds, gl_seconds);
    recorder_.presented(snapshot_ ? snapshot_->generation : 0, end, gl_seconds_);
}

void FrameLoop::take_input(double now) {
    const float scale = options_.ui_scale > 0 ? options_.ui_scale : context_.content_scale();
    if (scale != scale_) {
        scale_ = scale;
        apply_style(scale);
        panels_.upload_fonts();
        settle_frames_ = kSettleFrames;
    }
    ImGuiIO& io = ImGui::GetIO();
    const PixelSize size = context_.size();
    const ImVec2 display_size(static_cast<float>(size.width), static_cast<float>(size.height));
    if (io.DisplaySize.x != display_size.x || io.DisplaySize.y != display_size.y)
        settle_frames_ = kSettleFrames;
    io.DisplaySize = display_size;
    io.DeltaTime = static_cast<float>(std::clamp(now - last_step_, 0.0005, 1.0));
    settle_frames_ = std::max(0, settle_frames_ - 1);
    for (const InputEvent& event : input_.take_frame()) {
        settle_frames_ = kSettleFrames;
        if (event.kind == InputEvent::Kind::drop && !event.files.empty())
            open_file(event.files.front());
        if (event.kind == InputEvent::Kind::close) quit_ = true;
        feed_panels(event);
    }
}

void FrameLoop::draw_ui(double seconds) {
    ImGui::NewFrame();
    const PixelSize size = context_.size();
    area_ = image_area(size, scale_, model_.look.show_panels);
    const uint32_t width = snapshot_ ? snapshot_->full_width : model_.settings.width;
    const uint32_t height = snapshot_ ? snapshot_->full_height : model_.settings.height;
    image_rect_ = fit_image(area_, width, height, model_.look.fit_window);

    const ViewportResult viewport = handle_viewport(model_, area_, image_rect_, seconds);
    edits_.camera |= viewport.camera_changed;
    if (viewport.click) select_at(*viewport.click);
    if (viewport.double_click) {
        if (const std::optional<Pick> hit = pick_at(*viewport.double_click)) {
            model_.view.aim_at(hit->point);
            edits_.camera = true;
        }
    }
    if (model_.look.show_panels) {
        FileRequest request;
        StatusLine status;
        status.busy = jobs_.status();
        draw_panels(size, scale_, model_, edits_, snapshot_.get(), session_.threads(), status,
                    form_, request);
        if (request.open) open_file(*request.open);
        if (request.save) save_file(*request.save);
    }
    if (model_.look.show_help) model_.look.show_help = draw_help_overlay();
    if (!notice_.empty()) {
        draw_notice(area_, notice_, notice_is_error_);
        if (now_seconds() > notice_until_) notice_.clear();
    }
    run_shortcuts();
    ImGui::Render();
}

void FrameLoop::run_shortcuts() {
    const ImGuiIO& io = ImGui::GetIO();
    if (io.WantTextInput) return;
    for (const Shortcut& shortcut : shortcuts()) {
        if (shortcut.control != io.KeyCtrl) continue;
        if (ImGui::IsKeyPressed(static_cast<int>(shortcut.key), false))
            run_command(shortcut.command);
    }
}

void FrameLoop::run_command(ViewerCommand command) {
    float& exposure = model_.display.exposure_ev;
    switch (command) {
        case ViewerCommand::toggle_pause:
            model_.paused = !model_.paused;
            edits_.paused = true;
            break;
        case ViewerCommand::restart:
            edits_.restart = true;
            break;
        case ViewerCommand::frame_all:
            edits_.camera |= frame_all(model_);
            break;
        case ViewerCommand::frame_selected:
            edits_.camera |= frame_selected(model_);
            break;
        case ViewerCommand::next_camera: {
            const std::size_t count = model_.scene ? model_.scene->cameras().size() : 0;
            if (count == 0) break;
            edits_.camera |= use_file_camera(model_, (model_.camera + 1) % static_cast<int>(count));
            break;
        }
        case ViewerCommand::clear_selection:
            if (model_.look.show_help)
                model_.look.show_help = false;
            else
                select_object(model_, std::nullopt, std::nullopt, edits_);
            break;
        case ViewerCommand::exposure_down:
            exposure -= kExposureStep;
            break;
        case ViewerCommand::exposure_up:
            exposure += kExposureStep;
            break;
        case ViewerCommand::exposure_reset:
            exposure = 0;
            break;
        case ViewerCommand::next_tone_map:
            model_.display.tone_map = static_cast<ToneMap>(
                (static_cast<std::size_t>(model_.display.tone_map) + 1) % kToneMaps.size());
            break;
        case ViewerCommand::toggle_panels:
            model_.look.show_panels = !model_.look.show_panels;
            break;
        case ViewerCommand::toggle_help:
            model_.look.show_help = !model_.look.show_help;
            break;
        case ViewerCommand::open_file:
            model_.look.show_panels = true;
            form_.focus_open_path = true;
            break;
        case ViewerCommand::save_png:
            save_file(form_.save_path.ends_with(".png") ? form_.save_path : "talbot.png");
            break;
        case ViewerCommand::save_exr:
            save_file(form_.save_path.ends_with(".exr") ? form_.save_path : "talbot.exr");
            break;
        case ViewerCommand::quit:
            quit_ = true;
            break;
    }
    settle_frames_ = kSettleFrames;
}

std::optional<Pick> FrameLoop::pick_at(const Vec2f& position) const {
    if (!snapshot_ || !snapshot_->scene || !image_rect_.contains(position.x, position.y))
        return std::nullopt;
    const float u =
        (position.x - static_cast<float>(image_rect_.x)) / static_cast<float>(image_rect_.width);
    const float v =
        (position.y - static_cast<float>(image_rect_.y)) / static_cast<float>(image_rect_.height);
    const uint32_t width = snapshot_->full_width;
    const uint32_t height = snapshot_->full_height;
    return pick(*snapshot_->scene, snapshot_->camera, width, height, u * static_cast<float>(width),
                v * static_cast<float>(height));
}

void FrameLoop::select_at(const Vec2f& position) {
    const std::optional<Pick> hit = pick_at(position);
    if (hit) {
        select_object(model_, hit->object, hit->material, edits_);
    } else {
        select_object(model_, std::nullopt, std::nullopt, edits_);
    }
}

void FrameLoop::open_file(const std::string& file) {
    opened_at_ = 0;
    if (is_environment_file(file)) {
        jobs_.load_environment(file);
    } else {
        opened_at_ = now_seconds();
        // The scene on show makes room: loading gets the cores.
        session_.submit(SetPaused{true});
        jobs_.load_scene(file, options_.loader);
    }
}

void FrameLoop::save_file(const std::string& file) {
    if (!snapshot_ || !snapshot_->image) {
        notify("There is no image to save yet.", true);
        return;
    }
    jobs_.save(file, snapshot_->image, model_.display);
}

void FrameLoop::finish_jobs() {
    while (std::optional<BackgroundJobs::Outcome> outcome = jobs_.poll()) {
        settle_frames_ = kSettleFrames;
        if (!jobs_.busy()) session_.submit(SetPaused{model_.paused});
        if (auto* scene = std::get_if<LoadedScene>(&*outcome)) {
            show(scene->scene, scene->camera);
        } else if (auto* image = std::get_if<std::shared_ptr<const EnvironmentImage>>(&*outcome)) {
            model_.environment.image = *image;
            edits_.environment = true;
        } else if (const auto* saved = std::get_if<SavedFile>(&*outcome)) {
            notify("Saved " + saved->file.string(), false);
        } else if (const auto* error = std::get_if<Error>(&*outcome)) {
            if (error->kind != ErrorKind::cancelled) notify(error->line(), true);
        }
    }
}

// The image takes the size of its part of the window, once that has rested.
void FrameLoop::follow_window(double now) {
    if (!model_.look.fit_window) {
        wanted_size_ = {};
        return;
    }
    const PixelRect area = image_area(context_.size(), scale_, model_.look.show_panels);
    const PixelSize current{static_cast<int>(model_.settings.width),
                            static_cast<int>(model_.settings.height)};
    const PixelSize wanted{area.width, area.height};
    if (wanted == current) {
        wanted_size_ = {};
        return;
    }
    if (wanted != wanted_size_) {
        wanted_size_ = wanted;
        wanted_since_ = now;
    }
    if (snapshot_ && now - wanted_since_ < kResizeRest) return;
    model_.settings.width = static_cast<uint32_t>(wanted.width);
    model_.settings.height = static_cast<uint32_t>(wanted.height);
    edits_.settings = true;
    wanted_size_ = {};
}

void FrameLoop::submit_changes(double input_time) {
    // The error is that of the image as it is exposed.
    if (model_.scene && model_.display.exposure_ev != error_exposure_) {
        error_exposure_ = model_.display.exposure_ev;
        session_.submit(SetErrorExposure{error_exposure_});
    }
    if (!edits_.any()) return;
    if (!model_.scene) return;
    for (Change& change : take_changes(model_, edits_)) {
        ChangeKind kind;
        const bool shows = change_kind(change, kind);
        generation_ = session_.submit(std::move(change));
        if (!shows) continue;
        const bool opened = kind == ChangeKind::scene && opened_at_ > 0;
        recorder_.submitted(generation_, kind, opened ? opened_at_ : input_time);
        if (opened) opened_at_ = 0;
        latch_until_ = input_time + kLatchSeconds;
    }
}

void FrameLoop::draw_and_present() {
    const std::shared_ptr<const Snapshot> latest = session_.latest();
    if (latest != snapshot_) {
        snapshot_ = latest;
        settle_frames_ = std::max(settle_frames_, 1);
    }
    if (snapshot_) display_.update(*snapshot_);

    const double start = now_seconds();
    const GlFunctions& gl = context_.gl();
    const PixelSize size = context_.size();
    context_.bind_framebuffer();
    gl.ClearColor(0.075f, 0.075f, 0.08f, 1);
    gl.Clear(GL_COLOR_BUFFER_BIT);
    DisplayOverlay overlay;
    overlay.selected_object = model_.selected_object;
    overlay.false_color = model_.look.false_color;
    overlay.scale = scale_;
    display_.draw(image_rect_, size, model_.display, overlay);
    panels_.draw(*ImGui::GetDrawData(), size);
    context_.present();
    gl_seconds_ += now_seconds() - start;
}

void FrameLoop::notify(std::string text, bool is_error) {
    notice_ = std::move(text);
    notice_is_error_ = is_error;
    notice_until_ = now_seconds() + kNoticeSeconds;
}

}  // namespace talbot
