#include "app/interaction_runner.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "core/io/image_io.h"

namespace talbot {
namespace {

constexpr double kFrameSeconds = 1.0 / 60;
// A new snapshot is shown at once, but not closer than this to the last frame.
constexpr double kShortestFrameSeconds = 1.0 / 125;

double uniform(std::mt19937_64& random, double lower, double upper) {
    return std::uniform_real_distribution<double>(lower, upper)(random);
}

uint32_t below(std::mt19937_64& random, std::size_t count) {
    return static_cast<uint32_t>(std::uniform_int_distribution<std::size_t>(0, count - 1)(random));
}

}  // namespace

InteractionRunner::InteractionRunner(GlContext& context, FrameLoop& loop)
    : context_(context), loop_(loop), next_frame_(now_seconds()) {}

void InteractionRunner::wake() {
    {
        const std::lock_guard lock(mutex_);
        has_news_ = true;
    }
    woken_.notify_all();
}

// Waits for the next beat of the screen, showing new snapshots on the way, then steps.
void InteractionRunner::frame() {
    double last = now_seconds();
    next_frame_ = std::max(next_frame_ + kFrameSeconds, last);
    for (;;) {
        const double now = now_seconds();
        if (now >= next_frame_) break;
        bool news = false;
        {
            std::unique_lock lock(mutex_);
            woken_.wait_for(lock, std::chrono::duration<double>(next_frame_ - now),
                            [&] { return has_news_; });
            news = std::exchange(has_news_, false);
        }
        if (!news || !loop_.input().empty()) continue;
        if (now_seconds() - last < kShortestFrameSeconds) continue;
        loop_.step();
        note_frame();
        last = now_seconds();
    }
    if (!loop_.needs_frame()) return;
    loop_.update();
    for (double delay = loop_.draw_delay(); delay > 0; delay = loop_.draw_delay()) {
        std::unique_lock lock(mutex_);
        woken_.wait_for(lock, std::chrono::duration<double>(delay), [&] { return has_news_; });
        has_news_ = false;
    }
    loop_.draw();
    note_frame();
}

void InteractionRunner::note_frame() {
    ++frames_;
    const Snapshot* snapshot = loop_.snapshot();
    if (!snapshot || snapshot->kernel.empty()) return;
    const EffectSet effects = snapshot->effects.active;
    if (!kernels_.empty() && kernels_.back().kernel == snapshot->kernel &&
        kernels_.back().effects == effects)
        return;
    kernels_.push_back({frames_, snapshot->kernel, effects});
}

bool InteractionRunner::wait_until(const ScriptStep& step, const std::function<bool()>& reached) {
    const double end = now_seconds() + step.timeout;
    while (!reached()) {
        if (now_seconds() > end) return false;
        frame();
    }
    return true;
}

Vec2f InteractionRunner::position_of(double x, double y, bool in_window) const {
    if (in_window) return Vec2f(static_cast<float>(x), static_cast<float>(y));
    const PixelRect rect = loop_.image_rect();
    const Snapshot* snapshot = loop_.snapshot();
    const double width = snapshot ? snapshot->full_width : rect.width;
    const double height = snapshot ? snapshot->full_height : rect.height;
    return Vec2f(static_cast<float>(rect.x + x * rect.width / width),
                 static_cast<float>(rect.y + y * rect.height / height));
}

void InteractionRunner::press_modifiers(const ScriptStep& step, bool down) {
    for (const Key key : step.modifiers) loop_.input().push(InputEvent::key_at(key, down));
}

void InteractionRunner::drag(Vec2f from, Vec2f by, const ScriptStep& step) {
    InputQueue& input = loop_.input();
    press_modifiers(step, true);
    input.push(InputEvent::pointer_at(from.x, from.y));
    frame();
    input.push(InputEvent::button_at(step.button, true));
    frame();
    for (unsigned i = 1; i <= step.frames; ++i) {
        const float t = static_cast<float>(i) / static_cast<float>(step.frames);
        input.push(InputEvent::pointer_at(from.x + t * by.x, from.y + t * by.y));
        frame();
    }
    input.push(InputEvent::button_at(step.button, false));
    press_modifiers(step, false);
    frame();
}

void InteractionRunner::click(const ScriptStep& step) {
    InputQueue& input = loop_.input();
    const Vec2f at = position_of(step.x, step.y, step.in_window);
    press_modifiers(step, true);
    input.push(InputEvent::pointer_at(at.x, at.y));
    frame();
    for (int i = 0; i < (step.double_click ? 2 : 1); ++i) {
        input.push(InputEvent::button_at(step.button, true));
        frame();
        input.push(InputEvent::button_at(step.button, false));
        frame();
    }
    press_modifiers(step, false);
    frame();
}

void InteractionRunner::press_key(const ScriptStep& step) {
    press_modifiers(step, true);
    loop_.input().push(InputEvent::key_at(step.key, true));
    for (unsigned i = 0; i < step.frames; ++i) frame();
    loop_.input().push(InputEvent::key_at(step.key, false));
    press_modifiers(step, false);
    frame();
}

void InteractionRunner::type(const std::string& text) {
    for (const char c : text) {
        loop_.input().push(InputEvent::character_of(static_cast<unsigned char>(c)));
    }
    frame();
}

std::string InteractionRunner::set_value(const std::string& path,
                                         const std::vector<double>& numbers,
                                         const std::string& text) {
    const Result<ParameterInfo> info = parameter_info(loop_.model(), path);
    if (!info) return info.error().line();
    const Result<ParameterValue> value = script_value(*info, numbers, text);
    if (!value) return value.error().line();
    const Status set = set_parameter(loop_.model(), loop_.edits(), path, *value);
    if (!set) return set.error().line();
    loop_.redraw();
    frame();
    return {};
}

std::string InteractionRunner::sweep(const ScriptStep& step) {
    for (unsigned i = 1; i <= step.frames; ++i) {
        const double t = static_cast<double>(i) / step.frames;
        std::vector<double> value;
        for (std::size_t k = 0; k < step.value.size(); ++k) {
            value.push_back(step.value[k] + t * (step.to[k] - step.value[k]));
        }
        if (std::string failure = set_value(step.path, value, {}); !failure.empty()) return failure;
    }
    return {};
}

std::string InteractionRunner::wait(const ScriptStep& step) {
    if (step.seconds) {
        const double end = now_seconds() + *step.seconds;
        while (now_seconds() < end) frame();
    } else if (step.passes) {
        const auto reached = [&] {
            const Snapshot* shown = loop_.snapshot();
            return shown && shown->generation >= loop_.submitted_generation() &&
                   !loop_.edits().any() && !shown->preview && shown->passes >= *step.passes;
        };
        frame();
        if (!wait_until(step, reached)) return "the passes did not come within the timeout";
    } else if (step.jobs) {
        if (!wait_until(step, [&] { return !loop_.jobs().busy(); }))
            return "the jobs did not end within the timeout";
    } else {
        for (unsigned i = 0; i < step.frames; ++i) frame();
    }
    return {};
}

std::string InteractionRunner::save(const ScriptStep& step) {
    loop_.save_file(step.file);
    if (!wait_until(step, [&] { return !loop_.jobs().busy(); }))
        return "saving did not end within the timeout";
    frame();
    if (!loop_.notice().starts_with("Saved")) return loop_.notice();
    return {};
}

std::string InteractionRunner::screenshot(const ScriptStep& step) {
    for (int i = 0; i < 3; ++i) loop_.step();
    const Status saved = save_png(step.file, context_.read_pixels());
    return saved ? std::string() : saved.error().line();
}

std::string InteractionRunner::expect(const ScriptStep& step) {
    const ViewerModel& model = loop_.model();
    if (step.selected) {
        std::string name;
        if (model.selected_object && model.scene)
            name = model.scene->objects()[*model.selected_object].name;
        if (name != *step.selected) {
            return "the selected object is '" + name + "', not '" + *step.selected + "'";
        }
    }
    if (step.notice && loop_.notice().find(*step.notice) == std::string::npos) {
        return "the message is '" + loop_.notice() + "', not '" + *step.notice + "'";
    }
    const Snapshot* snapshot = loop_.snapshot();
    if ((step.kernel || step.effect) && !snapshot) return "there is no image yet";
    if (step.kernel && snapshot->kernel != *step.kernel)
        return "the kernel is '" + snapshot->kernel + "', not '" + *step.kernel + "'";
    if (step.effect && snapshot->effects.active.has(*step.effect) == step.effect_absent) {
        return "the effect " + std::string(effect_info(*step.effect).name) +
               (step.effect_absent ? " is in use" : " is not in use");
    }
    if (step.path.empty()) return {};
    const Result<ParameterInfo> info = parameter_info(model, step.path);
    if (!info) return info.error().line();
    const Result<ParameterValue> wanted = script_value(*info, step.value, step.text);
    if (!wanted) return wanted.error().line();
    const Result<ParameterValue> value = read_parameter(model, step.path);
    for (int i = 0; i < component_count(info->kind); ++i) {
        const std::size_t k = static_cast<std::size_t>(i);
        if ((*value)[k] == (*wanted)[k] || std::abs((*value)[k] - (*wanted)[k]) <= step.tolerance)
            continue;
        return step.path + " is " + std::to_string((*value)[k]) + ", not " +
               std::to_string((*wanted)[k]);
    }
    return {};
}

void InteractionRunner::idle(double seconds) {
    const auto samples = [&] { return loop_.snapshot() ? loop_.snapshot()->samples : 0; };
    const uint64_t before = samples();
    const double start = now_seconds();
    while (now_seconds() - start < seconds) frame();
    const double passed = now_seconds() - start;
    const uint64_t after = samples();
    idle_.push_back({passed, after > before ? static_cast<double>(after - before) / passed : 0.0});
}

// One random edit of any parameter that exists; sizes and counts stay small.
void InteractionRunner::random_edit(std::mt19937_64& random) {
    const std::vector<std::string> paths = parameter_paths(loop_.model());
    const std::string& path = paths[below(random, paths.size())];
    const Result<ParameterInfo> info = parameter_info(loop_.model(), path);
    double lower = std::max(info->slider_lower, info->lower);
    double upper = std::min(info->slider_upper, info->upper);
    if (path == "render.width" || path == "render.height") {
        lower = 1;
        upper = 512;
    }
    if (info->kind == ParameterKind::choice) upper = static_cast<double>(info->choices.size());
    ParameterValue value{};
    for (double& v : value) v = uniform(random, lower, upper);
    if (info->kind == ParameterKind::flag) value[0] = below(random, 2);
    (void)set_parameter(loop_.model(), loop_.edits(), path, value);
    frame();
}

void InteractionRunner::randomly(const ScriptStep& step) {
    std::mt19937_64 random(step.seed);
    for (uint32_t i = 0; i < step.count; ++i) {
        ScriptStep move;
        const PixelSize size = context_.size();
        move.in_window = true;
        // Not on the left column, where buttons write files.
        move.x = uniform(random, 0.35 * size.width, size.width);
        move.y = uniform(random, 0, size.height);
        switch (below(random, 8)) {
            case 0:
                move.button = static_cast<MouseButton>(below(random, 3));
                move.frames = 1 + below(random, 4);
                drag(position_of(move.x, move.y, true),
                     Vec2f(static_cast<float>(uniform(random, -300, 300)),
                           static_cast<float>(uniform(random, -300, 300))),
                     move);
                break;
            case 1:
                move.double_click = below(random, 4) == 0;
                click(move);
                break;
            case 2:
                loop_.input().push(
                    InputEvent::wheel_by(0, static_cast<float>(uniform(random, -3, 3))));
                frame();
                break;
            case 3: {
                constexpr char kKeys[] = "wasdqefrct";
                move.key = key_of(kKeys[below(random, sizeof kKeys - 1)]);
                move.frames = 1 + below(random, 3);
                press_key(move);
                break;
            }
            case 4:
                context_.resize({static_cast<int>(400 + below(random, 800)),
                                 static_cast<int>(300 + below(random, 500))});
                frame();
                break;
            default:
                random_edit(random);
                break;
        }
    }
    // Whatever was pressed on the way is let go, and the session goes on.
    loop_.model().paused = false;
    loop_.edits().paused = true;
    frame();
}

std::string InteractionRunner::carry_out(const ScriptStep& step) {
    const PixelRect rect = loop_.image_rect();
    const Vec2f centre(static_cast<float>(rect.x) + 0.5f * static_cast<float>(rect.width),
                       static_cast<float>(rect.y) + 0.5f * static_cast<float>(rect.height));
    const Vec2f by(static_cast<float>(step.dx), static_cast<float>(step.dy));
    ScriptStep with_button = step;
    switch (step.action) {
        case ScriptAction::orbit:
            drag(centre, by, with_button);
            break;
        case ScriptAction::pan:
            with_button.button = MouseButton::middle;
            drag(centre, by, with_button);
            break;
        case ScriptAction::look:
            with_button.button = MouseButton::right;
            drag(centre, by, with_button);
            break;
        case ScriptAction::drag:
            drag(position_of(step.x, step.y, step.in_window), by, step);
            break;
        case ScriptAction::dolly:
            loop_.input().push(InputEvent::pointer_at(centre.x, centre.y));
            for (unsigned i = 0; i < step.frames; ++i) {
                loop_.input().push(
                    InputEvent::wheel_by(0, static_cast<float>(step.notches / step.frames)));
                frame();
            }
            break;
        case ScriptAction::click:
            click(step);
            break;
        case ScriptAction::move: {
            const Vec2f at = position_of(step.x, step.y, step.in_window);
            loop_.input().push(InputEvent::pointer_at(at.x, at.y));
            frame();
            break;
        }
        case ScriptAction::key:
            press_key(step);
            break;
        case ScriptAction::text:
            type(step.text);
            break;
        case ScriptAction::set:
            return set_value(step.path, step.value, step.text);
        case ScriptAction::sweep:
            return sweep(step);
        case ScriptAction::resize:
            context_.resize({static_cast<int>(step.width), static_cast<int>(step.height)});
            frame();
            break;
        case ScriptAction::open: {
            InputEvent event;
            event.kind = InputEvent::Kind::drop;
            event.files = {step.file};
            loop_.input().push(event);
            frame();
            if (!wait_until(step, [&] { return !loop_.jobs().busy(); }))
                return "loading did not end within the timeout";
            frame();
            break;
        }
        case ScriptAction::save:
            return save(step);
        case ScriptAction::screenshot:
            return screenshot(step);
        case ScriptAction::wait:
            return wait(step);
        case ScriptAction::idle:
            idle(*step.seconds);
            break;
        case ScriptAction::measure:
            loop_.recorder() = LatencyRecorder();
            idle_.clear();
            break;
        case ScriptAction::random:
            randomly(step);
            break;
        case ScriptAction::expect:
            return expect(step);
    }
    return {};
}

Status InteractionRunner::run(const ScriptStep& step, const std::string& script) {
    const std::string failure = carry_out(step);
    if (failure.empty()) return Done{};
    return Error{ErrorKind::failed, script + ":" + std::to_string(step.line),
                 std::string(action_name(step.action)), failure};
}

}  // namespace talbot
