#include "core/scene/effects_off.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace talbot {
namespace {

constexpr EffectSet kGeometryEffects =
    (Effect::vertex_color | Effect::analytic_spheres) | Effect::instancing;

Material material_without(Material m, EffectSet off) {
    const auto drop = [](TextureSlot& slot) { slot = TextureSlot{}; };
    if (off.has(Effect::base_color_texture)) drop(m.base_color_texture);
    if (off.has(Effect::metallic_roughness_texture)) drop(m.metallic_roughness_texture);
    if (off.has(Effect::normal_map)) drop(m.normal_texture);
    if (off.has(Effect::emissive_texture)) drop(m.emissive_texture);
    for (TextureSlot Material::*slot : kTextureSlots) {
        if (off.has(Effect::second_uv)) (m.*slot).uv_set = 0;
        if (off.has(Effect::uv_transform)) (m.*slot).has_transform = false;
    }
    if (off.has(Effect::specular)) {
        m.specular_factor = 1;
        m.specular_color_factor = Rgb(1);
        drop(m.specular_texture);
        drop(m.specular_color_texture);
    }
    if (off.has(Effect::glossy)) {
        m.metallic_factor = 0;
        m.specular_factor = 0;
        drop(m.metallic_roughness_texture);
    }
    if (off.has(Effect::alpha_mask) && m.alpha_mode == AlphaMode::mask)
        m.alpha_mode = AlphaMode::opaque;
    if (off.has(Effect::alpha_blend) && m.alpha_mode == AlphaMode::blend)
        m.alpha_mode = AlphaMode::opaque;
    // Lamps keep the side that they shine to.
    if (off.has(Effect::single_sided) && !m.is_emissive()) m.double_sided = true;
    const bool thin = !(m.thickness_factor > 0);
    if (off.has(Effect::transmission) || (off.has(Effect::thin_wall) && thin))
        m.transmission_factor = 0;
    if (off.has(Effect::volume_absorption))
        m.attenuation_distance = std::numeric_limits<float>::infinity();
    if (off.has(Effect::scattering_medium)) m.multiscatter_color = Rgb(0);
    if (off.has(Effect::unlit)) m.unlit = false;
    if (off.has(Effect::diffuse_transmission)) m.diffuse_transmission_factor = 0;
    if (off.has(Effect::clearcoat)) m.clearcoat_factor = 0;
    if (off.has(Effect::sheen)) m.sheen_color_factor = Rgb(0);
    if (off.has(Effect::anisotropy)) m.anisotropy_strength = 0;
    if (off.has(Effect::iridescence)) m.iridescence_factor = 0;
    if (off.has(Effect::dispersion)) m.dispersion = 0;
    if (off.has(Effect::emissive_meshes)) m.emissive_factor = Rgb(0);
    return m;
}

// Mean radiance over the sphere, rows weighted by their height.
Rgb mean_radiance(const EnvironmentImage& image) {
    Vec3d sum(0);
    double weights = 0;
    for (uint32_t y = 0; y < image.height; ++y) {
        const double weight = std::sin(std::numbers::pi * (y + 0.5) / image.height);
        weights += weight * image.width;
        for (uint32_t x = 0; x < image.width; ++x)
            sum += weight * Vec3d(image.texels[std::size_t{y} * image.width + x]);
    }
    return weights > 0 ? Rgb(sum / weights) : Rgb(0);
}

Environment environment_without(Environment environment, EffectSet off) {
    if (off.has(Effect::environment)) {
        environment = Environment{};
    } else if (off.has(Effect::environment_image) && environment.image) {
        environment.color = mean_radiance(*environment.image);
        environment.image = nullptr;
        environment.gradient.reset();
    }
    return environment;
}

double world_area(const SceneGeometry& geometry, const SceneInstance& instance) {
    const Mesh& mesh = geometry.meshes[instance.mesh];
    double area = 0;
    for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
        const auto corner = [&](std::size_t k) {
            return Vec3d(instance.world_from_object *
                         Vec4d(Vec3d(mesh.positions[mesh.indices[i + k]]), 1.0));
        };
        const Vec3d a = corner(0);
        area += 0.5 * length(cross(corner(1) - a, corner(2) - a));
    }
    return area;
}

// Leaves the one source, an emissive material or a punctual light, that sends most.
void keep_strongest_source(const Scene& scene, std::vector<Material>& materials,
                           std::vector<PunctualLight>& lights) {
    const SceneGeometry& geometry = scene.geometry();
    std::vector<double> power(materials.size() + lights.size(), 0);
    const auto radiance = [&](uint32_t material) {
        const Material& m = materials[material];
        return m.is_emissive() && !m.unlit
                   ? static_cast<double>(luminance(m.emissive_factor * m.emissive_strength))
                   : 0.0;
    };
    for (const SceneInstance& instance : geometry.instances) {
        const double nits = radiance(instance.material);
        if (nits > 0)
            power[instance.material] += std::numbers::pi * nits * world_area(geometry, instance);
    }
    for (const Sphere& sphere : geometry.spheres) {
        power[sphere.material] += radiance(sphere.material) * 4 * std::numbers::pi *
                                  std::numbers::pi * sphere.radius * sphere.radius;
    }
    for (std::size_t i = 0; i < lights.size(); ++i) {
        power[materials.size() + i] = 4 * std::numbers::pi * lights[i].intensity *
                                      static_cast<double>(luminance(lights[i].color));
    }
    const auto strongest =
        static_cast<std::size_t>(std::max_element(power.begin(), power.end()) - power.begin());
    for (std::size_t i = 0; i < materials.size(); ++i) {
        if (i != strongest) materials[i].emissive_factor = Rgb(0);
    }
    for (std::size_t i = 0; i < lights.size(); ++i) {
        if (materials.size() + i != strongest) lights[i].intensity = 0;
    }
}

}  // namespace

