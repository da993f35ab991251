#include "ui/interaction_script.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "core/io/image_io.h"

namespace talbot {
namespace {

using Json = nlohmann::json;

// What each action needs and may have besides "do".
struct ActionInfo {
    ScriptAction action;
    std::string_view name;
    std::vector<std::string_view> required;
    std::vector<std::string_view> optional;
};

const std::array<ActionInfo, 20>& actions() {
    static const std::array<ActionInfo, 20> table{{
        {ScriptAction::orbit, "orbit", {"dx", "dy"}, {"frames"}},
        {ScriptAction::pan, "pan", {"dx", "dy"}, {"frames"}},
        {ScriptAction::look, "look", {"dx", "dy"}, {"frames"}},
        {ScriptAction::dolly, "dolly", {"notches"}, {"frames"}},
        {ScriptAction::drag,
         "drag",
         {"x", "y", "dx", "dy"},
         {"frames", "button", "in", "modifiers"}},
        {ScriptAction::click, "click", {"x", "y"}, {"button", "in", "double", "modifiers"}},
        {ScriptAction::move, "move", {"x", "y"}, {"in"}},
        {ScriptAction::key, "key", {"key"}, {"frames", "modifiers"}},
        {ScriptAction::text, "text", {"text"}, {}},
        {ScriptAction::set, "set", {"path", "value"}, {}},
        {ScriptAction::sweep, "sweep", {"path", "from", "to", "frames"}, {}},
        {ScriptAction::resize, "resize", {"width", "height"}, {}},
        {ScriptAction::open, "open", {"file"}, {"timeout"}},
        {ScriptAction::save, "save", {"file"}, {"timeout"}},
        {ScriptAction::screenshot, "screenshot", {"file"}, {}},
        {ScriptAction::wait, "wait", {}, {"passes", "seconds", "frames", "jobs", "timeout"}},
        {ScriptAction::idle, "idle", {"seconds"}, {}},
        {ScriptAction::measure, "measure", {}, {}},
        {ScriptAction::random, "random", {"count"}, {"seed"}},
        {ScriptAction::expect,
         "expect",
         {},
         {"path", "value", "tolerance", "selected", "notice", "kernel", "effect"}},
    }};
    return table;
}

std::string in_quotes(std::string_view text) {
    std::string result(1, '"');
    result.append(text).append(1, '"');
    return result;
}

constexpr unsigned kMostFrames = 1000000;

// Reads one line's keys; the first thing that is wrong is kept.
class LineReader {
  public:
    LineReader(const Json& object, std::string where) : object_(object), where_(std::move(where)) {}

    bool has(const char* key) const { return object_.contains(key); }
    bool ok() const { return !error_; }
    const Error& error() const { return *error_; }
    void fail(const std::string& key, const std::string& what) {
        if (!error_) error_ = Error{ErrorKind::usage, where_, key, what};
    }

    void number(const char* key, double& value, double lower = -kHuge, double upper = kHuge) {
        if (!has(key)) return;
        const Json& json = object_[key];
        if (!json.is_number()) return fail(key, "a number is expected");
        const double read = json.get<double>();
        if (!(read >= lower && read <= upper)) return fail(key, "the number is out of range");
        value = read;
    }
    template <typename Integer>
    void integer(const char* key, Integer& value, double lower, double upper) {
        if (!has(key)) return;
        if (!object_[key].is_number_integer()) return fail(key, "a whole number is expected");
        double read = 0;
        number(key, read, lower, upper);
        if (ok()) value = static_cast<Integer>(read);
    }
    void string(const char* key, std::string& value) {
        if (!has(key)) return;
        if (!object_[key].is_string()) return fail(key, "a text is expected");
        value = object_[key].get<std::string>();
    }
    void flag(const char* key, bool& value) {
        if (!has(key)) return;
        if (!object_[key].is_boolean()) return fail(key, "true or false is expected");
        value = object_[key].get<bool>();
    }
    // A number, true or false, a list of up to four numbers, or (where text is given) a name.
    void value(const char* key, std::vector<double>& numbers, std::string* text) {
        if (!has(key)) return;
        const Json& json = object_[key];
        if (json.is_number()) {
            numbers = {json.get<double>()};
        } else if (json.is_boolean()) {
            numbers = {json.get<bool>() ? 1.0 : 0.0};
        } else if (json.is_array() && !json.empty() && json.size() <= 4) {
            for (const Json& item : json) {
                if (!item.is_number()) return fail(key, "the list must hold numbers");
                numbers.push_back(item.get<double>());
            }
        } else if (json.is_string() && json.get<std::string>() == "infinity") {
            numbers = {std::numeric_limits<double>::infinity()};
        } else if (json.is_string() && text) {
            *text = json.get<std::string>();
        } else {
            fail(key, "a number, a list of up to four numbers, true, false or a name is expected");
        }
    }
    const Json& json(const char* key) const { return object_[key]; }

