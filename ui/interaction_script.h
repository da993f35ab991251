// Interaction scripts: one JSON object a line, each a step of what a user does. docs/interaction.md
// describes them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.h"
#include "core/scene/effects.h"
#include "ui/input.h"
#include "ui/parameters.h"

namespace talbot {

enum class ScriptAction : uint8_t {
    orbit,  // drag over the image with the left button
    pan,    // with the middle button
    look,   // with the right button
    dolly,  // turn the wheel
    drag,   // press anywhere, move, let go
    click,
    move,        // the pointer
    key,         // press, hold, let go
    text,        // type
    set,         // a parameter at once
    sweep,       // a parameter frame by frame
    resize,      // the window
    open,        // a file, as by dropping it
    save,        // the image
    screenshot,  // the window
    wait,
    idle,     // wait and record samples/s
    measure,  // forget what was recorded so far
    random,   // many random edits, moves and resizes
    expect,   // fail unless a parameter has a value or an object is selected
};

// A step; which fields count depends on the action.
struct ScriptStep {
    ScriptAction action = ScriptAction::wait;
    std::size_t line = 0;  // in the script, from 1
    double x = 0, y = 0;   // pixels of the image, or of the window
    bool in_window = false;
    double dx = 0, dy = 0;  // pixels
    double notches = 0;
    unsigned frames = 1;
    MouseButton button = MouseButton::left;
    bool double_click = false;
    Key key = Key::space;
    std::vector<Key> modifiers;
    std::string text;                     // typed text, or a choice's name
    std::optional<std::string> selected;  // the expected object's name; empty for none
    std::optional<std::string> notice;    // a part of the expected message
    std::optional<std::string> kernel;    // of the image on show
    std::optional<Effect> effect;         // that the image on show has, or has not
    bool effect_absent = false;
    std::string path;           // of a parameter
    std::vector<double> value;  // one number or one per component; empty when text names a choice
    std::vector<double> to;     // where a sweep ends
    double tolerance = 0;
    uint32_t width = 0, height = 0;
    std::string file;
    std::optional<uint64_t> passes;
    std::optional<double> seconds;
    bool jobs = false;    // wait for loading and saving
    double timeout = 60;  // seconds
    uint32_t count = 0;
    uint64_t seed = 0;
};

// Empty lines and lines that start with # are skipped. A line that is not understood is a usage
// error that names file, line and key.
Result<std::vector<ScriptStep>> parse_script(std::string_view text, const std::string& file);
Result<std::vector<ScriptStep>> load_script(const std::filesystem::path& file);

std::string_view action_name(ScriptAction action);

// The value for a parameter of this kind: numbers as they are, one number for every component of a
// vector or colour, or a choice's name.
Result<ParameterValue> script_value(const ParameterInfo& info, const std::vector<double>& numbers,
                                    const std::string& text);

}  // namespace talbot
