// What a user does, as values: from the window system or from a script, the frame loop sees no
// difference. Positions are in framebuffer pixels from the top left corner.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ui/gl_context.h"

namespace talbot {

// Physical keys; the values are GLFW's.
enum class Key : int {
    space = 32,
    comma = 44,
    minus = 45,
    period = 46,
    slash = 47,
    digit_0 = 48,
    equal = 61,
    a = 65,
    left_bracket = 91,
    right_bracket = 93,
    escape = 256,
    enter = 257,
    tab = 258,
    backspace = 259,
    insert = 260,
    del = 261,
    right = 262,
    left = 263,
    down = 264,
    up = 265,
    page_up = 266,
    page_down = 267,
    home = 268,
    end = 269,
    f1 = 290,
    keypad_enter = 335,
    left_shift = 340,
    left_control = 341,
    left_alt = 342,
    right_shift = 344,
    right_control = 345,
    right_alt = 346,
};
inline constexpr int kKeyLimit = 512;

// The key of a letter 'a'..'z' or a digit.
constexpr Key key_of(char c) {
    return static_cast<Key>(c >= '0' && c <= '9' ? c : c - 'a' + static_cast<int>(Key::a));
}

// "w", "7", "space", "home", "f1", "[", "left_control" and so on; also what scripts write.
std::optional<Key> key_from_name(std::string_view name);

enum class MouseButton : uint8_t { left, right, middle };

struct InputEvent {
    enum class Kind : uint8_t { pointer, button, wheel, key, character, drop, focus_lost, close };
    Kind kind = Kind::pointer;
    float x = 0;  // pointer: position; wheel: notches to the right
    float y = 0;  // pointer: position; wheel: notches away from the user
    MouseButton button = MouseButton::left;
    Key key = Key::space;
    bool pressed = false;
    uint32_t codepoint = 0;
    std::vector<std::string> files;  // drop

    static InputEvent pointer_at(float px, float py);
    static InputEvent button_at(MouseButton which, bool down);
    static InputEvent wheel_by(float dx, float dy);
    static InputEvent key_at(Key which, bool down);
    static InputEvent character_of(uint32_t unicode);
};

// The events of one frame, taken from a queue so that no press and release of one button or key
// fall into the same frame: both would be lost on widgets that look at states.
class InputQueue {
  public:
    void push(InputEvent event) { events_.push_back(std::move(event)); }
    bool empty() const { return events_.empty(); }
    std::vector<InputEvent> take_frame();

  private:
    std::deque<InputEvent> events_;
};

// Passes an event on to the current ImGui context.
void feed_panels(const InputEvent& event);

// Tells the current ImGui context which keys are which.
void set_up_panel_keys();

}  // namespace talbot
