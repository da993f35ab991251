// Renders one of the rooms of effects_cost.py: bench_effects_cost_room ROOM SIZE. Prints the kernel
// that runs, the film's hash and the effects in use as JSON. Runs on one thread, for callgrind.
#include <cstdio>
#include <cstdlib>
#include <string>

#include "core/integrate/tiers.h"
#include "core/scene/effects_off.h"
#include "oracles/scene_builder.h"

namespace talbot {
namespace {

constexpr uint64_t kPasses = 2;

uint32_t checker(SceneDesc& desc, int dark_alpha) {
    auto image = std::make_shared<Image8>();
    image->width = image->height = 16;
    for (uint32_t i = 0; i < 256; ++i) {
        const bool bright = (i / 4 + i / 64) % 2 == 0;
        for (const int byte :
             {bright ? 230 : 20, 120, bright ? 40 : 200, bright ? 255 : dark_alpha})
            image->rgba.push_back(static_cast<uint8_t>(byte));
    }
    Texture texture;
    texture.image = std::move(image);
    desc.textures.push_back(texture);
    return static_cast<uint32_t>(desc.textures.size() - 1);
}

// What the room is made of, or the two boxes in it alone: it decides the kernel and the surfaces'
// code.
Material material_of(const std::string& room, SceneDesc& desc) {
    Material m;
    m.base_color_factor = Vec4f(0.8f, 0.8f, 0.8f, 1);
    m.metallic_factor = 0;
    m.roughness_factor = 0.6f;
    m.double_sided = true;
    if (room == "textured") {
        m.base_color_texture.texture = checker(desc, 255);
    } else if (room == "textured-roughness") {
        m.metallic_factor = 0.8f;
        m.metallic_roughness_texture.texture = checker(desc, 255);
    } else if (room == "transmissive") {
        m.transmission_factor = m.thickness_factor = 1;
    } else if (room == "transmissive-mask") {
        m.alpha_mode = AlphaMode::mask;
        m.base_color_texture.texture = checker(desc, 0);
    }
    // Two layers of different extensions need the full code.
    if (room == "full" || room == "full-coat") {
        m.clearcoat_factor = 1;
        m.clearcoat_roughness_factor = 0.2f;
    }
    if (room == "full" || room == "full-sheen") {
        m.sheen_color_factor = Rgb(1);
        m.sheen_roughness_factor = 0.5f;
    }
    if (room == "full-coat" || room == "full-sheen") m.anisotropy_strength = 0.5f;
    return m;
}

std::shared_ptr<const Scene> make_room(const std::string& room, WorkerPool& pool) {
    SceneBuilder builder;
    Material thing = material_of(room, builder.desc());
    if (room.starts_with("matte")) thing.specular_factor = 0;
    const bool all_alike = room.starts_with("full") || room.starts_with("textured");
    const auto wall = [&](const Vec3f& color) {
        Material m = all_alike ? thing : material_of("plain", builder.desc());
        m.base_color_factor = Vec4f(color, 1);
        m.specular_factor = thing.specular_factor;
        return m;
    };
    const auto quad = [&](const Vec3f& p, const Vec3f& a, const Vec3f& b, uint32_t material) {
        Mesh mesh = SceneBuilder::quad(p, a, b);
        mesh.uv[0] = {Vec2f(0, 1), Vec2f(1, 1), Vec2f(1, 0), Vec2f(0, 0)};
        builder.mesh(std::move(mesh), material);
    };
    const uint32_t white = builder.material(wall(Vec3f(0.7f)));
    const Vec3f x(2, 0, 0), y(0, 2, 0), z(0, 0, 2);
    quad(Vec3f(-1), x, y, white);
    quad(Vec3f(-1), z, x, white);
    quad(Vec3f(-1, 1, -1), x, z, white);
    quad(Vec3f(-1), y, z, builder.material(wall(Vec3f(0.6f, 0.1f, 0.1f))));
    quad(Vec3f(1, -1, -1), z, y, builder.material(wall(Vec3f(0.1f, 0.5f, 0.1f))));
    const uint32_t material = builder.material(thing);
    for (const auto& [lower, upper] :
         {std::pair(Vec3f(-0.6f, -1, -0.6f), Vec3f(-0.05f, 0.2f, -0.1f)),
          std::pair(Vec3f(0.1f, -1, -0.2f), Vec3f(0.6f, -0.4f, 0.4f))}) {
        Mesh box = SceneBuilder::box(lower, upper);
        for (const Vec3f& p : box.positions) box.uv[0].emplace_back(p.x + p.z, p.y);
        builder.mesh(std::move(box), material);
    }
    if (room == "matte-punctual") {
        PunctualLight light;
        light.position = Vec3d(0, 0.8, 0);
        light.intensity = 2;
        builder.light(light);
    } else {
        Material lamp = wall(Vec3f(0));
        lamp.emissive_factor = Rgb(5);
        quad(Vec3f(-0.3f, 0.98f, -0.3f), 0.3f * x, 0.3f * z, builder.material(lamp));
    }
    return builder.build(pool);
}

}  // namespace
}  // namespace talbot

int main(int argc, char** argv) {
    using namespace talbot;
    const int size = argc == 3 ? std::atoi(argv[2]) : 0;
    if (size < 1) {
        std::fprintf(stderr, "usage: bench_effects_cost_room ROOM SIZE\n");
        return 2;
    }
    WorkerPool pool(1);
    const std::shared_ptr<const Scene> scene = make_room(argv[1], pool);
    const Camera camera = camera_at(Vec3d(0, 0, 3.8), Vec3d(0));
    const EffectSet effects = analyse_effects(*scene, camera).active;
    PathSettings settings;
    const auto side = static_cast<uint32_t>(size);
    const Film film = render_film(scene, camera, settings, side, side, kPasses, pool);
    std::printf("{\"kernel\": \"%s\", \"film_hash\": \"%s\", \"effects\": \"%s\"}\n",
                std::string(kTiers[smallest_tier(effects)].name).c_str(), film.hash().c_str(),
                effect_names(effects).c_str());
    return 0;
}
