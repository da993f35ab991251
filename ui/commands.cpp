// What the keys of ui/shortcuts.h do.
#include <imgui.h>

#include "ui/frame_loop.h"

namespace talbot {
namespace {

constexpr float kExposureStep = 1.0f / 3.0f;

}  // namespace

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
        case ViewerCommand::toggle_animation:
            model_.playing = !model_.playing && model_.choices().last_key() > 0;
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
    settle();
}

}  // namespace talbot
