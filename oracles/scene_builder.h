// Small scenes in code, for tests that know the right answer in closed form.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/film/film.h"
#include "core/integrate/kernel.h"
#include "core/integrate/render_scene.h"
#include "core/scene/scene.h"
#include "oracles/stats/ztest.h"

namespace talbot {

class SceneBuilder {
  public:
    SceneBuilder() { desc_.materials.push_back(Material{}); }

    uint32_t material(const Material& material) {
        desc_.materials.push_back(material);
        return static_cast<uint32_t>(desc_.materials.size() - 1);
    }
    static Material diffuse(float reflectance) {
        Material m;
        m.base_color_factor = Vec4f(reflectance, reflectance, reflectance, 1);
        m.metallic_factor = 0;
        m.specular_factor = 0;
        m.double_sided = true;
        return m;
    }
    void mesh(Mesh mesh, uint32_t material, const Mat4d& transform = Mat4d(1.0)) {
        mesh.material = material;
        desc_.meshes.push_back(std::move(mesh));
        instance(static_cast<uint32_t>(desc_.meshes.size() - 1), transform);
    }
    void instance(uint32_t mesh, const Mat4d& transform) {
        desc_.objects.push_back({"object"});
        desc_.instances.push_back(
            {mesh, static_cast<uint32_t>(desc_.objects.size() - 1), transform});
    }
    void sphere(const Vec3d& center, double radius, uint32_t material) {
        desc_.objects.push_back({"sphere"});
        desc_.spheres.push_back(
            {center, radius, material, static_cast<uint32_t>(desc_.objects.size() - 1)});
    }
    void light(const PunctualLight& light) { desc_.lights.push_back(light); }
    void environment(const Rgb& color) { desc_.environment.color = color; }
    SceneDesc& desc() { return desc_; }
    const SceneDesc& desc() const { return desc_; }

    // A parallelogram with corner p and edges a, b; front side along cross(a, b).
    static Mesh quad(const Vec3f& p, const Vec3f& a, const Vec3f& b) {
        Mesh m;
        m.positions = {p, p + a, p + a + b, p + b};
        m.indices = {0, 1, 2, 0, 2, 3};
        return m;
    }
    // An axis-aligned box with outward normals by winding.
    static Mesh box(const Vec3f& lower, const Vec3f& upper) {
        Mesh m;
        for (int i = 0; i < 8; ++i) {
            m.positions.emplace_back((i & 1) ? upper.x : lower.x, (i & 2) ? upper.y : lower.y,
                                     (i & 4) ? upper.z : lower.z);
        }
        m.indices = {0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5, 0, 1, 5, 0, 5, 4,
                     2, 6, 7, 2, 7, 3, 0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6};
        return m;
    }

    std::shared_ptr<const Scene> build(WorkerPool& pool) const { return Scene::build(desc_, pool); }

  private:
    SceneDesc desc_;
};

inline Camera camera_at(const Vec3d& eye, const Vec3d& target, double yfov = 0.7) {
    Camera camera;
    camera.yfov = yfov;
    look_at(camera, eye, target);
    return camera;
}

// Renders whole passes into a film with the tier that the scene needs, or a given one.
inline Film render_film(const std::shared_ptr<const Scene>& scene, const Camera& camera,
                        const PathSettings& settings, uint32_t width, uint32_t height,
                        uint64_t passes, WorkerPool& pool, int tier = -1,
                        NonFiniteCount* nonfinite = nullptr, const LightSampling& sampling = {}) {
    const RenderScene render_scene(scene, nullptr, {}, sampling);
    const CameraRays rays(camera, scene->origin(), width, height, scene->geometry().bounds);
    const std::size_t index = tier >= 0 ? static_cast<std::size_t>(tier)
                                        : smallest_tier(analyse_effects(*scene, camera).active);
    Film film(width, height);
    std::vector<TileCounts> counts(pool.size());
    pool.parallel_for(height, [&](uint64_t row, unsigned worker) {
        const auto y = static_cast<uint32_t>(row);
        const TileJob job{&render_scene, &rays, &settings, &film, 0, passes, 0, y, width, y + 1};
        tile_kernel(index)(job, {}, counts[worker]);
    });
    if (nonfinite) {
        for (const TileCounts& c : counts) nonfinite->merge(c.nonfinite);
    }
    return film;
}

// The pixels' green means.
inline stats::Moments pixel_moments(const Film& film) {
    stats::Moments moments;
    for (const FilmPixel& pixel : film.pixels())
        moments.add(pixel.sum[1].value() / static_cast<double>(pixel.samples));
    return moments;
}

// Mean of all pixels and channels.
inline double film_mean(const Film& film) {
    double sum = 0;
    double samples = 0;
    for (const FilmPixel& pixel : film.pixels()) {
        for (const ExactSum& c : pixel.sum) sum += c.value() / 3;
        samples += static_cast<double>(pixel.samples);
    }
    return sum / samples;
}

}  // namespace talbot
