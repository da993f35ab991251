// The tables of ui/parameters.h.
#include <cmath>
#include <limits>

#include "ui/parameters.h"

namespace talbot {
namespace {

constexpr double kUnbounded = std::numeric_limits<double>::infinity();
constexpr double kLargest = std::numeric_limits<float>::max();
constexpr double kDegreesPerRadian = 180 / std::numbers::pi;

// Readers and writers for a member of a table's type.
template <typename T, auto kMember>
ParameterValue read_scalar(const T& owner) {
    return {static_cast<double>(owner.*kMember)};
}
template <typename T, auto kMember>
void write_scalar(T& owner, const ParameterValue& value) {
    auto& member = owner.*kMember;
    using Member = std::remove_reference_t<decltype(member)>;
    if constexpr (std::is_same_v<Member, bool>) {
        member = value[0] != 0;
    } else {
        member = static_cast<Member>(value[0]);
    }
}
template <typename T, auto kMember>
ParameterValue read_components(const T& owner) {
    ParameterValue value{};
    const auto& member = owner.*kMember;
    for (int i = 0; i < member.length(); ++i) {
        value[static_cast<std::size_t>(i)] = static_cast<double>(member[i]);
    }
    return value;
}
template <typename T, auto kMember>
void write_components(T& owner, const ParameterValue& value) {
    auto& member = owner.*kMember;
    using Component = std::remove_reference_t<decltype(member[0])>;
    for (int i = 0; i < member.length(); ++i) {
        member[i] = static_cast<Component>(value[static_cast<std::size_t>(i)]);
    }
}
template <typename T, auto kMember>
constexpr Parameter<T> scalar(const ParameterInfo& info) {
    return {info, read_scalar<T, kMember>, write_scalar<T, kMember>};
}
template <typename T, auto kMember>
constexpr Parameter<T> components(const ParameterInfo& info) {
    return {info, read_components<T, kMember>, write_components<T, kMember>};
}

using Kind = ParameterKind;

constexpr std::string_view kAlphaModes[] = {"opaque", "mask", "blend"};

constexpr Parameter<Material> kMaterialParameters[] = {
    components<Material, &Material::base_color_factor>(
        {"base_color_factor", "baseColorFactor", "", Kind::color_alpha}),
    scalar<Material, &Material::metallic_factor>({"metallic_factor", "metallicFactor"}),
    scalar<Material, &Material::roughness_factor>({.name = "roughness_factor",
                                                   .label = "roughnessFactor",
                                                   .note = "GGX alpha is its square."}),
    scalar<Material, &Material::normal_scale>({.name = "normal_scale",
                                               .label = "normalTexture.scale",
                                               .lower = -10,
                                               .upper = 10,
                                               .slider_upper = 2}),
    components<Material, &Material::emissive_factor>(
        {"emissive_factor", "emissiveFactor", "", Kind::color}),
    scalar<Material, &Material::emissive_strength>(
        {.name = "emissive_strength",
         .label = "emissiveStrength",
         .unit = "nt",
         .upper = kLargest,
         .slider_upper = 1000,
         .logarithmic = true,
         .note = "KHR_materials_emissive_strength: radiance is emissiveFactor times this."}),
    {{.name = "alpha_mode",
      .label = "alphaMode",
      .kind = Kind::choice,
      .upper = 2,
      .choices = kAlphaModes,
      .choice_names = kAlphaModes},
     [](const Material& m) { return ParameterValue{static_cast<double>(m.alpha_mode)}; },
     [](Material& m, const ParameterValue& v) {
         m.alpha_mode = static_cast<AlphaMode>(static_cast<int>(v[0]));
     }},
    scalar<Material, &Material::alpha_cutoff>({"alpha_cutoff", "alphaCutoff"}),
    scalar<Material, &Material::double_sided>({"double_sided", "doubleSided", "", Kind::flag}),
    scalar<Material, &Material::unlit>({.name = "unlit",
                                        .label = "unlit",
                                        .kind = Kind::flag,
                                        .note = "KHR_materials_unlit: shows its base colour."}),
    {{.name = "ior",
      .label = "ior",
      .upper = 100,
      .slider_lower = 1,
      .slider_upper = 2.5,
      .note = "KHR_materials_ior: 0 means full reflection everywhere, else 1 or more."},
     read_scalar<Material, &Material::ior>,
     [](Material& m, const ParameterValue& v) {
         m.ior = v[0] > 0 ? std::max(1.0f, static_cast<float>(v[0])) : 0.0f;
     }},
    scalar<Material, &Material::specular_factor>(
        {.name = "specular_factor", .label = "specularFactor", .note = "KHR_materials_specular"}),
    components<Material, &Material::specular_color_factor>(
        {.name = "specular_color_factor",
         .label = "specularColorFactor",
         .kind = Kind::color,
         .upper = kLargest,
         .note = "KHR_materials_specular; may exceed 1."}),
    scalar<Material, &Material::transmission_factor>({.name = "transmission_factor",
                                                      .label = "transmissionFactor",
                                                      .note = "KHR_materials_transmission"}),
    scalar<Material, &Material::thickness_factor>(
        {.name = "thickness_factor",
         .label = "thicknessFactor",
         .unit = "m",
         .upper = kLargest,
         .note = "KHR_materials_volume: 0 is a thin wall, more a closed volume."}),
    components<Material, &Material::attenuation_color>(
        {.name = "attenuation_color",
         .label = "attenuationColor",
         .kind = Kind::color,
         .note = "KHR_materials_volume: what is left of white after attenuationDistance."}),
    scalar<Material, &Material::attenuation_distance>({.name = "attenuation_distance",
                                                       .label = "attenuationDistance",
                                                       .unit = "m",
                                                       .lower = 0x1p-20,
                                                       .upper = kUnbounded,
                                                       .slider_lower = 0.001,
                                                       .slider_upper = 10,
                                                       .logarithmic = true,
                                                       .note = "KHR_materials_volume"}),
    components<Material, &Material::multiscatter_color>(
        {.name = "multiscatter_color",
         .label = "multiscatterColor",
         .kind = Kind::color,
         .note = "KHR_materials_volume_scatter: what a thick body returns; needs attenuation."}),
    scalar<Material, &Material::scatter_anisotropy>(
        {.name = "scatter_anisotropy",
         .label = "scatterAnisotropy",
         .lower = -kLargestAnisotropy,
         .upper = kLargestAnisotropy,
         .slider_lower = -0.99,
         .slider_upper = 0.99,
         .note = "KHR_materials_volume_scatter: mean cosine of the turn."}),
    scalar<Material, &Material::nested_priority>(
        {.name = "nested_priority",
         .label = "nestedPriority",
         .lower = -kLargest,
         .upper = kLargest,
         .slider_lower = -5,
         .slider_upper = 5,
         .note = "Where volumes overlap, the highest fills the space."}),
    scalar<Material, &Material::dispersion>(
        {.name = "dispersion",
         .label = "dispersion",
         .upper = kLargest,
         .slider_upper = 5,
         .note = "KHR_materials_dispersion: 20 / Abbe number; volumes only."}),
    scalar<Material, &Material::diffuse_transmission_factor>(
        {.name = "diffuse_transmission_factor",
         .label = "diffuseTransmissionFactor",
         .note = "KHR_materials_diffuse_transmission"}),
    components<Material, &Material::diffuse_transmission_color_factor>(
        {.name = "diffuse_transmission_color_factor",
         .label = "diffuseTransmissionColorFactor",
         .kind = Kind::color,
         .note = "KHR_materials_diffuse_transmission"}),
    scalar<Material, &Material::clearcoat_factor>({.name = "clearcoat_factor",
                                                   .label = "clearcoatFactor",
                                                   .note = "KHR_materials_clearcoat"}),
    scalar<Material, &Material::clearcoat_roughness_factor>({.name = "clearcoat_roughness_factor",
                                                             .label = "clearcoatRoughnessFactor",
                                                             .note = "KHR_materials_clearcoat"}),
    scalar<Material, &Material::clearcoat_normal_scale>({.name = "clearcoat_normal_scale",
                                                         .label = "clearcoatNormalTexture.scale",
                                                         .lower = -10,
                                                         .upper = 10,
                                                         .slider_upper = 2,
                                                         .note = "KHR_materials_clearcoat"}),
    components<Material, &Material::sheen_color_factor>({.name = "sheen_color_factor",
                                                         .label = "sheenColorFactor",
                                                         .kind = Kind::color,
                                                         .note = "KHR_materials_sheen"}),
    scalar<Material, &Material::sheen_roughness_factor>({.name = "sheen_roughness_factor",
                                                         .label = "sheenRoughnessFactor",
                                                         .note = "KHR_materials_sheen"}),
    scalar<Material, &Material::anisotropy_strength>({.name = "anisotropy_strength",
                                                      .label = "anisotropyStrength",
                                                      .note = "KHR_materials_anisotropy"}),
    scalar<Material, &Material::anisotropy_rotation>(
        {.name = "anisotropy_rotation",
         .label = "anisotropyRotation",
         .unit = "rad",
         .lower = -100,
         .upper = 100,
         .slider_upper = 6.2831853,
         .note = "KHR_materials_anisotropy: from the tangent towards the bitangent."}),
    scalar<Material, &Material::iridescence_factor>({.name = "iridescence_factor",
                                                     .label = "iridescenceFactor",
                                                     .note = "KHR_materials_iridescence"}),
    scalar<Material, &Material::iridescence_ior>({.name = "iridescence_ior",
                                                  .label = "iridescenceIor",
                                                  .lower = 1,
                                                  .upper = 100,
                                                  .slider_lower = 1,
                                                  .slider_upper = 3,
                                                  .note = "KHR_materials_iridescence"}),
    scalar<Material, &Material::iridescence_thickness_minimum>(
        {.name = "iridescence_thickness_minimum",
         .label = "iridescenceThicknessMinimum",
         .unit = "nm",
         .upper = kLargest,
         .slider_upper = 1200,
         .note = "KHR_materials_iridescence: where the thickness texture is 0."}),
    scalar<Material, &Material::iridescence_thickness_maximum>(
        {.name = "iridescence_thickness_maximum",
         .label = "iridescenceThicknessMaximum",
         .unit = "nm",
         .upper = kLargest,
         .slider_upper = 1200,
         .note = "KHR_materials_iridescence: everywhere if there is no texture."}),
};

constexpr Parameter<PunctualLight> kLightParameters[] = {
    components<PunctualLight, &PunctualLight::color>(
        {.name = "color", .label = "color", .kind = Kind::color, .upper = kLargest}),
    scalar<PunctualLight, &PunctualLight::intensity>({.name = "intensity",
                                                      .label = "intensity",
                                                      .unit = "cd or lx",
                                                      .upper = kLargest,
                                                      .slider_upper = 10000,
                                                      .logarithmic = true}),
    {{.name = "position",
      .label = "position",
      .unit = "m",
      .kind = Kind::vector3,
      .lower = -kLargest,
      .upper = kLargest},
     read_components<PunctualLight, &PunctualLight::position>,
     write_components<PunctualLight, &PunctualLight::position>},
    {{.name = "direction", .label = "direction", .kind = Kind::vector3, .lower = -1},
     read_components<PunctualLight, &PunctualLight::direction>,
     [](PunctualLight& light, const ParameterValue& v) {
         const Vec3d direction(v[0], v[1], v[2]);
         const double size = length(direction);
         if (size > 0) light.direction = Vec3f(direction / size);
     }},
    scalar<PunctualLight, &PunctualLight::angular_diameter>(
        {.name = "angular_diameter",
         .label = "angularDiameter",
         .unit = "rad",
         .upper = 3.1415925,
         .slider_upper = 0.1,
         .note = "Above 0 the light is a disc, like the sun's of 0.0093."}),
    scalar<PunctualLight, &PunctualLight::range>({.name = "range",
                                                  .label = "range",
                                                  .unit = "m",
                                                  .lower = 0x1p-20,
                                                  .upper = kUnbounded,
                                                  .slider_lower = 0.01,
                                                  .slider_upper = 1000,
                                                  .logarithmic = true}),
    {{.name = "inner_cone_angle",
      .label = "innerConeAngle",
      .unit = "rad",
      .upper = 1.5707963,
      .slider_upper = 1.5707963},
     read_scalar<PunctualLight, &PunctualLight::inner_cone_angle>,
     [](PunctualLight& light, const ParameterValue& v) {
         light.inner_cone_angle =
             std::min(static_cast<float>(v[0]), std::nextafter(light.outer_cone_angle, 0.0f));
     }},
    {{.name = "outer_cone_angle",
      .label = "outerConeAngle",
      .unit = "rad",
      .lower = 0x1p-10,
      .upper = 1.5707963,
      .slider_lower = 0x1p-10,
      .slider_upper = 1.5707963},
     read_scalar<PunctualLight, &PunctualLight::outer_cone_angle>,
     [](PunctualLight& light, const ParameterValue& v) {
         light.outer_cone_angle = static_cast<float>(v[0]);
         light.inner_cone_angle =
             std::min(light.inner_cone_angle, std::nextafter(light.outer_cone_angle, 0.0f));
     }},
};

constexpr Parameter<Environment> kEnvironmentParameters[] = {
    scalar<Environment, &Environment::intensity>({.name = "intensity",
                                                  .label = "Intensity",
                                                  .upper = kLargest,
                                                  .slider_upper = 10,
                                                  .note = "Multiplies colour, gradient or image."}),
    scalar<Environment, &Environment::rotation_degrees>(
        {.name = "rotation_degrees",
         .label = "Rotation",
         .unit = "\xC2\xB0",
         .lower = -36000,
         .upper = 36000,
         .slider_lower = -180,
         .slider_upper = 180,
         .note = "Counter-clockwise seen from +Y."}),
    components<Environment, &Environment::color>(
        {.name = "color",
         .label = "Colour",
         .kind = Kind::color,
         .upper = kLargest,
         .note = "Used where there is neither gradient nor image."}),
};

constexpr Parameter<CameraController> kCameraParameters[] = {
    {{.name = "position",
      .label = "Position",
      .unit = "m",
      .kind = Kind::vector3,
      .lower = -kLargest,
      .upper = kLargest},
     [](const CameraController& c) {
         const Vec3d& p = c.camera().position;
         return ParameterValue{p.x, p.y, p.z};
     },
     [](CameraController& c, const ParameterValue& v) {
         c.look_from(Vec3d(v[0], v[1], v[2]), c.target());
     }},
    {{.name = "target",
      .label = "Target",
      .unit = "m",
      .kind = Kind::vector3,
      .lower = -kLargest,
      .upper = kLargest},
     [](const CameraController& c) {
         const Vec3d p = c.target();
         return ParameterValue{p.x, p.y, p.z};
     },
     [](CameraController& c, const ParameterValue& v) {
         c.look_from(c.camera().position, Vec3d(v[0], v[1], v[2]));
     }},
    {{.name = "yfov",
      .label = "yfov",
      .unit = "rad",
      .lower = 0x1p-12,
      .upper = 3.1,
      .slider_lower = 0x1p-12,
      .slider_upper = 3.1,
      .note = "Full vertical angle of view."},
     [](const CameraController& c) { return ParameterValue{c.camera().yfov}; },
     [](CameraController& c, const ParameterValue& v) {
         Camera camera = c.camera();
         camera.yfov = v[0];
         c.set_optics(camera);
     }},
    {{.name = "yfov_degrees",
      .label = "yfov",
      .unit = "\xC2\xB0",
      .lower = 0.02,
      .upper = 177,
      .slider_lower = 5,
      .slider_upper = 120,
      .note = "Full vertical angle of view."},
     [](const CameraController& c) { return ParameterValue{c.camera().yfov * kDegreesPerRadian}; },
     [](CameraController& c, const ParameterValue& v) {
         Camera camera = c.camera();
         camera.yfov = v[0] / kDegreesPerRadian;
         c.set_optics(camera);
     }},
    {{.name = "ymag",
      .label = "ymag",
      .unit = "m",
      .lower = 0x1p-30,
      .upper = kLargest,
      .slider_lower = 0.01,
      .slider_upper = 100,
      .logarithmic = true,
      .note = "Half the height of an orthographic view."},
     [](const CameraController& c) { return ParameterValue{c.camera().ymag}; },
     [](CameraController& c, const ParameterValue& v) {
         Camera camera = c.camera();
         camera.xmag *= v[0] / camera.ymag;
         camera.ymag = v[0];
         c.set_optics(camera);
     }},
    {{.name = "aperture_radius",
      .label = "Aperture radius",
      .unit = "m",
      .upper = kLargest,
      .slider_upper = 0.25,
      .logarithmic = true,
      .note = "0 is a pinhole."},
     [](const CameraController& c) { return ParameterValue{c.camera().aperture_radius}; },
     [](CameraController& c, const ParameterValue& v) {
         Camera camera = c.camera();
         camera.aperture_radius = v[0];
         if (camera.aperture_radius > 0 && camera.focus_distance <= 0) {
             camera.focus_distance = c.distance();
         }
         c.set_optics(camera);
     }},
    {{.name = "focus_distance",
      .label = "Focus distance",
      .unit = "m",
      .upper = kLargest,
      .slider_upper = 100,
      .logarithmic = true,
      .note = "Along the axis; matters with an aperture."},
     [](const CameraController& c) { return ParameterValue{c.camera().focus_distance}; },
     [](CameraController& c, const ParameterValue& v) {
         Camera camera = c.camera();
         camera.focus_distance = v[0];
         c.set_optics(camera);
     }},
    {{.name = "lens_shift",
      .label = "Lens shift",
      .kind = Kind::vector2,
      .lower = -10,
      .upper = 10,
      .slider_lower = -1,
      .note = "The view window's centre, in heights of the window."},
     [](const CameraController& c) {
         return ParameterValue{c.camera().lens_shift.x, c.camera().lens_shift.y};
     },
     [](CameraController& c, const ParameterValue& v) {
         Camera camera = c.camera();
         camera.lens_shift = Vec2d(v[0], v[1]);
         c.set_optics(camera);
     }},
};

}  // namespace

std::span<const Parameter<Material>> material_parameters() {
    return kMaterialParameters;
}
std::span<const Parameter<PunctualLight>> light_parameters() {
    return kLightParameters;
}
std::span<const Parameter<Environment>> environment_parameters() {
    return kEnvironmentParameters;
}
std::span<const Parameter<CameraController>> camera_parameters() {
    return kCameraParameters;
}

}  // namespace talbot
