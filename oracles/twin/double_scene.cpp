// Every structure is taken apart by structured bindings, which name all of its members: a member
// that is added to the core does not compile here until it is carried over.
#include "oracles/twin/double_scene.h"

namespace twin {
namespace {

namespace from = talbot;
namespace to = talbot_double;

double widen(float x) {
    return static_cast<double>(x);
}
to::Vec2f widen(const from::Vec2f& v) {
    return to::Vec2f(v);
}
to::Vec3f widen(const from::Vec3f& v) {
    return to::Vec3f(v);
}
to::Vec4f widen(const from::Vec4f& v) {
    return to::Vec4f(v);
}

to::Texture widen(const from::Texture& texture);
to::Material widen(const from::Material& m);
to::Mesh widen(const from::Mesh& mesh);
to::MeshInstance widen(const from::MeshInstance& instance);
to::Sphere widen(const from::Sphere& sphere);
to::Object widen(const from::Object& object);
to::PunctualLight widen(const from::PunctualLight& light);
to::Camera widen(const from::Camera& camera);
to::ExtensionUse widen(const from::ExtensionUse& use);

template <typename Wide, typename Narrow>
std::vector<Wide> widen_all(const std::vector<Narrow>& list) {
    std::vector<Wide> wide;
    wide.reserve(list.size());
    for (const Narrow& x : list) wide.push_back(widen(x));
    return wide;
}

to::TextureSlot widen(const from::TextureSlot& slot) {
    const auto& [texture, uv_set, has_transform, transform_u, transform_v] = slot;
    return {texture, uv_set, has_transform, widen(transform_u), widen(transform_v)};
}

to::Texture widen(const from::Texture& texture) {
    const auto& [image, wrap_u, wrap_v, filter, levels, level_filter] = texture;
    to::Texture wide;
    if (image) {
        const auto& [width, height, rgba, name] = *image;
        wide.image = std::make_shared<const to::Image8>(to::Image8{width, height, rgba, name});
    }
    wide.wrap_u = static_cast<to::TextureWrap>(wrap_u);
    wide.wrap_v = static_cast<to::TextureWrap>(wrap_v);
    wide.filter = static_cast<to::TextureFilter>(filter);
    wide.levels = static_cast<to::TextureLevels>(levels);
    wide.level_filter = static_cast<to::TextureFilter>(level_filter);
    return wide;
}

to::Material widen(const from::Material& m) {
    const auto& [name, base_color_factor, base_color_texture, metallic_factor, roughness_factor,
                 metallic_roughness_texture, normal_texture, normal_scale, emissive_factor,
                 emissive_strength, emissive_texture, alpha_mode, alpha_cutoff, double_sided, unlit,
                 ior, specular_factor, specular_texture, specular_color_factor,
                 specular_color_texture, transmission_factor, transmission_texture,
                 thickness_factor, attenuation_color, attenuation_distance, multiscatter_color,
                 scatter_anisotropy, nested_priority, dispersion, diffuse_transmission_factor,
                 diffuse_transmission_texture, diffuse_transmission_color_factor,
                 diffuse_transmission_color_texture, clearcoat_factor, clearcoat_texture,
                 clearcoat_roughness_factor, clearcoat_roughness_texture, clearcoat_normal_texture,
                 clearcoat_normal_scale, sheen_color_factor, sheen_color_texture,
                 sheen_roughness_factor, sheen_roughness_texture, anisotropy_strength,
                 anisotropy_rotation, anisotropy_texture, iridescence_factor, iridescence_texture,
                 iridescence_ior, iridescence_thickness_minimum, iridescence_thickness_maximum,
                 iridescence_thickness_texture] = m;
    return {name,
            widen(base_color_factor),
            widen(base_color_texture),
            widen(metallic_factor),
            widen(roughness_factor),
            widen(metallic_roughness_texture),
            widen(normal_texture),
            widen(normal_scale),
            widen(emissive_factor),
            widen(emissive_strength),
            widen(emissive_texture),
            static_cast<to::AlphaMode>(alpha_mode),
            widen(alpha_cutoff),
            double_sided,
            unlit,
            widen(ior),
            widen(specular_factor),
            widen(specular_texture),
            widen(specular_color_factor),
            widen(specular_color_texture),
            widen(transmission_factor),
            widen(transmission_texture),
            widen(thickness_factor),
            widen(attenuation_color),
            widen(attenuation_distance),
            widen(multiscatter_color),
            widen(scatter_anisotropy),
            widen(nested_priority),
            widen(dispersion),
            widen(diffuse_transmission_factor),
            widen(diffuse_transmission_texture),
            widen(diffuse_transmission_color_factor),
            widen(diffuse_transmission_color_texture),
            widen(clearcoat_factor),
            widen(clearcoat_texture),
            widen(clearcoat_roughness_factor),
            widen(clearcoat_roughness_texture),
            widen(clearcoat_normal_texture),
            widen(clearcoat_normal_scale),
            widen(sheen_color_factor),
            widen(sheen_color_texture),
            widen(sheen_roughness_factor),
            widen(sheen_roughness_texture),
            widen(anisotropy_strength),
            widen(anisotropy_rotation),
            widen(anisotropy_texture),
            widen(iridescence_factor),
            widen(iridescence_texture),
            widen(iridescence_ior),
            widen(iridescence_thickness_minimum),
            widen(iridescence_thickness_maximum),
            widen(iridescence_thickness_texture)};
}

to::Mesh widen(const from::Mesh& mesh) {
    const auto& [name, positions, normals, tangents, uv, colors, indices, material] = mesh;
    return {name,
            widen_all<to::Vec3f>(positions),
            widen_all<to::Vec3f>(normals),
            widen_all<to::Vec4f>(tangents),
            {widen_all<to::Vec2f>(uv[0]), widen_all<to::Vec2f>(uv[1])},
            widen_all<to::Vec4f>(colors),
            indices,
            material};
}

to::MeshInstance widen(const from::MeshInstance& instance) {
    const auto& [mesh, object, world_from_object] = instance;
    return {mesh, object, world_from_object};
}

to::Sphere widen(const from::Sphere& sphere) {
    const auto& [center, radius, material, object] = sphere;
    return {center, radius, material, object};
}

to::Object widen(const from::Object& object) {
    const auto& [name] = object;
    return {name};
}

to::PunctualLight widen(const from::PunctualLight& light) {
    const auto& [name, kind, color, intensity, position, direction, range, inner_cone_angle,
                 outer_cone_angle, angular_diameter] = light;
    return {name,
            static_cast<to::PunctualKind>(kind),
            widen(color),
            widen(intensity),
            position,
            widen(direction),
            widen(range),
            widen(inner_cone_angle),
            widen(outer_cone_angle),
            widen(angular_diameter)};
}

to::Environment widen(const from::Environment& environment) {
    const auto& [color, gradient, image, rotation_degrees, intensity] = environment;
    to::Environment wide;
    wide.color = widen(color);
    if (gradient) {
        const auto& [axis, start, end] = *gradient;
        wide.gradient = to::EnvironmentGradient{widen(axis), widen(start), widen(end)};
    }
    if (image) {
        const auto& [width, height, texels, file, sha256, repaired_texels] = *image;
        wide.image = std::make_shared<const to::EnvironmentImage>(to::EnvironmentImage{
            width, height, widen_all<to::Rgb>(texels), file, sha256, repaired_texels});
    }
    wide.rotation_degrees = widen(rotation_degrees);
    wide.intensity = widen(intensity);
    return wide;
}

to::ExtensionUse widen(const from::ExtensionUse& use) {
    const auto& [name, required, supported] = use;
    return {name, required, supported};
}

to::Camera widen(const from::Camera& camera) {
    const auto& [name, kind, position, right, up, backward, yfov, aspect_ratio, xmag, ymag,
                 lens_shift, aperture_radius, focus_distance, resolution] = camera;
    to::Camera wide{name,
                    static_cast<to::CameraKind>(kind),
                    position,
                    right,
                    up,
                    backward,
                    yfov,
                    aspect_ratio,
                    xmag,
                    ymag,
                    lens_shift,
                    aperture_radius,
                    focus_distance,
                    {}};
    if (resolution) wide.resolution = to::Resolution{resolution->width, resolution->height};
    return wide;
}

}  // namespace

to::SceneDesc to_double(const from::SceneDesc& desc) {
    const auto& [file, name, sha256, reading, textures, materials, meshes, instances, spheres,
                 objects, lights, cameras, environment, extensions, warnings] = desc;
    return {file,
            name,
            sha256,
            reading,
            widen_all<to::Texture>(textures),
            widen_all<to::Material>(materials),
            widen_all<to::Mesh>(meshes),
            widen_all<to::MeshInstance>(instances),
            widen_all<to::Sphere>(spheres),
            widen_all<to::Object>(objects),
            widen_all<to::PunctualLight>(lights),
            widen_all<to::Camera>(cameras),
            widen(environment),
            widen_all<to::ExtensionUse>(extensions),
            warnings};
}

to::Camera to_double(const from::Camera& camera) {
    return widen(camera);
}

to::PathSettings to_double(const from::PathSettings& settings) {
    const auto& [max_depth, sampler, filter, russian_roulette, next_event_estimation,
                 transparent_background, seed] = settings;
    return {max_depth,
            static_cast<to::SamplerKind>(sampler),
            static_cast<to::FilterKind>(filter),
            russian_roulette,
            next_event_estimation,
            transparent_background,
            seed};
}

}  // namespace twin
