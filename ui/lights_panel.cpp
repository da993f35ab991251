// Environment and punctual lights.
#include <imgui.h>

#include "ui/panels.h"
#include "ui/parameter_widgets.h"

namespace talbot {
namespace {

const char* kind_name(PunctualKind kind) {
    switch (kind) {
        case PunctualKind::point:
            return "point";
        case PunctualKind::spot:
            return "spot";
        case PunctualKind::directional:
            return "directional";
    }
    return "";
}

bool edit_gradient_color(std::string_view label, std::string_view name, Rgb& color) {
    ParameterInfo info = find_parameter(environment_parameters(), "color")->info;
    info.label = label;
    info.name = name;
    info.note = {};
    ParameterValue value{color.x, color.y, color.z};
    if (!edit_parameter(info, value)) return false;
    color = Rgb(Vec3d(value[0], value[1], value[2]));
    return true;
}

bool draw_environment(Environment& environment) {
    bool changed = false;
    if (environment.image) {
        const EnvironmentImage& image = *environment.image;
        const std::size_t slash = image.file.find_last_of('/');
        const std::string name =
            slash == std::string::npos ? image.file : image.file.substr(slash + 1);
        begin_row("Image");
        ImGui::TextWrapped("%s", name.c_str());
        text_row("", "%u \xC3\x97 %u px", image.width, image.height);
    } else if (environment.gradient) {
        changed |= edit_gradient_color("From", "from", environment.gradient->from);
        changed |= edit_gradient_color("To", "to", environment.gradient->to);
    } else {
        changed |= edit_named(environment_parameters(), "color", environment);
    }
    changed |= edit_named(environment_parameters(), "intensity", environment);
    changed |= edit_named(environment_parameters(), "rotation_degrees", environment);
    return changed;
}

bool draw_light(PunctualLight& light) {
    bool changed = false;
    text_row("Kind", "%s", kind_name(light.kind));
    for (const Parameter<PunctualLight>& parameter : light_parameters()) {
        ParameterInfo info = parameter.info;
        const bool cone = info.name.ends_with("cone_angle");
        if (cone && light.kind != PunctualKind::spot) continue;
        if (info.name == "position" && light.kind == PunctualKind::directional) continue;
        if (info.name == "range" && light.kind == PunctualKind::directional) continue;
        if (info.name == "angular_diameter" && light.kind != PunctualKind::directional) continue;
        if (info.name == "direction" && light.kind == PunctualKind::point) continue;
        if (info.name == "intensity")
            info.unit = light.kind == PunctualKind::directional ? "lx" : "cd";
        ParameterValue value = parameter.read(light);
        if (edit_parameter(info, value)) {
            parameter.write(light, value);
            changed = true;
        }
    }
    return changed;
}

}  // namespace

bool draw_lights_panel(ViewerModel& model, Edits& edits) {
    bool changed = false;
    if (draw_environment(model.environment)) {
        edits.environment = true;
        changed = true;
    }
    for (uint32_t i = 0; i < model.lights.size(); ++i) {
        PunctualLight& light = model.lights[i];
        ImGui::PushID(static_cast<int>(i));
        const std::string name = light.name.empty() ? "Light " + std::to_string(i) : light.name;
        if (ImGui::TreeNodeEx("light", ImGuiTreeNodeFlags_SpanAvailWidth, "%s", name.c_str())) {
            if (draw_light(light)) {
                edits.lights.insert(i);
                changed = true;
            }
            ImGui::TreePop();
        }
        ImGui::PopID();
    }
    return changed;
}

}  // namespace talbot
