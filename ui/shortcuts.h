// What keys do outside of text boxes. The help overlay is made from the same table.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "ui/input.h"

namespace talbot {

enum class ViewerCommand : uint8_t {
    toggle_pause,
    restart,
    toggle_animation,
    frame_all,
    frame_selected,
    next_camera,
    clear_selection,
    exposure_down,
    exposure_up,
    exposure_reset,
    next_tone_map,
    toggle_panels,
    toggle_help,
    open_file,
    save_png,
    save_exr,
    quit,
};

struct Shortcut {
    ViewerCommand command;
    Key key;
    bool control = false;
    std::string_view keys;  // as shown
    std::string_view text;
};
std::span<const Shortcut> shortcuts();

// Lines of the help that are not single keys: the mouse, flying.
struct HelpLine {
    std::string_view keys;
    std::string_view text;
};
std::span<const HelpLine> navigation_help();

}  // namespace talbot