std::optional<std::string> parse_effect_list(std::string_view text, EffectSet& on, EffectSet& off) {
    std::size_t start = 0;
    while (start <= text.size()) {
        const std::size_t comma = std::min(text.find(',', start), text.size());
        const std::string_view word = text.substr(start, comma - start);
        start = comma + 1;
        if (word == "auto") {
            on = off = EffectSet{};
            continue;
        }
        if (word == "all") {
            on = EffectSet::all();
            off = EffectSet{};
            continue;
        }
        const bool negative = !word.empty() && word.front() == '-';
        const std::optional<Effect> effect = effect_from_name(negative ? word.substr(1) : word);
        if (!effect) return std::string(word);
        (negative ? off : on).add(*effect);
        (negative ? on : off).remove(*effect);
    }
    return std::nullopt;
}

std::string effect_names(EffectSet effects) {
    std::string names;
    for (const EffectInfo& info : kEffects) {
        if (!effects.has(info.effect)) continue;
        if (!names.empty()) names += ',';
        names += info.name;
    }
    return names;
}

std::string_view without_effect_text(Effect effect) {
    switch (effect) {
        case Effect::single_sided:
            return "the camera sees both sides, but for lamps";
        case Effect::thin_wall:
            return "thin transmissive walls are opaque";
        case Effect::environment:
            return "no light from outside";
        case Effect::environment_image:
            return "the image's mean colour from everywhere";
        case Effect::many_lights:
            return "only the strongest source shines";
        case Effect::analytic_spheres:
            return "the spheres are missing";
        case Effect::instancing:
            return "what is placed through the second level is missing";
        case Effect::depth_of_field:
            return "a pinhole";
        case Effect::motion:
            return "the moment at which the shutter opens";
        case Effect::second_uv:
            return "the first set is used instead";
        default:
            return "its part of the materials or lights is missing";
    }
}

std::shared_ptr<const SceneGeometry> geometry_without(std::shared_ptr<const SceneGeometry> geometry,
                                                      EffectSet off, WorkerPool& pool) {
    if ((off & kGeometryEffects) == EffectSet{}) return geometry;
    auto without = std::make_shared<SceneGeometry>(*geometry);
    if (off.has(Effect::vertex_color)) {
        for (Mesh& mesh : without->meshes) mesh.colors.clear();
    }
    bool rebuild = false;
    if (off.has(Effect::analytic_spheres) && !without->spheres.empty()) {
        without->spheres.clear();
        rebuild = true;
    }
    if (off.has(Effect::instancing)) {
        rebuild = std::erase_if(without->instances,
                                [](const SceneInstance& i) { return !i.identity; }) > 0 ||
                  rebuild;
    }
    if (rebuild) {
        without->accel = build_accel(accel_input(*without, BuildQuality::high), pool);
        without->bounds = without->accel->bounds();
    }
    return without;
}

std::shared_ptr<const Scene> scene_without(const std::shared_ptr<const Scene>& scene, EffectSet off,
                                           std::shared_ptr<const SceneGeometry> geometry) {
    if (off == EffectSet{}) return scene;
    std::vector<Material> materials;
    for (const Material& m : scene->materials()) materials.push_back(material_without(m, off));
    std::vector<PunctualLight> lights = scene->punctual_lights();
    if (off.has(Effect::punctual_lights)) {
        for (PunctualLight& light : lights) light.intensity = 0;
    }
    const std::shared_ptr<const Scene> placed = scene->with_geometry(std::move(geometry));
    if (off.has(Effect::many_lights)) keep_strongest_source(*placed, materials, lights);
    std::shared_ptr<const Scene> without = placed->with_materials(std::move(materials));
    for (uint32_t i = 0; i < lights.size(); ++i) {
        if (!(lights[i] == scene->punctual_lights()[i]))
            without = without->with_punctual_light(i, lights[i]);
    }
    const Environment environment = environment_without(scene->environment(), off);
    if (!(environment == scene->environment())) without = without->with_environment(environment);
    if (off.has(Effect::motion) && without->motion()) without = without->with_motion(nullptr);
    return without;
}

Camera camera_without(Camera camera, EffectSet off) {
    if (off.has(Effect::depth_of_field)) camera.aperture_radius = 0;
    return camera;
}

}  // namespace talbot
