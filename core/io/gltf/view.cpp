// Cameras, punctual lights and the environment. Node scale changes neither a camera nor a light's
// strength.
#include "core/io/gltf/view.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/io/gltf/values.h"
#include "core/math/robust.h"

namespace talbot::gltf {

namespace {

constexpr double kMaxResolution = 1 << 16;

Vec3d column(const Mat4d& m, int c) {
    return Vec3d(m[c]);
}

// v without its part along unit n, at unit length; zero when nothing is left.
Vec3d perpendicular_to(const Vec3d& v, const Vec3d& n) {
    const Vec3d rest = v - n * dot(v, n);
    const double size = length(rest);
    return size > 0 && is_finite(size) ? rest / size : Vec3d(0);
}

Vec3d unit(const Vec3d& v) {
    const double size = length(v);
    return size > 0 && is_finite(size) ? v / size : Vec3d(0);
}

// The orthonormal right-handed frame nearest to the node's axes; false when it has none.
bool set_frame(const Mat4d& world, Camera& camera) {
    camera.position = column(world, 3);
    camera.backward = unit(column(world, 2));
    camera.up = perpendicular_to(column(world, 1), camera.backward);
    camera.right = cross(camera.up, camera.backward);
    return is_finite(camera.position) && camera.backward != Vec3d(0) && camera.up != Vec3d(0);
}

// Empty when the numbers make a camera, else what is wrong.
std::string set_projection(const tinygltf::Camera& in, Camera& camera) {
    if (in.type == "orthographic") {
        camera.kind = CameraKind::orthographic;
        camera.xmag = std::abs(in.orthographic.xmag);
        camera.ymag = std::abs(in.orthographic.ymag);
        const bool valid =
            camera.xmag > 0 && camera.ymag > 0 && is_finite(camera.xmag) && is_finite(camera.ymag);
        return valid ? "" : "xmag and ymag must not be 0";
    }
    camera.kind = CameraKind::perspective;
    camera.yfov = in.perspective.yfov;
    if (!(camera.yfov > 0 && camera.yfov < std::numbers::pi))
        return "yfov must lie between 0 and pi";
    if (in.perspective.aspectRatio > 0 && is_finite(in.perspective.aspectRatio)) {
        camera.aspect_ratio = in.perspective.aspectRatio;
    }
    return "";
}

// camera.extras: resolution [w, h], lens {apertureRadius, focusDistance} in metres, lensShift [x,
// y] in window heights.
void read_camera_extras(const tinygltf::Value& extras, Camera& camera) {
    double size[2];
    if (numbers_member(extras, "resolution", 2, size) && size[0] >= 1 && size[1] >= 1 &&
        size[0] <= kMaxResolution && size[1] <= kMaxResolution) {
        camera.resolution =
            Resolution{static_cast<uint32_t>(size[0]), static_cast<uint32_t>(size[1])};
    }
    double shift[2];
    if (numbers_member(extras, "lensShift", 2, shift))
        camera.lens_shift = Vec2d(shift[0], shift[1]);
    if (const tinygltf::Value* lens = member(extras, "lens")) {
        camera.aperture_radius =
            std::clamp(number_member(*lens, "apertureRadius", 0), 0.0, kLargestFactor);
        camera.focus_distance =
            std::clamp(number_member(*lens, "focusDistance", 0), 0.0, kLargestFactor);
    }
}

bool set_kind(const std::string& type, PunctualLight& light) {
    if (type == "point") light.kind = PunctualKind::point;
    if (type == "spot") light.kind = PunctualKind::spot;
    if (type == "directional") light.kind = PunctualKind::directional;
    return type == "point" || type == "spot" || type == "directional";
}

void read_light(const tinygltf::Light& in, const LightReading& reading, PunctualLight& light) {
    if (in.color.size() == 3) light.color = color_of(in.color.data(), kLargestFactor);
    for (const LightUnitsInfo& units : kLightUnits) {
        if (units.units == reading.units)
            light.intensity = limited(in.intensity * static_cast<double>(units.factor), 0,
                                      std::numeric_limits<float>::max());
    }
    if (light.kind == PunctualKind::directional) {
        const double own = number_member(in.extras, "angularDiameter", 0);
        const double diameter =
            reading.sun_degrees ? *reading.sun_degrees * std::numbers::pi / 180 : own;
        light.angular_diameter = limited(diameter, 0, kPi);
    }
    if (in.range > 0) light.range = static_cast<float>(in.range);
    if (light.kind != PunctualKind::spot) return;
    // Equal angles are invalid, but occur: the edge is then one step wide.
    const float half_pi = 0.5f * kPi;
    light.outer_cone_angle = limited(in.spot.outerConeAngle, 0, half_pi);
    if (!(light.outer_cone_angle > 0)) light.outer_cone_angle = std::numeric_limits<float>::min();
    const float widest = std::nextafter(light.outer_cone_angle, 0.0f);
    light.inner_cone_angle = std::min(limited(in.spot.innerConeAngle, 0, half_pi), widest);
}

std::string first_name(const std::string& a, const std::string& b, const char* kind, size_t index) {
    if (!a.empty()) return a;
    return b.empty() ? std::string(kind) + " " + std::to_string(index) : b;
}

}  // namespace

void place_cameras(Loading& loading, const std::vector<PlacedNode>& nodes) {
    const tinygltf::Model& model = loading.document.model;
    std::vector<const PlacedNode*> placed;
    for (const PlacedNode& p : nodes) {
        if (model.nodes[p.node].camera >= 0) placed.push_back(&p);
    }
    std::stable_sort(placed.begin(), placed.end(), [&](const PlacedNode* a, const PlacedNode* b) {
        return model.nodes[a->node].camera < model.nodes[b->node].camera;
    });
    for (const PlacedNode* p : placed) {
        const auto index = static_cast<size_t>(model.nodes[p->node].camera);
        const tinygltf::Camera& in = model.cameras[index];
        Camera camera;
        camera.name = first_name(in.name, model.nodes[p->node].name, "camera", index);
        const std::string problem = set_projection(in, camera);
        if (!problem.empty() || !set_frame(p->world_unscaled, camera)) {
            loading.warn(element_name("cameras", index),
                         (problem.empty() ? "has no orientation" : problem) + "; it is left out");
            continue;
        }
        read_camera_extras(in.extras, camera);
        loading.desc.cameras.push_back(camera);
    }
}

Status place_lights(Loading& loading, const std::vector<PlacedNode>& nodes) {
    const tinygltf::Model& model = loading.document.model;
    for (const PlacedNode& p : nodes) {
        const tinygltf::Value* extension =
            find_extension_value(model.nodes[p.node].extensions, "KHR_lights_punctual");
        if (!extension || !p.is_visible) continue;
        const std::optional<uint32_t> index = index_member(*extension, "light");
        const std::string element =
            element_name("nodes", p.node) + ".extensions.KHR_lights_punctual";
        if (!index || *index >= model.lights.size()) {
            return loading.document.error(element, "its light is out of range: there are " +
                                                       std::to_string(model.lights.size()) +
                                                       " lights");
        }
        const tinygltf::Light& in = model.lights[*index];
        PunctualLight light;
        light.name = first_name(model.nodes[p.node].name, in.name, "light", *index);
        light.position = column(p.world_unscaled, 3);
        const Vec3d direction = unit(-column(p.world_unscaled, 2));
        const bool known = set_kind(in.type, light);
        if (!known || !is_finite(light.position) || direction == Vec3d(0)) {
            loading.warn(element, known ? "has no place or direction; it is left out"
                                        : "its type is unknown; it is left out");
            continue;
        }
        light.direction = Vec3f(direction);
        read_light(in, loading.options.lights, light);
        loading.desc.lights.push_back(light);
    }
    return Done{};
}

void read_environment(Loading& loading, std::optional<size_t> scene) {
    if (!scene) return;
    const tinygltf::Value* environment =
        member(loading.document.model.scenes[*scene].extras, "environment");
    if (!environment) return;
    double color[3];
    if (numbers_member(*environment, "color", 3, color))
        loading.desc.environment.color = color_of(color, kLargestFactor);
    const tinygltf::Value* gradient = member(*environment, "gradient");
    if (!gradient) return;
    double axis[3] = {0, 1, 0};
    double from[3];
    double to[3];
    numbers_member(*gradient, "axis", 3, axis);
    const Vec3d direction = unit(Vec3d(axis[0], axis[1], axis[2]));
    if (!numbers_member(*gradient, "from", 3, from) || !numbers_member(*gradient, "to", 3, to) ||
        direction == Vec3d(0)) {
        loading.warn(element_name("scenes", *scene) + ".extras.environment.gradient",
                     "needs axis, from and to; it is left out");
        return;
    }
    loading.desc.environment.gradient = EnvironmentGradient{
        Vec3f(direction), color_of(from, kLargestFactor), color_of(to, kLargestFactor)};
}

}  // namespace talbot::gltf
