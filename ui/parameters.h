// Every value that the user can edit, declared once: its path for scripts, its label, unit and
// range for the panels, and how it is read and written. Paths look like
// materials[3].roughness_factor, lights[0].intensity, environment.rotation_degrees, camera.yfov,
// render.max_depth, scene.animation_seconds, display.exposure_ev, session.paused; a material may
// also be named: materials[Glass].ior.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.h"
#include "ui/viewer_model.h"

namespace talbot {

enum class ParameterKind : uint8_t {
    number,
    integer,
    flag,         // 0 or 1
    choice,       // index into choices
    color,        // linear RGB
    color_alpha,  // linear RGBA
    vector2,
    vector3,
};

// As many of the four as the kind needs.
using ParameterValue = std::array<double, 4>;

struct ParameterInfo {
    std::string_view name;   // in a path
    std::string_view label;  // in a panel; glTF's own name where there is one
    std::string_view unit = {};
    ParameterKind kind = ParameterKind::number;
    double lower = 0;  // what is allowed, for each component
    double upper = 1;
    double slider_lower = 0;  // what the slider spans
    double slider_upper = 1;
    bool logarithmic = false;
    std::span<const std::string_view> choices = {};       // as shown
    std::span<const std::string_view> choice_names = {};  // as written in scripts
    std::string_view note = {};                           // one sentence, shown as a tooltip
};

// How many components the kind has.
int component_count(ParameterKind kind);

template <typename T>
struct Parameter {
    ParameterInfo info;
    ParameterValue (*read)(const T&);
    void (*write)(T&, const ParameterValue&);
};

std::span<const Parameter<Material>> material_parameters();
std::span<const Parameter<PunctualLight>> light_parameters();
std::span<const Parameter<ViewerModel>> scene_parameters();  // what of the file is on show
std::span<const Parameter<Environment>> environment_parameters();
std::span<const Parameter<CameraController>> camera_parameters();
std::span<const Parameter<RenderSettings>> render_parameters();
std::span<const Parameter<ViewerModel>> display_parameters();  // DisplaySettings and ViewSettings
std::span<const Parameter<ViewerModel>> session_parameters();

template <typename T>
const Parameter<T>* find_parameter(std::span<const Parameter<T>> table, std::string_view name) {
    for (const Parameter<T>& parameter : table) {
        if (parameter.info.name == name) return &parameter;
    }
    return nullptr;
}

// Sets the value at the path, clamped to what is allowed, and notes the edit. An unknown path, an
// index out of range or a value that is not a number is a usage error that names the path.
Status set_parameter(ViewerModel& model, Edits& edits, std::string_view path,
                     const ParameterValue& value);

// The value at the path.
Result<ParameterValue> read_parameter(const ViewerModel& model, std::string_view path);

// What is known about the path.
Result<ParameterInfo> parameter_info(const ViewerModel& model, std::string_view path);

// Every path that exists in this model.
std::vector<std::string> parameter_paths(const ViewerModel& model);

}  // namespace talbot
