#include "ui/frame_loop.h"

#include <imgui.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "ui/path_overlay.h"
#include "ui/style.h"
#include "ui/viewport.h"

namespace talbot {
namespace {

constexpr int kSettleFrames = 3;
// The window's size must rest this long before the image follows.
constexpr double kResizeRest = 0.12;
// A frame is put off this long for the image that its own change asked for.
constexpr double kLatchSeconds = 0.03;
constexpr double kNoticeSeconds = 6;
constexpr double kProgressSeconds = 0.1;

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
      panels_(context.gl()),
      ab_(context.gl()) {
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
    if (Status loaded = ab_.load(); !loaded) return loaded;
    last_step_ = now_seconds();
    return Done{};
}

void FrameLoop::show(LoadedScene loaded) {
    show_scene(model_, std::move(loaded), edits_);
}

bool FrameLoop::needs_frame() const {
    if (settle_frames_ > 0 || !input_.empty() || edits_.any() || jobs_.has_outcome()) return true;
    // Progress and notices change slowly; a frame costs what their work could use.
    if ((jobs_.busy() || !notice_.empty()) && now_seconds() - last_step_ >= kProgressSeconds)
        return true;
    if (session_.latest() != snapshot_) return true;
    if (ab_.is_running() && ab_.latest() != shown_ab_) return true;
    if (model_.playing || model_.choice != model_.shown_choice) return true;
    if (wanted_size_ != PixelSize{}) return true;
    const ImGuiIO& io = ImGui::GetIO();
    // Held keys fly, held buttons drag, a text box's cursor blinks.
    return io.WantTextInput ||
           std::any_of(std::begin(io.KeysDown), std::end(io.KeysDown), [](bool b) { return b; }) ||
           std::any_of(std::begin(io.MouseDown), std::end(io.MouseDown), [](bool b) { return b; });
}

void FrameLoop::settle() {
    settle_frames_ = kSettleFrames;
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
    advance_animation(model_, start - last_step_);
    follow_choice(start);
    follow_window(start);
    follow_target();
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
        PanelView view;
        view.snapshot = snapshot_.get();
        view.threads = session_.threads();
        view.status.busy = jobs_.status();
        view.reading = pixel_under_pointer();
        view.path = path_ ? &*path_ : nullptr;
        view.diagnosis = diagnosis_;
        const std::shared_ptr<const AbSnapshot> ab = ab_.latest();
        view.ab = ab.get();
        view.comparing = ab_.is_running();
        PanelRequests requests;
        draw_panels(size, scale_, model_, edits_, view, form_, requests);
        grant(requests);
    }
    ab_.draw_line(model_, image_rect_);
    boxes_.draw(model_, image_rect_);
    if (path_) draw_path(*path_, model_, image_rect_);
    if (model_.look.show_help) model_.look.show_help = draw_help_overlay();
    if (!notice_.empty()) {
        draw_notice(area_, notice_, notice_is_error_);
        if (now_seconds() > notice_until_) notice_.clear();
    }
    run_shortcuts();
    ImGui::Render();
}

void FrameLoop::grant(const PanelRequests& requests) {
    if (requests.file.open) open_file(*requests.file.open);
    if (requests.file.save) save_file(*requests.file.save);
    if (requests.retrace && snapshot_) jobs_.retrace(snapshot_, *requests.retrace);
    if (requests.hide_path) path_.reset();
    follow_comparison(requests.ab);
    if (requests.diagnosis.bias && snapshot_) {
        diagnosis_.measuring_bias = true;
        jobs_.measure_bias(snapshot_, model_.display.exposure_ev);
    }
    if (requests.diagnosis.shares && snapshot_) {
        diagnosis_.measuring_shares = true;
        jobs_.measure_error_shares(snapshot_, model_.display.exposure_ev);
    }
}

std::optional<PixelReading> FrameLoop::pixel_under_pointer() const {
    const ImVec2 at = ImGui::GetIO().MousePos;
    if (!snapshot_ || !image_rect_.contains(at.x, at.y)) return std::nullopt;
    const float u =
        (at.x - static_cast<float>(image_rect_.x)) / static_cast<float>(image_rect_.width);
    const float v =
        (at.y - static_cast<float>(image_rect_.y)) / static_cast<float>(image_rect_.height);
    return read_pixel(*snapshot_, static_cast<double>(u), static_cast<double>(v));
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
        if (auto* reread = std::get_if<RereadScene>(&*outcome)) {
            const bool same_scene = reread->loaded.choice.scene == model_.shown_choice.scene;
            if (same_scene)
                replace_scene(model_, std::move(reread->loaded), edits_);
            else
                show(std::move(reread->loaded));
            continue;
        }
        if (!jobs_.busy()) session_.submit(SetPaused{model_.paused});
        if (auto* scene = std::get_if<LoadedScene>(&*outcome)) {
            show(std::move(*scene));
        } else if (auto* image = std::get_if<std::shared_ptr<const EnvironmentImage>>(&*outcome)) {
            model_.environment.image = *image;
            edits_.environment = true;
        } else if (auto* path = std::get_if<ReplayedPath>(&*outcome)) {
            path_ = std::move(*path);
        } else if (auto* bias = std::get_if<std::vector<BiasEntry>>(&*outcome)) {
            diagnosis_.measuring_bias = false;
            diagnosis_.bias = std::move(*bias);
        } else if (auto* shares = std::get_if<ErrorShares>(&*outcome)) {
            diagnosis_.measuring_shares = false;
            diagnosis_.shares = std::move(*shares);
        } else if (const auto* saved = std::get_if<SavedFile>(&*outcome)) {
            notify("Saved " + saved->file.string(), false);
        } else if (const auto* error = std::get_if<Error>(&*outcome)) {
            if (error->kind == ErrorKind::cancelled) continue;
            notify(error->line(), true);
            // What could not be read is not tried again.
            model_.choice = model_.shown_choice;
            model_.playing = false;
        }
    }
}

