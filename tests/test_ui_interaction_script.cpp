// Interaction scripts: what is understood, and that what is not is named with file, line and key.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <iterator>

#include "ui/interaction_script.h"

namespace talbot {
namespace {

std::vector<ScriptStep> parse(const std::string& text) {
    Result<std::vector<ScriptStep>> steps = parse_script(text, "script");
    EXPECT_TRUE(steps.ok()) << (steps.ok() ? "" : steps.error().line());
    return steps.ok() ? *steps : std::vector<ScriptStep>();
}

TEST(InteractionScript, ReadsEveryAction) {
    const std::vector<ScriptStep> steps = parse(R"(# a comment

{"do": "orbit", "dx": 120, "dy": -40.5, "frames": 30}
{"do": "click", "x": 10, "y": 20, "button": "right", "in": "window", "modifiers": ["shift"]}
{"do": "key", "key": "home"}
{"do": "set", "path": "materials[3].roughness_factor", "value": 0.3}
{"do": "set", "path": "display.tone_map", "value": "agx"}
{"do": "sweep", "path": "camera.position", "from": [0, 1, 2], "to": [3, 4, 5], "frames": 10}
{"do": "wait", "passes": 4, "timeout": 5}
{"do": "expect", "selected": "Ball"}
)");
    ASSERT_EQ(steps.size(), 8u);
    EXPECT_EQ(steps[0].action, ScriptAction::orbit);
    EXPECT_EQ(steps[0].line, 3u);
    EXPECT_EQ(steps[0].dy, -40.5);
    EXPECT_EQ(steps[0].frames, 30u);
    EXPECT_EQ(steps[1].button, MouseButton::right);
    EXPECT_TRUE(steps[1].in_window);
    EXPECT_EQ(steps[1].modifiers, std::vector<Key>{Key::left_shift});
    EXPECT_EQ(steps[2].key, Key::home);
    EXPECT_EQ(steps[3].value, std::vector<double>{0.3});
    EXPECT_EQ(steps[4].text, "agx");
    EXPECT_EQ(steps[5].to.size(), 3u);
    EXPECT_EQ(steps[6].passes, 4u);
    EXPECT_EQ(steps[7].selected, "Ball");
}

struct BadLine {
    const char* line;
    const char* key;  // the element of the error
};

TEST(InteractionScript, NamesWhatIsWrong) {
    const BadLine lines[] = {
        {"orbit", ""},
        {"[1, 2]", ""},
        {"{\"do\": \"orbit\", ", ""},
        {"{}", "do"},
        {R"({"do": 3})", "do"},
        {R"({"do": "teleport"})", "do"},
        {R"({"do": "orbit", "dx": 1})", "dy"},
        {R"({"do": "orbit", "dx": "far", "dy": 1})", "dx"},
        {R"({"do": "orbit", "dx": 1, "dy": 1, "speed": 3})", "speed"},
        {R"({"do": "orbit", "dx": 1, "dy": 1, "frames": 0})", "frames"},
        {R"({"do": "orbit", "dx": 1, "dy": 1, "frames": 2.5})", "frames"},
        {R"({"do": "key", "key": "any"})", "key"},
        {R"({"do": "click", "x": 1, "y": 1, "button": "thumb"})", "button"},
        {R"({"do": "click", "x": 1, "y": 1, "in": "moon"})", "in"},
        {R"({"do": "click", "x": 1, "y": 1, "modifiers": "shift"})", "modifiers"},
        {R"({"do": "set", "path": "camera.yfov"})", "value"},
        {R"({"do": "set", "path": "camera.yfov", "value": null})", "value"},
        {R"({"do": "set", "path": "camera.yfov", "value": [1, "x"]})", "value"},
        {R"({"do": "sweep", "path": "camera.yfov", "from": 1, "to": [1, 2], "frames": 3})", "to"},
        {R"({"do": "resize", "width": 0, "height": 100})", "width"},
        {R"({"do": "resize", "width": 100000000, "height": 100})", "width"},
        {R"({"do": "wait", "passes": -1})", "passes"},
        {R"({"do": "idle"})", "seconds"},
        {R"({"do": "expect"})", ""},
        {R"({"do": "expect", "path": "camera.yfov"})", ""},
    };
    for (const BadLine& bad : lines) {
        const Result<std::vector<ScriptStep>> steps =
            parse_script(std::string("\n") + bad.line + "\n", "some.jsonl");
        ASSERT_FALSE(steps.ok()) << bad.line;
        EXPECT_EQ(steps.error().kind, ErrorKind::usage) << bad.line;
        EXPECT_EQ(steps.error().file, "some.jsonl:2") << bad.line;
        EXPECT_EQ(steps.error().element, bad.key) << bad.line;
        EXPECT_FALSE(steps.error().what.empty()) << bad.line;
    }
}

TEST(InteractionScript, MissingFileIsBadInput) {
    const Result<std::vector<ScriptStep>> steps = load_script("/nonexistent/script.jsonl");
    ASSERT_FALSE(steps.ok());
    EXPECT_EQ(steps.error().kind, ErrorKind::bad_input);
}

TEST(InteractionScript, ValuesFitTheirParameter) {
    ParameterInfo color;
    color.kind = ParameterKind::color;
    EXPECT_EQ((*script_value(color, {0.5}, ""))[2], 0.5);
    EXPECT_EQ((*script_value(color, {0.1, 0.2, 0.3}, ""))[1], 0.2);
    EXPECT_FALSE(script_value(color, {0.1, 0.2}, "").ok());
    color.kind = ParameterKind::color_alpha;
    EXPECT_EQ((*script_value(color, {0.1, 0.2, 0.3}, ""))[3], 1);
    const std::string_view names[] = {"sobol", "independent"};
    ParameterInfo choice;
    choice.kind = ParameterKind::choice;
    choice.choice_names = names;
    EXPECT_EQ((*script_value(choice, {}, "independent"))[0], 1);
    EXPECT_FALSE(script_value(choice, {}, "halton").ok());
}

TEST(InteractionScript, KeyNamesAreUnique) {
    EXPECT_EQ(key_from_name("w"), key_of('w'));
    EXPECT_EQ(key_from_name("f12"), static_cast<Key>(static_cast<int>(Key::f1) + 11));
    EXPECT_FALSE(key_from_name("f13").has_value());
    EXPECT_FALSE(key_from_name("fa").has_value());
    EXPECT_FALSE(key_from_name("W").has_value());
    EXPECT_FALSE(key_from_name("").has_value());
}

// The document lists every action.
TEST(InteractionScript, IsDocumented) {
    std::ifstream in(std::string(TALBOT_SOURCE_DIR) + "/docs/interaction.md");
    ASSERT_TRUE(in);
    const std::string text((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
    for (int i = 0; i <= static_cast<int>(ScriptAction::expect); ++i) {
        const std::string name(action_name(static_cast<ScriptAction>(i)));
        ASSERT_FALSE(name.empty());
        EXPECT_NE(text.find('`' + name + '`'), std::string::npos) << name;
    }
}

// A press and a release of one button never share a frame; the pointer moves on only afterwards.
TEST(InputQueue, SplitsClicksOverFrames) {
    InputQueue queue;
    queue.push(InputEvent::pointer_at(5, 5));
    queue.push(InputEvent::button_at(MouseButton::left, true));
    queue.push(InputEvent::button_at(MouseButton::left, false));
    queue.push(InputEvent::pointer_at(9, 9));
    EXPECT_EQ(queue.take_frame().size(), 2u);
    const std::vector<InputEvent> second = queue.take_frame();
    ASSERT_EQ(second.size(), 1u);
    EXPECT_FALSE(second[0].pressed);
    EXPECT_EQ(queue.take_frame().size(), 1u);
    EXPECT_TRUE(queue.empty());
}

// A chord that arrives at once is still a chord: its modifier is down in the frame of the press.
TEST(InputQueue, KeepsChordsTogether) {
    InputQueue queue;
    queue.push(InputEvent::key_at(Key::left_control, true));
    queue.push(InputEvent::key_at(key_of('s'), true));
    queue.push(InputEvent::key_at(Key::left_control, false));
    queue.push(InputEvent::key_at(key_of('s'), false));
    const std::vector<InputEvent> first = queue.take_frame();
    ASSERT_EQ(first.size(), 2u);
    EXPECT_TRUE(first[0].pressed && first[1].pressed);
    EXPECT_EQ(queue.take_frame().size(), 2u);
    EXPECT_TRUE(queue.empty());
}

}  // namespace
}  // namespace talbot
