#include "ui/input.h"

#include <imgui.h>

#include <array>
#include <set>
#include <utility>

namespace talbot {
namespace {

constexpr std::array<std::pair<std::string_view, Key>, 34> kKeyNames{{
    {"space", Key::space},
    {"comma", Key::comma},
    {",", Key::comma},
    {"minus", Key::minus},
    {"-", Key::minus},
    {"period", Key::period},
    {".", Key::period},
    {"slash", Key::slash},
    {"/", Key::slash},
    {"equal", Key::equal},
    {"=", Key::equal},
    {"[", Key::left_bracket},
    {"]", Key::right_bracket},
    {"escape", Key::escape},
    {"enter", Key::enter},
    {"tab", Key::tab},
    {"backspace", Key::backspace},
    {"insert", Key::insert},
    {"delete", Key::del},
    {"right", Key::right},
    {"left", Key::left},
    {"down", Key::down},
    {"up", Key::up},
    {"page_up", Key::page_up},
    {"page_down", Key::page_down},
    {"home", Key::home},
    {"end", Key::end},
    {"keypad_enter", Key::keypad_enter},
    {"shift", Key::left_shift},
    {"control", Key::left_control},
    {"alt", Key::left_alt},
    {"right_shift", Key::right_shift},
    {"right_control", Key::right_control},
    {"right_alt", Key::right_alt},
}};

}  // namespace

std::optional<Key> key_from_name(std::string_view name) {
    if (name.size() == 1) {
        const char c = name[0];
        if ((c >= 'a' && c <= 'z') || (c >= '0' && c <= '9')) return key_of(c);
    }
    if (name.size() >= 2 && name.size() <= 3 && name[0] == 'f') {
        int number = 0;
        for (const char c : name.substr(1)) {
            if (c < '0' || c > '9') return std::nullopt;
            number = 10 * number + (c - '0');
        }
        if (number < 1 || number > 12) return std::nullopt;
        return static_cast<Key>(static_cast<int>(Key::f1) + number - 1);
    }
    for (const auto& [text, key] : kKeyNames) {
        if (text == name) return key;
    }
    return std::nullopt;
}

InputEvent InputEvent::pointer_at(float px, float py) {
    InputEvent event;
    event.kind = Kind::pointer;
    event.x = px;
    event.y = py;
    return event;
}

InputEvent InputEvent::button_at(MouseButton which, bool down) {
    InputEvent event;
    event.kind = Kind::button;
    event.button = which;
    event.pressed = down;
    return event;
}

InputEvent InputEvent::wheel_by(float dx, float dy) {
    InputEvent event;
    event.kind = Kind::wheel;
    event.x = dx;
    event.y = dy;
    return event;
}

InputEvent InputEvent::key_at(Key which, bool down) {
    InputEvent event;
    event.kind = Kind::key;
    event.key = which;
    event.pressed = down;
    return event;
}

InputEvent InputEvent::character_of(uint32_t unicode) {
    InputEvent event;
    event.kind = Kind::character;
    event.codepoint = unicode;
    return event;
}

std::vector<InputEvent> InputQueue::take_frame() {
    std::vector<InputEvent> frame;
    std::set<std::pair<InputEvent::Kind, int>> changed;
    bool button_changed = false;
    bool pressed = false;
    while (!events_.empty()) {
        const InputEvent& event = events_.front();
        if (event.kind == InputEvent::Kind::button || event.kind == InputEvent::Kind::key) {
            const int code = event.kind == InputEvent::Kind::key ? static_cast<int>(event.key)
                                                                 : static_cast<int>(event.button);
            if (!changed.emplace(event.kind, code).second) break;
            // A modifier that is let go after a press still belongs to that press.
            if (pressed && !event.pressed) break;
            pressed |= event.pressed;
            button_changed |= event.kind == InputEvent::Kind::button;
        }
        // A move after a click belongs to the next frame: the click happened where the pointer was.
        if (event.kind == InputEvent::Kind::pointer && button_changed) break;
        frame.push_back(std::move(events_.front()));
        events_.pop_front();
    }
    return frame;
}

void feed_panels(const InputEvent& event) {
    ImGuiIO& io = ImGui::GetIO();
    switch (event.kind) {
        case InputEvent::Kind::pointer:
            io.MousePos = ImVec2(event.x, event.y);
            break;
        case InputEvent::Kind::button:
            io.MouseDown[static_cast<int>(event.button)] = event.pressed;
            break;
        case InputEvent::Kind::wheel:
            io.MouseWheelH += event.x;
            io.MouseWheel += event.y;
            break;
        case InputEvent::Kind::key: {
            const int code = static_cast<int>(event.key);
            if (code < 0 || code >= kKeyLimit) break;
            io.KeysDown[code] = event.pressed;
            const auto down = [&](Key key) { return io.KeysDown[static_cast<int>(key)]; };
            io.KeyCtrl = down(Key::left_control) || down(Key::right_control);
            io.KeyShift = down(Key::left_shift) || down(Key::right_shift);
            io.KeyAlt = down(Key::left_alt) || down(Key::right_alt);
            break;
        }
        case InputEvent::Kind::character:
            io.AddInputCharacter(event.codepoint);
            break;
        case InputEvent::Kind::focus_lost:
            io.ClearInputKeys();
            for (bool& down : io.MouseDown) down = false;
            break;
        case InputEvent::Kind::drop:
        case InputEvent::Kind::close:
            break;
    }
}

void set_up_panel_keys() {
    ImGuiIO& io = ImGui::GetIO();
    const auto map = [&](ImGuiKey key, Key own) { io.KeyMap[key] = static_cast<int>(own); };
    map(ImGuiKey_Tab, Key::tab);
    map(ImGuiKey_LeftArrow, Key::left);
    map(ImGuiKey_RightArrow, Key::right);
    map(ImGuiKey_UpArrow, Key::up);
    map(ImGuiKey_DownArrow, Key::down);
    map(ImGuiKey_PageUp, Key::page_up);
    map(ImGuiKey_PageDown, Key::page_down);
    map(ImGuiKey_Home, Key::home);
    map(ImGuiKey_End, Key::end);
    map(ImGuiKey_Insert, Key::insert);
    map(ImGuiKey_Delete, Key::del);
    map(ImGuiKey_Backspace, Key::backspace);
    map(ImGuiKey_Space, Key::space);
    map(ImGuiKey_Enter, Key::enter);
    map(ImGuiKey_Escape, Key::escape);
    map(ImGuiKey_KeyPadEnter, Key::keypad_enter);
    map(ImGuiKey_A, key_of('a'));
    map(ImGuiKey_C, key_of('c'));
    map(ImGuiKey_V, key_of('v'));
    map(ImGuiKey_X, key_of('x'));
    map(ImGuiKey_Y, key_of('y'));
    map(ImGuiKey_Z, key_of('z'));
}

}  // namespace talbot