// Another variant or moment is read when the last one has been shown, so that a drag over the time
// shows every scene that it makes.
void FrameLoop::follow_choice(double now) {
    if (model_.choice == model_.shown_choice || !model_.file) return;
    if (chosen_at_ == 0) chosen_at_ = now;
    if (jobs_.loading() || edits_.any()) return;
    if (snapshot_ && snapshot_->generation < generation_) return;
    jobs_.reread_scene(model_.file, model_.choice, model_.environment, model_.scene);
}

// Rendering rests once for an image whose error is below the target.
void FrameLoop::follow_target() {
    if (!model_.look.stop_at_target || model_.paused || !snapshot_ || snapshot_->preview) return;
    if (snapshot_->generation < generation_ || target_met_by_ == image_generation_) return;
    const ErrorEstimate& error = snapshot_->error;
    if (!error.meets(model_.look.target_error_percent)) return;
    if (error.trust == Trust::red) return;
    target_met_by_ = image_generation_;
    model_.paused = true;
    edits_.paused = true;
    notify("The target error is reached; rendering rests.", false);
}

// While two settings are compared, the render rests, and the image shows both.
void FrameLoop::follow_comparison(const AbRequest& request) {
    if (request.start && snapshot_) ab_.start(model_, *snapshot_, session_.threads());
    if (request.stop) ab_.stop();
    if (request.close) ab_.close();
    if (ab_.is_running() == comparing_) return;
    comparing_ = ab_.is_running();
    session_.submit(SetPaused{comparing_ || model_.paused});
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
        image_generation_ = generation_;
        if (kind == ChangeKind::scene || kind == ChangeKind::animation) path_.reset();
        ab_.close();
        diagnosis_.bias.reset();
        diagnosis_.shares.reset();
        double asked_at = input_time;
        if (kind == ChangeKind::scene && opened_at_ > 0) asked_at = std::exchange(opened_at_, 0);
        if (kind == ChangeKind::animation && chosen_at_ > 0)
            asked_at = std::exchange(chosen_at_, 0);
        recorder_.submitted(generation_, kind, asked_at);
        latch_until_ = input_time + kLatchSeconds;
    }
}

void FrameLoop::draw_and_present() {
    const std::shared_ptr<const Snapshot> latest = session_.latest();
    if (latest != snapshot_) {
        snapshot_ = latest;
        settle_frames_ = std::max(settle_frames_, 1);
    }
    DisplayOverlay overlay;
    shown_ab_ = ab_.latest();
    const AovImage* aov = snapshot_ && !shown_ab_ ? snapshot_->aov.get() : nullptr;
    if (aov && aov->aov == model_.look.aov) {
        display_.update(std::shared_ptr<const ImageRgba>(snapshot_->aov, &aov->image),
                        snapshot_->object_ids, snapshot_->full_width, snapshot_->full_height);
        overlay.look = aov_info(aov->aov).look;
        overlay.range_lower = aov->lower;
        overlay.range_upper = aov->upper;
    } else if (snapshot_ && !shown_ab_) {
        display_.update(*snapshot_);
    }

    const double start = now_seconds();
    const GlFunctions& gl = context_.gl();
    const PixelSize size = context_.size();
    context_.bind_framebuffer();
    gl.ClearColor(0.075f, 0.075f, 0.08f, 1);
    gl.Clear(GL_COLOR_BUFFER_BIT);
    overlay.selected_object = model_.selected_object;
    overlay.false_color = model_.look.false_color;
    overlay.scale = scale_;
    if (!ab_.draw(gl, display_, image_rect_, size, model_, overlay))
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