  private:
    static constexpr double kHuge = std::numeric_limits<double>::max();

    const Json& object_;
    std::string where_;
    std::optional<Error> error_;
};

void check_keys(LineReader& reader, const Json& object, const ActionInfo& info) {
    for (const std::string_view key : info.required) {
        if (!reader.has(std::string(key).c_str())) {
            reader.fail(std::string(key), in_quotes(info.name) + " needs this key");
        }
    }
    const auto is_in = [](const std::vector<std::string_view>& keys, const std::string& key) {
        return std::find(keys.begin(), keys.end(), key) != keys.end();
    };
    for (const auto& [key, ignored] : object.items()) {
        if (key == "do" || is_in(info.required, key) || is_in(info.optional, key)) continue;
        reader.fail(key, in_quotes(info.name) + " has no such key");
    }
}

void read_button(LineReader& reader, ScriptStep& step) {
    std::string name;
    reader.string("button", name);
    if (name.empty() || name == "left")
        step.button = MouseButton::left;
    else if (name == "right")
        step.button = MouseButton::right;
    else if (name == "middle")
        step.button = MouseButton::middle;
    else
        reader.fail("button", "left, right or middle is expected");
}

void read_keys(LineReader& reader, ScriptStep& step) {
    std::string name;
    reader.string("key", name);
    if (!name.empty()) {
        if (const std::optional<Key> key = key_from_name(name))
            step.key = *key;
        else
            reader.fail("key", "there is no key named " + in_quotes(name));
    }
    if (!reader.has("modifiers")) return;
    if (!reader.json("modifiers").is_array())
        return reader.fail("modifiers", "a list of key names is expected");
    for (const Json& item : reader.json("modifiers")) {
        const std::optional<Key> key =
            item.is_string() ? key_from_name(item.get<std::string>()) : std::nullopt;
        if (!key) return reader.fail("modifiers", "a list of key names is expected");
        step.modifiers.push_back(*key);
    }
}

void read_fields(LineReader& reader, ScriptStep& step) {
    reader.number("x", step.x);
    reader.number("y", step.y);
    reader.number("dx", step.dx);
    reader.number("dy", step.dy);
    reader.number("notches", step.notches, -1000, 1000);
    reader.integer("frames", step.frames, 1, kMostFrames);
    std::string in = "image";
    reader.string("in", in);
    if (in != "image" && in != "window") reader.fail("in", "image or window is expected");
    step.in_window = in == "window";
    read_button(reader, step);
    reader.flag("double", step.double_click);
    read_keys(reader, step);
    reader.string("text", step.text);
    reader.string("path", step.path);
    reader.value("value", step.value, &step.text);
    reader.value("from", step.value, nullptr);
    reader.value("to", step.to, nullptr);
    reader.number("tolerance", step.tolerance, 0);
    reader.integer("width", step.width, 16, 16384);
    reader.integer("height", step.height, 16, 16384);
    reader.string("file", step.file);
    if (reader.has("passes")) reader.integer("passes", step.passes.emplace(), 1, 9e15);
    if (reader.has("seconds")) reader.number("seconds", step.seconds.emplace(), 0, 1e6);
    reader.flag("jobs", step.jobs);
    reader.number("timeout", step.timeout, 0, 1e6);
    reader.integer("count", step.count, 1, kMostFrames);
    reader.integer("seed", step.seed, 0, 9e15);
    if (step.action == ScriptAction::expect) {
        const bool has_value = reader.has("path") && reader.has("value");
        if (reader.has("selected")) reader.string("selected", step.selected.emplace());
        if (reader.has("notice")) reader.string("notice", step.notice.emplace());
        if (reader.has("kernel")) reader.string("kernel", step.kernel.emplace());
        if (reader.has("effect")) {
            std::string name;
            reader.string("effect", name);
            step.effect_absent = name.starts_with('-');
            step.effect = effect_from_name(step.effect_absent ? name.substr(1) : name);
            if (!step.effect) reader.fail("effect", "there is no effect '" + name + "'");
        }
        if (!has_value && !step.selected && !step.notice && !step.kernel && !step.effect) {
            reader.fail("", "\"expect\" needs path and value, selected, notice, kernel or effect");
        }
    }
    if (step.action == ScriptAction::sweep && step.value.size() != step.to.size()) {
        reader.fail("to", "from and to must have as many numbers");
    }
}

Result<ScriptStep> parse_line(std::string_view text, const std::string& where) {
    const Json object = Json::parse(text, nullptr, false);
    if (!object.is_object())
        return Error{ErrorKind::usage, where, "", "not a JSON object on one line"};
    LineReader reader(object, where);
    if (!object.contains("do") || !object["do"].is_string()) {
        reader.fail("do", "every line names its action, e.g. {\"do\": \"wait\", \"passes\": 4}");
        return reader.error();
    }
    const std::string name = object["do"].get<std::string>();
    const auto info = std::find_if(actions().begin(), actions().end(),
                                   [&](const ActionInfo& action) { return action.name == name; });
    if (info == actions().end()) {
        reader.fail("do", "there is no action " + in_quotes(name));
        return reader.error();
    }
    ScriptStep step;
    step.action = info->action;
    check_keys(reader, object, *info);
    read_fields(reader, step);
    if (!reader.ok()) return reader.error();
    return step;
}

}  // namespace

std::string_view action_name(ScriptAction action) {
    for (const ActionInfo& info : actions()) {
        if (info.action == action) return info.name;
    }
    return "";
}

Result<std::vector<ScriptStep>> parse_script(std::string_view text, const std::string& file) {
    std::vector<ScriptStep> steps;
    std::size_t line = 0;
    while (!text.empty()) {
        ++line;
        const std::size_t end = text.find('\n');
        std::string_view current = text.substr(0, end);
        text = end == std::string_view::npos ? std::string_view() : text.substr(end + 1);
        const std::size_t first = current.find_first_not_of(" \t\r");
        if (first == std::string_view::npos || current[first] == '#') continue;
        Result<ScriptStep> step = parse_line(current, file + ":" + std::to_string(line));
        if (!step) return step.error();
        step->line = line;
        steps.push_back(std::move(*step));
    }
    return steps;
}

Result<std::vector<ScriptStep>> load_script(const std::filesystem::path& file) {
    constexpr uint64_t kLargestScript = 64u << 20;
    const Result<std::vector<uint8_t>> bytes = read_file(file, kLargestScript);
    if (!bytes) return bytes.error();
    return parse_script(
        std::string_view(reinterpret_cast<const char*>(bytes->data()), bytes->size()),
        file.string());
}

Result<ParameterValue> script_value(const ParameterInfo& info, const std::vector<double>& numbers,
                                    const std::string& text) {
    const auto wrong = [&](const std::string& what) {
        return Error{ErrorKind::usage, "", std::string(info.name), what};
    };
    ParameterValue value{};
    if (numbers.empty()) {
        for (std::size_t i = 0; i < info.choice_names.size(); ++i) {
            if (info.choice_names[i] == text) {
                value[0] = static_cast<double>(i);
                return value;
            }
        }
        return wrong("there is no choice " + in_quotes(text));
    }
    const std::size_t wanted = static_cast<std::size_t>(component_count(info.kind));
    // A colour without its alpha stays opaque.
    if (info.kind == ParameterKind::color_alpha && numbers.size() == 3)
        value[3] = 1;
    else if (numbers.size() != wanted && numbers.size() != 1) {
        return wrong(std::to_string(wanted) + " numbers are expected");
    }
    for (std::size_t i = 0; i < wanted; ++i) {
        if (numbers.size() == 1)
            value[i] = numbers[0];
        else if (i < numbers.size())
            value[i] = numbers[i];
    }
    return value;
}

}  // namespace talbot
