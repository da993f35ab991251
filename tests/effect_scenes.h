// One small scene for every effect, made so that the effect matters in it.
#pragma once

#include <array>
#include <glm/gtc/matrix_transform.hpp>
#include <memory>
#include <string>
#include <utility>

#include "core/session/render_pass.h"
#include "oracles/scene_builder.h"

namespace talbot {

struct EffectScene {
    std::shared_ptr<const Scene> scene;
    Camera camera;
};

// An image from a function of x and y that gives four bytes.
template <typename F>
uint32_t add_texture(SceneDesc& desc, uint32_t size, const F& texel) {
    auto image = std::make_shared<Image8>();
    image->width = image->height = size;
    for (uint32_t y = 0; y < size; ++y) {
        for (uint32_t x = 0; x < size; ++x) {
            const std::array<int, 4> t = texel(x, y);
            for (const int byte : t) image->rgba.push_back(static_cast<uint8_t>(byte));
        }
    }
    Texture texture;
    texture.image = std::move(image);
    desc.textures.push_back(texture);
    return static_cast<uint32_t>(desc.textures.size() - 1);
}

inline TextureSlot slot_of(uint32_t texture) {
    TextureSlot slot;
    slot.texture = texture;
    return slot;
}

// A parallelogram with both sets of texture coordinates.
inline Mesh textured_quad(const Vec3f& p, const Vec3f& a, const Vec3f& b) {
    Mesh mesh = SceneBuilder::quad(p, a, b);
    mesh.uv[0] = {Vec2f(0, 1), Vec2f(1, 1), Vec2f(1, 0), Vec2f(0, 0)};
    mesh.uv[1] = {Vec2f(0.1f, 0.3f), Vec2f(0.4f, 0.3f), Vec2f(0.4f, 0.1f), Vec2f(0.1f, 0.1f)};
    return mesh;
}

// The film of a view as the settings ask, first whole passes from sample 0.
inline Film render_view(const PreparedView& view, const RenderSettings& settings, uint64_t passes,
                        WorkerPool& pool) {
    ViewMoments moments(view);
    Film film(settings.width, settings.height);
    std::stop_source stop;
    TileCounts counts;
    render_pass(moments, settings, passes, film, pool, stop, {}, counts);
    return film;
}

namespace detail {

inline std::array<int, 4> checker(uint32_t x, uint32_t y) {
    return (x / 2 + y / 2) % 2 == 0 ? std::array{230, 60, 30, 255} : std::array{20, 90, 200, 0};
}

// The material of the wall in front of the camera, and what its textures are.
inline Material effect_material(Effect effect, SceneDesc& desc) {
    Material m = SceneBuilder::diffuse(0.5f);
    const auto checkers = [&] { return slot_of(add_texture(desc, 8, checker)); };
    switch (effect) {
        case Effect::uv_transform:
        case Effect::second_uv:
        case Effect::base_color_texture:
        case Effect::depth_of_field:
        case Effect::motion:
            m.base_color_texture = checkers();
            if (effect == Effect::second_uv) m.base_color_texture.uv_set = 1;
            if (effect == Effect::uv_transform) {
                m.base_color_texture.has_transform = true;
                m.base_color_texture.transform_u = Vec3f(0.3f, 0, 0.1f);
            }
            break;
        case Effect::metallic_roughness_texture:
            m.metallic_factor = m.specular_factor = 1;
            m.metallic_roughness_texture = checkers();
            break;
        case Effect::normal_map:
            m.normal_texture = slot_of(add_texture(desc, 8, [](uint32_t x, uint32_t y) {
                return (x / 2 + y / 2) % 2 == 0 ? std::array{230, 128, 190, 255}
                                                : std::array{128, 30, 190, 255};
            }));
            break;
        case Effect::emissive_texture:
            m.emissive_factor = Rgb(1);
            m.emissive_texture = checkers();
            break;
        case Effect::emissive_meshes:
            m.emissive_factor = Rgb(1);
            break;
        case Effect::glossy:
            m.metallic_factor = 1;
            m.roughness_factor = 0.3f;
            break;
        case Effect::specular:
            m.base_color_factor = Vec4f(0.05f, 0.05f, 0.05f, 1);
            m.specular_factor = 0.1f;
            m.roughness_factor = 0.5f;
            break;
        case Effect::alpha_mask:
            m.base_color_texture = checkers();
            m.alpha_mode = AlphaMode::mask;
            break;
        case Effect::alpha_blend:
            m.base_color_factor.w = 0.5f;
            m.alpha_mode = AlphaMode::blend;
            break;
        case Effect::single_sided:
            m.double_sided = false;
            break;
        case Effect::transmission:
        case Effect::thin_wall:
            m.transmission_factor = 1;
            m.specular_factor = 1;
            m.roughness_factor = 0.2f;
            break;
        case Effect::volume_absorption:
        case Effect::scattering_medium:
        case Effect::dispersion:
            m.base_color_factor = Vec4f(1);
            m.transmission_factor = m.specular_factor = m.thickness_factor = 1;
            m.roughness_factor = 0;
            if (effect == Effect::dispersion) {
                m.dispersion = 10;
            } else {
                m.attenuation_distance = 0.5f;
                m.attenuation_color = Rgb(0.2f, 0.8f, 0.5f);
                if (effect == Effect::scattering_medium) m.multiscatter_color = Rgb(0.8f);
            }
            break;
        case Effect::unlit:
            m.unlit = true;
            break;
        case Effect::diffuse_transmission:
            m.diffuse_transmission_factor = 0.9f;
            break;
        case Effect::clearcoat:
            m.base_color_factor = Vec4f(0.05f, 0.05f, 0.05f, 1);
            m.clearcoat_factor = 1;
            m.clearcoat_roughness_factor = 0.5f;
            break;
        case Effect::sheen:
            m.base_color_factor = Vec4f(0.05f, 0.05f, 0.05f, 1);
            m.sheen_color_factor = Rgb(1, 0.8f, 0.6f);
            m.sheen_roughness_factor = 0.5f;
            break;
        case Effect::anisotropy:
            m.metallic_factor = 1;
            m.roughness_factor = 0.4f;
            m.anisotropy_strength = 0.9f;
            break;
        case Effect::iridescence:
            m.metallic_factor = 1;
            m.roughness_factor = 0.4f;
            m.iridescence_factor = 1;
            break;
        default:
            break;
    }
    return m;
}

// A grid of so many triangles that two copies are worth sharing.
inline Mesh fine_grid() {
    Mesh mesh;
    constexpr uint32_t kCells = 40;
    for (uint32_t y = 0; y <= kCells; ++y) {
        for (uint32_t x = 0; x <= kCells; ++x) {
            mesh.positions.emplace_back(static_cast<float>(x) / kCells - 0.5f,
                                        static_cast<float>(y) / kCells - 0.5f, 0);
            if (x == kCells || y == kCells) continue;
            const uint32_t i = y * (kCells + 1) + x;
            for (const uint32_t k : {i, i + 1, i + kCells + 2, i, i + kCells + 2, i + kCells + 1})
                mesh.indices.push_back(k);
        }
    }
    return mesh;
}

}  // namespace detail

// The scene in motion for a second, in which all that is in it goes half a metre to the right.
inline std::shared_ptr<const Scene> sweep(const SceneDesc& desc, WorkerPool& pool) {
    SceneMotion motion;
    motion.shutter = 1;
    motion.witness = "everything";
    motion.materials = desc.materials;
    motion.lights = desc.lights;
    motion.moment = [desc](double seconds, WorkerPool& workers, std::shared_ptr<const Scene>,
                           const std::stop_token&) {
        SceneDesc moved = desc;
        for (MeshInstance& instance : moved.instances)
            instance.world_from_object[3].x += 0.5 * seconds;
        return Scene::build(std::move(moved), workers);
    };
    return Scene::build(desc, pool)
        ->with_motion(std::make_shared<const SceneMotion>(std::move(motion)));
}

// A wall in front of the camera, lit from above and from behind, before a dim coloured sky.
inline EffectScene make_effect_scene(Effect effect, WorkerPool& pool) {
    SceneBuilder builder;
    EffectScene made;
    made.camera = camera_at(Vec3d(0.3, 0.4, 3), Vec3d(0));
    if (effect == Effect::depth_of_field) {
        made.camera.aperture_radius = 0.2;
        made.camera.focus_distance = 1;
    }
    const uint32_t material = builder.material(detail::effect_material(effect, builder.desc()));
    builder.desc().materials[material].name = "effect";
    Mesh wall = textured_quad(Vec3f(-1, -1, 0), Vec3f(2, 0, 0), Vec3f(0, 2, 0));
    if (effect == Effect::single_sided)
        wall = textured_quad(Vec3f(1, -1, 0), Vec3f(-2, 0, 0), Vec3f(0, 2, 0));
    if (effect == Effect::vertex_color)
        wall.colors = {Vec4f(1, 0, 0, 1), Vec4f(0, 1, 0, 1), Vec4f(0, 0, 1, 1), Vec4f(1)};
    if (effect == Effect::volume_absorption || effect == Effect::scattering_medium) {
        builder.mesh(SceneBuilder::box(Vec3f(-0.8f), Vec3f(0.8f)), material);
    } else if (effect == Effect::dispersion || effect == Effect::analytic_spheres) {
        builder.sphere(Vec3d(0), 0.9, material);
    } else if (effect == Effect::instancing) {
        builder.mesh(detail::fine_grid(), material, glm::translate(Mat4d(1), Vec3d(-0.6, 0, 0)));
        builder.instance(0, glm::translate(Mat4d(1), Vec3d(0.6, 0, 0)));
    } else {
        builder.mesh(std::move(wall), material);
    }
    Material back = SceneBuilder::diffuse(0.8f);
    if (effect == Effect::dispersion) {
        back.emissive_factor = Rgb(1);
        back.emissive_texture = slot_of(add_texture(builder.desc(), 16, [](uint32_t x, uint32_t) {
            return x % 2 == 0 ? std::array{255, 255, 255, 255} : std::array{0, 0, 0, 255};
        }));
    }
    builder.mesh(textured_quad(Vec3f(-3, -3, -2), Vec3f(6, 0, 0), Vec3f(0, 6, 0)),
                 builder.material(back));
    Environment& sky = builder.desc().environment;
    sky.gradient =
        EnvironmentGradient{Vec3f(0, 1, 0), Rgb(0.1f, 0.1f, 0.2f), Rgb(0.6f, 0.5f, 0.3f)};
    if (effect == Effect::environment_image) {
        auto image = std::make_shared<EnvironmentImage>();
        image->width = 16;
        image->height = 8;
        for (uint32_t i = 0; i < 128; ++i) image->texels.emplace_back(i % 16 < 8 ? 1.0f : 0.1f);
        sky.image = std::move(image);
    }
    const int lights = effect == Effect::many_lights ? 2 : 1;
    for (int i = 0; i < lights; ++i) {
        PunctualLight light;
        light.name = "lamp";
        light.position = Vec3d(1 - 2 * i, 2, effect == Effect::diffuse_transmission ? -1 : 2);
        light.intensity = 8;
        light.color = i == 0 ? Rgb(1, 0.9f, 0.8f) : Rgb(0.2f, 0.4f, 1);
        builder.light(light);
    }
    made.scene = effect == Effect::motion ? sweep(builder.desc(), pool) : builder.build(pool);
    return made;
}

}  // namespace talbot
