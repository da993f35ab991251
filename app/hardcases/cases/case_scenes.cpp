#include "app/hardcases/cases/case_scenes.h"

#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <numbers>
#include <span>
#include <stop_token>

#include "app/hardcases/cases/case_run.h"
#include "core/accuracy/metrics.h"
#include "core/integrate/tiers.h"
#include "core/io/gltf_loader.h"
#include "core/io/image_io.h"
#include "core/session/render_pass.h"

namespace talbot::hardcases::geometry {

Material diffuse(const Rgb& reflectance) {
    Material m;
    m.base_color_factor = Vec4f(reflectance, 1);
    m.metallic_factor = 0;
    m.specular_factor = 0;
    m.double_sided = true;
    return m;
}

Material emitter(const Rgb& radiance) {
    Material m = diffuse(Rgb(0));
    m.emissive_factor = radiance / max_component(radiance);
    m.emissive_strength = max_component(radiance);
    return m;
}

Material glass(float ior, const Rgb& color, float distance) {
    Material m;
    m.metallic_factor = 0;
    m.roughness_factor = 0;
    m.transmission_factor = 1;
    m.thickness_factor = 1;
    m.ior = ior;
    m.attenuation_color = color;
    m.attenuation_distance = distance;
    m.double_sided = true;
    return m;
}

Mesh quad_mesh(const Vec3f& corner, const Vec3f& edge1, const Vec3f& edge2) {
    Mesh m;
    m.positions = {corner, corner + edge1, corner + edge1 + edge2, corner + edge2};
    m.indices = {0, 1, 2, 0, 2, 3};
    return m;
}

Mesh box_mesh(const Vec3f& lower, const Vec3f& upper) {
    Mesh m;
    for (int i = 0; i < 8; ++i) {
        m.positions.emplace_back((i & 1) != 0 ? upper.x : lower.x, (i & 2) != 0 ? upper.y : lower.y,
                                 (i & 4) != 0 ? upper.z : lower.z);
    }
    m.indices = {0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5, 0, 1, 5, 0, 5, 4,
                 2, 6, 7, 2, 7, 3, 0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6};
    return m;
}

Mesh uv_sphere_mesh(uint32_t stacks, uint32_t slices) {
    Mesh m;
    for (uint32_t i = 0; i <= stacks; ++i) {
        for (uint32_t j = 0; j <= slices; ++j) {
            const double theta = std::numbers::pi * i / stacks;
            const double phi = 2 * std::numbers::pi * (j % slices) / slices;
            const Vec3d p(std::sin(theta) * std::cos(phi), std::cos(theta),
                          -std::sin(theta) * std::sin(phi));
            m.positions.push_back(Vec3f(p));
            m.normals.push_back(Vec3f(p));
        }
    }
    for (uint32_t i = 0; i < stacks; ++i) {
        for (uint32_t j = 0; j < slices; ++j) {
            const uint32_t a = i * (slices + 1) + j;
            const uint32_t b = a + slices + 1;
            if (i > 0) m.indices.insert(m.indices.end(), {a, b + 1, a + 1});
            if (i + 1 < stacks) m.indices.insert(m.indices.end(), {a, b, b + 1});
        }
    }
    return m;
}

uint32_t add_material(SceneDesc& desc, const Material& material) {
    if (desc.materials.empty()) desc.materials.emplace_back();
    desc.materials.push_back(material);
    return static_cast<uint32_t>(desc.materials.size() - 1);
}

void add_mesh(SceneDesc& desc, Mesh mesh, uint32_t material, const Mat4d& world) {
    mesh.material = material;
    desc.meshes.push_back(std::move(mesh));
    desc.objects.push_back({"mesh"});
    desc.instances.push_back({static_cast<uint32_t>(desc.meshes.size() - 1),
                              static_cast<uint32_t>(desc.objects.size() - 1), world});
}

void add_sphere(SceneDesc& desc, const Vec3d& center, double radius, uint32_t material) {
    desc.objects.push_back({"sphere"});
    desc.spheres.push_back(
        {center, radius, material, static_cast<uint32_t>(desc.objects.size() - 1)});
}

Mat4d scaling(double s) {
    Mat4d m(1.0);
    for (int i = 0; i < 3; ++i) m[i][i] = s;
    return m;
}

Mat4d translation(const Vec3d& by) {
    Mat4d m(1.0);
    m[3] = Vec4d(by, 1);
    return m;
}

SceneDesc cornell_desc() {
    SceneDesc desc;
    const uint32_t white = add_material(desc, diffuse(Rgb(0.73f)));
    const uint32_t red = add_material(desc, diffuse(Rgb(0.65f, 0.05f, 0.05f)));
    const uint32_t green = add_material(desc, diffuse(Rgb(0.12f, 0.45f, 0.15f)));
    const uint32_t lamp = add_material(desc, emitter(Rgb(17, 12, 7)));
    const uint32_t blue = add_material(desc, diffuse(Rgb(0.1f, 0.2f, 0.7f)));
    const uint32_t clear = add_material(desc, glass(1.5f, Rgb(0.9f, 0.6f, 0.3f), 0.5f));
    add_mesh(desc, quad_mesh({-1, -1, 1}, {2, 0, 0}, {0, 0, -2}), white);
    add_mesh(desc, quad_mesh({-1, 1, -1}, {2, 0, 0}, {0, 0, 2}), white);
    add_mesh(desc, quad_mesh({-1, -1, -1}, {2, 0, 0}, {0, 2, 0}), white);
    add_mesh(desc, quad_mesh({-1, -1, 1}, {0, 0, -2}, {0, 2, 0}), red);
    add_mesh(desc, quad_mesh({1, -1, -1}, {0, 0, 2}, {0, 2, 0}), green);
    add_mesh(desc, quad_mesh({-0.25f, 0.996f, -0.25f}, {0.5f, 0, 0}, {0, 0, 0.5f}), lamp);
    Mat4d turned(1.0);
    turned[0] = Vec4d(0.8, 0, -0.6, 0);
    turned[2] = Vec4d(0.6, 0, 0.8, 0);
    turned[3] = Vec4d(-0.4, -1, -0.3, 1);
    add_mesh(desc, box_mesh({-0.3f, 0, -0.3f}, {0.3f, 0.9f, 0.3f}), white, turned);
    add_mesh(desc, quad_mesh({-0.2f, 0.9005f, 0.2f}, {0.4f, 0, 0}, {0, 0, -0.4f}), blue, turned);
    add_sphere(desc, Vec3d(0.45, -0.65, 0.35), 0.35, clear);
    Mat4d ball = scaling(0.28);
    ball[3] = Vec4d(-0.4, 0.2, -0.3, 1);
    add_mesh(desc, uv_sphere_mesh(8, 16), white, ball);
    add_mesh(desc, box_mesh({-0.35f, -0.95f, 0.5f}, {0.05f, -0.55f, 0.52f}), clear);
    return desc;
}

Camera cornell_camera() {
    Camera camera;
    camera.yfov = 0.66;
    look_at(camera, Vec3d(0, 0, 4), Vec3d(0));
    return camera;
}

SceneDesc scaled(SceneDesc desc, double s) {
    for (MeshInstance& instance : desc.instances)
        instance.world_from_object = scaling(s) * instance.world_from_object;
    for (Sphere& sphere : desc.spheres) {
        sphere.center *= s;
        sphere.radius *= s;
    }
    for (Material& material : desc.materials)
        material.attenuation_distance = static_cast<float>(material.attenuation_distance * s);
    return desc;
}

Camera scaled(Camera camera, double s) {
    camera.position *= s;
    camera.aperture_radius *= s;
    camera.focus_distance *= s;
    camera.xmag *= s;
    camera.ymag *= s;
    return camera;
}

SceneDesc moved(SceneDesc desc, const Vec3d& by) {
    for (MeshInstance& instance : desc.instances)
        instance.world_from_object[3] += Vec4d(by, 0);
    for (Sphere& sphere : desc.spheres) sphere.center += by;
    return desc;
}

Camera moved(Camera camera, const Vec3d& by) {
    camera.position += by;
    return camera;
}

Rendering render(const SceneDesc& desc, const Camera& camera, const RenderWith& with) {
    const std::shared_ptr<const Scene> scene = Scene::build(desc, workers());
    const RenderScene render_scene(scene);
    RenderSettings settings;
    settings.max_depth = with.max_depth;
    settings.russian_roulette = with.russian_roulette;
    settings.seed = run_settings().seed;
    settings.tile_size = 8;
    Rendering result;
    result.film = Film(with.width, with.height);
    const RenderPass pass{render_scene, camera, settings,
                          smallest_tier(analyse_effects(*scene, camera).active), with.passes};
    std::stop_source stop;
    TileCounts counts;
    render_pass(pass, result.film, workers(), stop, {}, counts);
    result.image = result.film.image(false);
    result.nonfinite = counts.nonfinite.total();
    return result;
}

Result<SceneDesc> load_text(const std::string& gltf) {
    namespace fs = std::filesystem;
    const fs::path file =
        fs::temp_directory_path() / ("talbot-hardcase-" + std::to_string(getpid()) + ".gltf");
    const std::span<const char> text(gltf);
    const std::span<const std::byte> bytes = std::as_bytes(text);
    const Status written = write_file_atomically(
        file, {reinterpret_cast<const uint8_t*>(bytes.data()), bytes.size()});
    if (!written) return written.error();
    Result<SceneDesc> desc = load_gltf(file);
    std::error_code ignored;
    fs::remove(file, ignored);
    return desc;
}

uint64_t differing_pixels(const Rendering& a, const Rendering& b) {
    uint64_t differing = 0;
    for (size_t i = 0; i < a.film.pixels().size(); ++i)
        differing += !(a.film.pixels()[i] == b.film.pixels()[i]);
    return differing;
}

double relmse(const ImageRgba& image, const ImageRgba& reference) {
    return compare_images(image, reference, 0).relmse;
}

}  // namespace talbot::hardcases::geometry
