#include "ui/parameters.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>

namespace talbot {
namespace {

enum class ParameterGroup {
    materials,
    lights,
    scene,
    environment,
    camera,
    render,
    display,
    session
};

// A path taken apart: group, index where the group is a list, and the name of the value.
struct Target {
    ParameterGroup group;
    uint32_t index = 0;
    std::string_view name;
};

Error bad_path(std::string_view path, const std::string& what) {
    return {ErrorKind::usage, "", std::string(path), what};
}

// The index that stands between the brackets: a number, or a material's or light's name.
template <typename Item>
std::optional<uint32_t> index_of(std::string_view text, const std::vector<Item>& items) {
    uint32_t index = 0;
    const auto [end, failed] = std::from_chars(text.data(), text.data() + text.size(), index);
    if (failed == std::errc() && end == text.data() + text.size()) {
        if (index < items.size()) return index;
        return std::nullopt;
    }
    for (std::size_t i = 0; i < items.size(); ++i) {
        if (!text.empty() && items[i].name == text) return static_cast<uint32_t>(i);
    }
    return std::nullopt;
}

Result<Target> parse_path(const ViewerModel& model, std::string_view path) {
    const std::size_t bracket = path.find('[');
    const std::size_t dot = path.rfind('.');
    if (dot == std::string_view::npos || dot + 1 == path.size()) {
        return bad_path(path, "not a parameter path; write GROUP.NAME, e.g. camera.yfov");
    }
    Target target{ParameterGroup::camera, 0, path.substr(dot + 1)};
    if (bracket == std::string_view::npos) {
        const std::string_view group = path.substr(0, dot);
        if (group == "environment")
            target.group = ParameterGroup::environment;
        else if (group == "scene")
            target.group = ParameterGroup::scene;
        else if (group == "camera")
            target.group = ParameterGroup::camera;
        else if (group == "render")
            target.group = ParameterGroup::render;
        else if (group == "display")
            target.group = ParameterGroup::display;
        else if (group == "session")
            target.group = ParameterGroup::session;
        else
            return bad_path(path,
                            "unknown group; there are materials[i], lights[i], scene, "
                            "environment, camera, render, display and session");
        return target;
    }
    const std::string_view group = path.substr(0, bracket);
    if (dot < bracket + 2 || path[dot - 1] != ']')
        return bad_path(path, "the bracket is not closed before the dot");
    const std::string_view inside = path.substr(bracket + 1, dot - bracket - 2);
    std::optional<uint32_t> index;
    if (group == "materials") {
        target.group = ParameterGroup::materials;
        index = index_of(inside, model.materials);
    } else if (group == "lights") {
        target.group = ParameterGroup::lights;
        index = index_of(inside, model.lights);
    } else {
        return bad_path(path, "unknown list; there are materials[i] and lights[i]");
    }
    if (!index) {
        const std::size_t count = target.group == ParameterGroup::materials ? model.materials.size()
                                                                            : model.lights.size();
        return bad_path(path, "no such entry; the scene has " + std::to_string(count) + " " +
                                  std::string(group));
    }
    target.index = *index;
    return target;
}

// Calls visit(parameter, owner) for the path's parameter; visit's result, or an error where there
// is none.
template <typename Value, typename Model, typename Visit>
Result<Value> visit_parameter(Model& model, std::string_view path, const Target& target,
                              const Visit& visit) {
    const auto look_up = [&](const auto& table, auto& owner) -> Result<Value> {
        const auto* parameter = find_parameter(table, target.name);
        if (!parameter) return bad_path(path, "there is no parameter of this name");
        return visit(*parameter, owner);
    };
    switch (target.group) {
        case ParameterGroup::materials:
            return look_up(material_parameters(), model.materials[target.index]);
        case ParameterGroup::lights:
            return look_up(light_parameters(), model.lights[target.index]);
        case ParameterGroup::scene:
            return look_up(scene_parameters(), model);
        case ParameterGroup::environment:
            return look_up(environment_parameters(), model.environment);
        case ParameterGroup::camera:
            return look_up(camera_parameters(), model.view);
        case ParameterGroup::render:
            return look_up(render_parameters(), model.settings);
        case ParameterGroup::display:
            return look_up(display_parameters(), model);
        case ParameterGroup::session:
            break;
    }
    return look_up(session_parameters(), model);
}

void note_edit(Edits& edits, const Target& target) {
    switch (target.group) {
        case ParameterGroup::materials:
            edits.materials.insert(target.index);
            break;
        case ParameterGroup::lights:
            edits.lights.insert(target.index);
            break;
        case ParameterGroup::environment:
            edits.environment = true;
            break;
        case ParameterGroup::camera:
            edits.camera = true;
            break;
        case ParameterGroup::render:
            edits.settings = true;
            break;
        case ParameterGroup::display:
            edits.aov |= target.name == "aov";
            break;
        case ParameterGroup::scene:
            break;
        case ParameterGroup::session:
            edits.paused |= target.name == "paused";
            edits.pass_limit |= target.name == "pass_limit";
            break;
    }
}

}  // namespace

int component_count(ParameterKind kind) {
    switch (kind) {
        case ParameterKind::color:
        case ParameterKind::vector3:
            return 3;
        case ParameterKind::color_alpha:
            return 4;
        case ParameterKind::vector2:
            return 2;
        default:
            return 1;
    }
}

Status set_parameter(ViewerModel& model, Edits& edits, std::string_view path,
                     const ParameterValue& value) {
    const Result<Target> target = parse_path(model, path);
    if (!target) return target.error();
    const auto write = [&](const auto& parameter, auto& owner) -> Result<Done> {
        const ParameterInfo& info = parameter.info;
        ParameterValue clamped = value;
        for (int i = 0; i < component_count(info.kind); ++i) {
            double& v = clamped[static_cast<std::size_t>(i)];
            if (std::isnan(v)) return bad_path(path, "the value is not a number");
            v = std::clamp(v, info.lower, info.upper);
            const bool whole =
                info.kind == ParameterKind::integer || info.kind == ParameterKind::choice;
            if (whole) v = std::floor(v);
        }
        parameter.write(owner, clamped);
        return Done{};
    };
    Status written = visit_parameter<Done>(model, path, *target, write);
    if (written) note_edit(edits, *target);
    return written;
}

Result<ParameterValue> read_parameter(const ViewerModel& model, std::string_view path) {
    const Result<Target> target = parse_path(model, path);
    if (!target) return target.error();
    return visit_parameter<ParameterValue>(
        model, path, *target,
        [](const auto& parameter, const auto& owner) -> Result<ParameterValue> {
            return parameter.read(owner);
        });
}

Result<ParameterInfo> parameter_info(const ViewerModel& model, std::string_view path) {
    const Result<Target> target = parse_path(model, path);
    if (!target) return target.error();
    return visit_parameter<ParameterInfo>(
        model, path, *target,
        [](const auto& parameter, const auto&) -> Result<ParameterInfo> { return parameter.info; });
}

std::vector<std::string> parameter_paths(const ViewerModel& model) {
    std::vector<std::string> paths;
    const auto list = [&](const std::string& prefix, const auto& table) {
        for (const auto& parameter : table)
            paths.push_back(prefix + "." + std::string(parameter.info.name));
    };
    for (std::size_t i = 0; i < model.materials.size(); ++i) {
        list("materials[" + std::to_string(i) + "]", material_parameters());
    }
    for (std::size_t i = 0; i < model.lights.size(); ++i) {
        list("lights[" + std::to_string(i) + "]", light_parameters());
    }
    list("scene", scene_parameters());
    list("environment", environment_parameters());
    list("camera", camera_parameters());
    list("render", render_parameters());
    list("display", display_parameters());
    list("session", session_parameters());
    return paths;
}

}  // namespace talbot
