// The scenes and rays of the ray benchmark. Rays are generated once, so that every engine gets the
// same ones: primary: a pinhole, 1024 x 1024 in tiles of 8 x 8; ao: one cosine-weighted ray per
// primary hit, a tenth of the diagonal long, any hit; diffuse: up to three cosine-weighted bounces
// per pixel in path order, closest hit.
#pragma once

#include <cmath>
#include <filesystem>
#include <functional>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/io/gltf_loader.h"
#include "core/math/robust.h"
#include "core/scene/scene.h"
#include "geometry_scenes.h"

namespace talbot::bench {

struct RaySets {
    std::vector<Ray> primary;
    std::vector<Ray> ao;
    std::vector<Ray> diffuse;
};

struct View {
    Vec3f eye{0};
    Vec3f target{0};
    float fov_degrees = 60;
};

struct BenchScene {
    std::string name;
    test::SceneData data;
    View view;
};

// The world triangle behind a hit.
inline std::array<Vec3f, 3> hit_triangle(const test::SceneData& scene, const Hit& hit) {
    const AccelInstance& instance = scene.instances[hit.id.instance];
    auto corners = scene.meshes[instance.mesh].triangle(hit.id.primitive);
    if (instance.identity) return corners;
    for (Vec3f& p : corners) p = Vec3f(instance.world_from_object * Vec4d(Vec3d(p), 1));
    return corners;
}

inline std::vector<Ray> primary_rays(const View& view, uint32_t size) {
    std::vector<Ray> rays;
    rays.reserve(static_cast<size_t>(size) * size);
    const Vec3f forward = normalize(view.target - view.eye);
    const Vec3f right = normalize(cross(forward, Vec3f(0.01f, 1, 0.02f)));
    const Vec3f up = cross(right, forward);
    const float half = std::tan(view.fov_degrees * kPi / 360);
    for (uint32_t tile = 0; tile < (size / 8) * (size / 8); ++tile) {
        for (uint32_t k = 0; k < 64; ++k) {
            const auto x = static_cast<float>((tile % (size / 8)) * 8 + k % 8);
            const auto y = static_cast<float>((tile / (size / 8)) * 8 + k / 8);
            const auto n = static_cast<float>(size);
            Ray ray;
            ray.o = view.eye;
            ray.d = normalize(forward + half * ((2 * x + 1) / n - 1) * right +
                              half * (1 - (2 * y + 1) / n) * up);
            rays.push_back(ray);
        }
    }
    return rays;
}

// A cosine-weighted ray from a hit, on the side that the ray came from, a little off the surface so
// that engines without identity-based exclusion answer alike.
inline Ray bounce(const test::SceneData& scene, const Ray& ray, const Hit& hit, float offset,
                  test::Rng& rng) {
    const auto tri = hit_triangle(scene, hit);
    Vec3f n = safe_normalize(cross(tri[1] - tri[0], tri[2] - tri[0]), -ray.d);
    if (dot(n, ray.d) > 0) n = -n;
    Ray next;
    next.o = (1 - hit.u - hit.v) * tri[0] + hit.u * tri[1] + hit.v * tri[2] + offset * n;
    next.d = normalize(n * 1.0001f + rng.direction());
    return next;
}

inline RaySets make_ray_sets(const BenchScene& scene, const Accel& accel, uint32_t size) {
    RaySets sets;
    sets.primary = primary_rays(scene.view, size);
    const float diagonal = length(accel.bounds().upper - accel.bounds().lower);
    const float offset = 0x1p-17f * diagonal;
    test::Rng rng(1);
    for (const Ray& first : sets.primary) {
        Ray ray = first;
        Hit hit;
        if (!accel.closest(ray, hit)) continue;
        Ray ao = bounce(scene.data, ray, hit, offset, rng);
        ao.t_max = 0.1f * diagonal;
        sets.ao.push_back(ao);
        for (int depth = 0; depth < 3; ++depth) {
            ray = bounce(scene.data, ray, hit, offset, rng);
            sets.diffuse.push_back(ray);
            if (!accel.closest(ray, hit)) break;
        }
    }
    return sets;
}

// A closed hall with fluted columns and bumpy walls, from which no ray escapes.
inline test::MeshData hall() {
    test::MeshData mesh;
    const auto patch = [&mesh](uint32_t nu, uint32_t nv, const auto& point) {
        const auto first = static_cast<uint32_t>(mesh.positions.size());
        for (uint32_t i = 0; i <= nu; ++i) {
            for (uint32_t j = 0; j <= nv; ++j) {
                mesh.add_vertex(point(static_cast<float>(i) / static_cast<float>(nu),
                                      static_cast<float>(j) / static_cast<float>(nv)));
            }
        }
        for (uint32_t i = 0; i < nu; ++i) {
            for (uint32_t j = 0; j < nv; ++j) {
                const uint32_t a = first + i * (nv + 1) + j;
                mesh.add_triangle(a, a + nv + 1, a + nv + 2);
                mesh.add_triangle(a, a + nv + 2, a + 1);
            }
        }
    };
    const Vec3f size(40, 10, 20);
    for (int axis = 0; axis < 3; ++axis) {
        for (int side = 0; side < 2; ++side) {
            patch(160, 120, [&](float u, float v) {
                Vec3f p;
                p[(axis + 1) % 3] = u * size[(axis + 1) % 3];
                p[(axis + 2) % 3] = v * size[(axis + 2) % 3];
                const bool rim = u == 0 || v == 0 || u == 1 || v == 1;
                p[axis] = static_cast<float>(side) * size[axis];
                if (!rim)
                    p[axis] += (side != 0 ? 0.15f : -0.15f) * (1 + test::value_noise(2.0f * p));
                return p;
            });
        }
    }
    for (int column = 0; column < 36; ++column) {
        const Vec3f at(2.2f + 2.1f * static_cast<float>(column % 18), 0,
                       column < 18 ? 5.0f : 15.0f);
        patch(96, 30, [&](float u, float v) {
            const float a = 2 * kPi * u;
            const float r = 0.5f + 0.04f * std::cos(24 * a) - 0.1f * v;
            return at + Vec3f(r * std::cos(a), 10 * v, r * std::sin(a));
        });
    }
    return mesh;
}

// A glTF file seen from above one corner, its geometry as the renderer places it.
inline BenchScene model(const std::string& name, const std::filesystem::path& file) {
    auto loaded = load_gltf(file);
    if (!loaded) throw std::runtime_error(loaded.error().line());
    WorkerPool pool(2);
    const auto scene = Scene::build(std::move(*loaded), pool, {});
    BenchScene out{name, {}, {}};
    for (const Mesh& mesh : scene->geometry().meshes) {
        test::MeshData data;
        data.positions = mesh.positions;
        data.indices = mesh.indices;
        out.data.meshes.push_back(std::move(data));
    }
    for (const SceneInstance& instance : scene->geometry().instances)
        out.data.instances.push_back(
            {instance.mesh, instance.identity, instance.world_from_object});
    const Bounds box = scene->geometry().bounds;
    const Vec3f center = 0.5f * (box.lower + box.upper);
    out.view = {center + length(box.upper - box.lower) * Vec3f(0.35f, 0.4f, 0.8f), center, 45};
    return out;
}

// A model shown again and again under rotations, in rows of `rows`.
inline BenchScene instanced(BenchScene scene, int rows) {
    Vec3d lower(std::numeric_limits<double>::infinity());
    Vec3d upper(-lower);
    for (const AccelInstance& instance : scene.data.instances) {
        for (const Vec3f& p : scene.data.meshes[instance.mesh].positions) {
            const Vec3d q(instance.world_from_object * Vec4d(Vec3d(p), 1));
            lower = glm::min(lower, q);
            upper = glm::max(upper, q);
        }
    }
    const Vec3d center = 0.5 * (lower + upper);
    const double step = length(upper - lower);
    const std::vector<AccelInstance> parts = std::move(scene.data.instances);
    scene.data.instances.clear();
    for (int copy = 0; copy < rows * rows; ++copy) {
        const Vec3d at(step * (copy % rows), 0, step * (copy / rows));
        const double angle = 0.7 * copy;
        Mat4d place(1.0);
        place[0] = Vec4d(std::cos(angle), 0, -std::sin(angle), 0);
        place[2] = Vec4d(std::sin(angle), 0, std::cos(angle), 0);
        place[3] = Vec4d(at - Vec3d(place * Vec4d(center, 0)), 1);
        for (const AccelInstance& part : parts)
            scene.data.place(part.mesh, place * part.world_from_object);
    }
    const Vec3f middle = Vec3f(Vec3d(0.5 * (rows - 1) * step, 0, 0.5 * (rows - 1) * step));
    const auto distance = static_cast<float>(rows * step);
    scene.view = {middle + distance * Vec3f(0.2f, 0.4f, 0.9f), middle, 45};
    return scene;
}

struct SceneMaker {
    std::string name;
    std::function<BenchScene()> make;
    bool is_extra = false;  // stays out of the geometric means over the main scenes
};

// The generated scenes, and those of three models whose files are below `models`. The main ones: a
// soup, a displaced sphere, a city of boxes and the models, of which one is instanced.
inline std::vector<SceneMaker> bench_scenes(const std::filesystem::path& models) {
    std::vector<SceneMaker> makers = {
        {"soup",
         [] {
             return BenchScene{"soup",
                               test::scene_of(test::soup(1000000, 0.005f, 1)),
                               {Vec3f(0.5f, 0.5f, 2), Vec3f(0.5f), 40}};
         },
         false},
        {"sphere",
         [] {
             return BenchScene{"sphere",
                               test::scene_of(test::displaced_sphere(289, 0.1f)),
                               {Vec3f(0.5f, 1, 2.5f), Vec3f(0), 45}};
         },
         false},
        {"city",
         [] {
             return BenchScene{"city",
                               test::scene_of(test::city(20000, 1)),
                               {Vec3f(-8, 25, -8), Vec3f(50, 0, 50), 60}};
         },
         false},
        {"hall",
         [] {
             return BenchScene{
                 "hall", test::scene_of(hall()), {Vec3f(3, 3, 9), Vec3f(35, 4, 11), 75}};
         },
         true},
        {"cornell",
         [] {
             return BenchScene{
                 "cornell", test::scene_of(test::cornell_box()), {Vec3f(0, 0, 3.6f), Vec3f(0), 40}};
         },
         true},
    };
    const auto add = [&](const std::string& name, const std::string& path, int rows) {
        const std::filesystem::path file = models / path;
        if (models.empty() || !std::filesystem::exists(file)) return;
        makers.push_back({name,
                          [name, file, rows] {
                              BenchScene scene = model(name, file);
                              return rows == 1 ? scene : instanced(std::move(scene), rows);
                          },
                          false});
    };
    add("toycar", "ToyCar/ToyCar.gltf", 1);
    add("sixty-four cars", "ToyCar/ToyCar.gltf", 8);
    add("garden", "JapaneseBridgeGarden/JapaneseBridgeGarden.glb", 1);
    return makers;
}

}  // namespace talbot::bench
