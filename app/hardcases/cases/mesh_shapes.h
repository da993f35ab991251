// Random numbers, meshes and scenes that the geometry cases and the tests of the ray engine share.
// Everything is a function of a seed.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "core/geometry/accel.h"
#include "core/math/ray.h"
#include "core/math/vec.h"

namespace talbot::hardcases::geometry {

// SplitMix64.
class Rng {
  public:
    explicit Rng(uint64_t seed) : state_(seed) {}
    uint64_t bits() {
        uint64_t z = (state_ += 0x9E3779B97F4A7C15ull);
        z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ull;
        z = (z ^ (z >> 27)) * 0x94D049BB133111EBull;
        return z ^ (z >> 31);
    }
    uint32_t below(uint32_t n) { return static_cast<uint32_t>((bits() >> 32) * n >> 32); }
    int between(int low, int high) {
        return low + static_cast<int>(below(static_cast<uint32_t>(high - low + 1)));
    }
    float uniform() { return static_cast<float>(bits() >> 40) * 0x1p-24f; }
    float uniform(float low, float high) { return low + (high - low) * uniform(); }
    Vec3f in_box(float low, float high) {
        const float x = uniform(low, high);
        const float y = uniform(low, high);
        return Vec3f(x, y, uniform(low, high));
    }
    Vec3f direction() {
        const float z = uniform(-1, 1);
        const float phi = 2 * kPi * uniform();
        const float r = std::sqrt(std::max(0.0f, 1 - z * z));
        return Vec3f(r * std::cos(phi), r * std::sin(phi), z);
    }

  private:
    uint64_t state_;
};

struct MeshData {
    std::vector<Vec3f> positions;
    std::vector<uint32_t> indices;

    size_t triangles() const { return indices.size() / 3; }
    std::array<Vec3f, 3> triangle(size_t i) const {
        return {positions[indices[3 * i]], positions[indices[3 * i + 1]],
                positions[indices[3 * i + 2]]};
    }
    uint32_t add_vertex(const Vec3f& p) {
        positions.push_back(p);
        return static_cast<uint32_t>(positions.size() - 1);
    }
    void add_triangle(uint32_t a, uint32_t b, uint32_t c) {
        indices.insert(indices.end(), {a, b, c});
    }
    void add_triangle(const Vec3f& a, const Vec3f& b, const Vec3f& c) {
        const uint32_t i = add_vertex(a);
        add_vertex(b);
        add_vertex(c);
        add_triangle(i, i + 1, i + 2);
    }
    void add_quad(const Vec3f& a, const Vec3f& b, const Vec3f& c, const Vec3f& d) {
        const uint32_t i = add_vertex(a);
        add_vertex(b);
        add_vertex(c);
        add_vertex(d);
        add_triangle(i, i + 1, i + 2);
        add_triangle(i, i + 2, i + 3);
    }
    void add_box(const Vec3f& lo, const Vec3f& hi) {
        const auto first = static_cast<uint32_t>(positions.size());
        for (int k = 0; k < 8; ++k) {
            add_vertex(Vec3f((k & 1) != 0 ? hi.x : lo.x, (k & 2) != 0 ? hi.y : lo.y,
                             (k & 4) != 0 ? hi.z : lo.z));
        }
        constexpr uint32_t kFaces[6][4] = {{0, 2, 6, 4}, {1, 5, 7, 3}, {0, 4, 5, 1},
                                           {2, 3, 7, 6}, {0, 1, 3, 2}, {4, 6, 7, 5}};
        for (const auto& f : kFaces) {
            add_triangle(first + f[0], first + f[1], first + f[2]);
            add_triangle(first + f[0], first + f[2], first + f[3]);
        }
    }
    void add(const MeshData& other) {
        const auto first = static_cast<uint32_t>(positions.size());
        positions.insert(positions.end(), other.positions.begin(), other.positions.end());
        for (const uint32_t i : other.indices) indices.push_back(first + i);
    }
    MeshData moved(const Vec3f& by) const {
        MeshData mesh = *this;
        for (Vec3f& p : mesh.positions) p += by;
        return mesh;
    }
};

// n random triangles with edges of about `edge` in the unit cube.
inline MeshData soup(size_t n, float edge, uint64_t seed) {
    Rng rng(seed);
    MeshData mesh;
    for (size_t i = 0; i < n; ++i) {
        const Vec3f p = rng.in_box(0, 1);
        const Vec3f q = p + rng.in_box(-edge, edge);
        mesh.add_triangle(p, q, p + rng.in_box(-edge, edge));
    }
    return mesh;
}

// Smooth value noise in [-1, 1] from a hashed lattice.
inline float value_noise(const Vec3f& p) {
    const Vec3f cell = glm::floor(p);
    const Vec3f f = p - cell;
    const Vec3f s = f * f * (Vec3f(3) - 2.0f * f);
    float sum = 0;
    for (int k = 0; k < 8; ++k) {
        const Vec3f corner(static_cast<float>(k & 1), static_cast<float>((k >> 1) & 1),
                           static_cast<float>(k >> 2));
        const Vec3f c = cell + corner;
        Rng rng(static_cast<uint64_t>(static_cast<int64_t>(c.x)) * 73856093u ^
                static_cast<uint64_t>(static_cast<int64_t>(c.y)) * 19349663u ^
                static_cast<uint64_t>(static_cast<int64_t>(c.z)) * 83492791u);
        const Vec3f w = corner * s + (Vec3f(1) - corner) * (Vec3f(1) - s);
        sum += w.x * w.y * w.z * rng.uniform(-1, 1);
    }
    return sum;
}

// A closed cube sphere of n x n quads a face, displaced by `amount` of fractal noise, radius
// about 1.
inline MeshData displaced_sphere(uint32_t n, float amount) {
    MeshData mesh;
    std::map<std::array<uint32_t, 3>, uint32_t> seen;
    const auto vertex = [&](const std::array<uint32_t, 3>& grid) {
        const auto found = seen.find(grid);
        if (found != seen.end()) return found->second;
        Vec3f p;
        for (int i = 0; i < 3; ++i) {
            p[i] = std::tan(
                kPi / 4 *
                (2 * static_cast<float>(grid[static_cast<size_t>(i)]) / static_cast<float>(n) - 1));
        }
        p = normalize(p);
        float h = 0;
        float weight = amount;
        for (float scale = 2; scale < 64; scale *= 2, weight *= 0.5f) {
            h += weight * value_noise(p * scale + Vec3f(scale));
        }
        const uint32_t index = mesh.add_vertex(p * (1 + h));
        seen.emplace(grid, index);
        return index;
    };
    for (uint32_t face = 0; face < 6; ++face) {
        const uint32_t axis = face / 2;
        for (uint32_t i = 0; i < n; ++i) {
            for (uint32_t j = 0; j < n; ++j) {
                const auto at = [&](uint32_t u, uint32_t v) {
                    std::array<uint32_t, 3> grid{};
                    grid[axis] = face % 2 != 0 ? n : 0;
                    grid[(axis + 1) % 3] = face % 2 != 0 ? u : v;
                    grid[(axis + 2) % 3] = face % 2 != 0 ? v : u;
                    return vertex(grid);
                };
                const uint32_t a = at(i, j);
                const uint32_t c = at(i + 1, j + 1);
                mesh.add_triangle(a, at(i + 1, j), c);
                mesh.add_triangle(a, c, at(i, j + 1));
            }
        }
    }
    return mesh;
}

// A fan of n triangles around vertex 0, its rim stretched along x.
inline MeshData triangle_fan(uint32_t n, float stretch, const Vec3f& at, Rng& rng) {
    MeshData mesh;
    mesh.add_vertex(at + rng.in_box(-0.1f, 0.1f));
    for (uint32_t i = 0; i < n; ++i) {
        const float a =
            2 * kPi * (static_cast<float>(i) + rng.uniform(0, 0.5f)) / static_cast<float>(n);
        mesh.add_vertex(at + Vec3f(stretch * std::cos(a), std::sin(a), rng.uniform(-0.3f, 0.3f)));
    }
    for (uint32_t i = 0; i < n; ++i) mesh.add_triangle(0, 1 + i, 1 + (i + 1) % n);
    return mesh;
}

// Surface of a cube of n^3 unit cells, its faces cut into unit squares.
inline MeshData grid_cube(int n) {
    MeshData mesh;
    for (int face = 0; face < 6; ++face) {
        const int axis = face / 2;
        for (int i = 0; i < n; ++i) {
            for (int j = 0; j < n; ++j) {
                Vec3f corner[4];
                for (int k = 0; k < 4; ++k) {
                    corner[k][axis] = face % 2 != 0 ? static_cast<float>(n) : 0.0f;
                    corner[k][(axis + 1) % 3] = static_cast<float>(i + (k == 1 || k == 2));
                    corner[k][(axis + 2) % 3] = static_cast<float>(j + (k >= 2));
                }
                mesh.add_quad(corner[0], corner[1], corner[2], corner[3]);
            }
        }
    }
    return mesh;
}

// `count` boxes on a ground quad, like a city seen from a plane.
inline MeshData city(size_t count, uint64_t seed) {
    Rng rng(seed);
    MeshData mesh;
    const auto side = static_cast<size_t>(std::ceil(std::sqrt(static_cast<double>(count))));
    const auto size = static_cast<float>(side);
    mesh.add_quad(Vec3f(0, 0, 0), Vec3f(0, 0, size), Vec3f(size, 0, size), Vec3f(size, 0, 0));
    for (size_t i = 0; i < count; ++i) {
        const Vec3f p(static_cast<float>(i % side) + rng.uniform(0.05f, 0.2f), 0,
                      static_cast<float>(i / side) + rng.uniform(0.05f, 0.2f));
        const float u = rng.uniform();
        const float width = rng.uniform(0.4f, 0.75f);
        mesh.add_box(p, p + Vec3f(width, 0.3f + 4 * u * u * u, rng.uniform(0.4f, 0.75f)));
    }
    return mesh;
}

// A Cornell box of 36 triangles: five walls, a lamp and two turned blocks, in [-1, 1]^3, open
// towards +z.
inline MeshData cornell_box() {
    MeshData mesh;
    const Vec3f p[8] = {{-1, -1, -1}, {1, -1, -1}, {-1, 1, -1}, {1, 1, -1},
                        {-1, -1, 1},  {1, -1, 1},  {-1, 1, 1},  {1, 1, 1}};
    mesh.add_quad(p[0], p[4], p[5], p[1]);
    mesh.add_quad(p[2], p[3], p[7], p[6]);
    mesh.add_quad(p[0], p[1], p[3], p[2]);
    mesh.add_quad(p[0], p[2], p[6], p[4]);
    mesh.add_quad(p[1], p[5], p[7], p[3]);
    const float y = 0.998f;
    mesh.add_quad({-0.25f, y, -0.25f}, {0.25f, y, -0.25f}, {0.25f, y, 0.25f}, {-0.25f, y, 0.25f});
    for (int k = 0; k < 2; ++k) {
        MeshData block;
        block.add_box(Vec3f(-0.3f, 0, -0.3f), Vec3f(0.3f, k == 0 ? 1.2f : 0.6f, 0.3f));
        const float a = k == 0 ? 0.3f : -0.3f;
        for (Vec3f& q : block.positions) {
            q = Vec3f(std::cos(a) * q.x + std::sin(a) * q.z, q.y - 1,
                      std::cos(a) * q.z - std::sin(a) * q.x) +
                (k == 0 ? Vec3f(-0.35f, 0, -0.3f) : Vec3f(0.35f, 0, 0.35f));
        }
        mesh.add(block);
    }
    return mesh;
}

// Owns what an AccelInput refers to.
struct SceneData {
    std::vector<MeshData> meshes;
    std::vector<AccelInstance> instances;
    std::vector<AccelSphere> spheres;

    SceneData& show(MeshData mesh) {
        meshes.push_back(std::move(mesh));
        AccelInstance instance;
        instance.mesh = static_cast<uint32_t>(meshes.size() - 1);
        instances.push_back(instance);
        return *this;
    }
    SceneData& place(uint32_t mesh, const Mat4d& world_from_object) {
        AccelInstance instance;
        instance.mesh = mesh;
        instance.identity = false;
        instance.world_from_object = world_from_object;
        instances.push_back(instance);
        return *this;
    }
    AccelInput input(BuildQuality quality = BuildQuality::high) const {
        AccelInput in;
        for (const MeshData& mesh : meshes) in.meshes.push_back({mesh.positions, mesh.indices});
        in.instances = instances;
        in.spheres = spheres;
        in.quality = quality;
        return in;
    }
};

inline SceneData scene_of(MeshData mesh) {
    SceneData scene;
    scene.show(std::move(mesh));
    return scene;
}

inline std::unique_ptr<const Accel> build(const SceneData& scene,
                                          BuildQuality quality = BuildQuality::high,
                                          unsigned threads = 2) {
    WorkerPool pool(threads);
    return build_accel(scene.input(quality), pool);
}

inline bool same_bits(float a, float b) {
    return std::bit_cast<uint32_t>(a) == std::bit_cast<uint32_t>(b);
}
inline bool same_hit(const Hit& a, const Hit& b) {
    return same_bits(a.t, b.t) && same_bits(a.u, b.u) && same_bits(a.v, b.v) && a.id == b.id;
}

// Float Moeller-Trumbore 1997 as commonly written: the negative control of the watertight tests.
inline bool moeller_trumbore(const Ray& ray, const std::array<Vec3f, 3>& tri) {
    const Vec3f e1 = tri[1] - tri[0];
    const Vec3f e2 = tri[2] - tri[0];
    const Vec3f p = cross(ray.d, e2);
    const float det = dot(e1, p);
    if (det == 0) return false;
    const float inverse = 1 / det;
    const Vec3f s = ray.o - tri[0];
    const float u = dot(s, p) * inverse;
    if (u < 0 || u > 1) return false;
    const Vec3f q = cross(s, e1);
    const float v = dot(ray.d, q) * inverse;
    if (v < 0 || u + v > 1) return false;
    return dot(e2, q) * inverse > 0;
}

}  // namespace talbot::hardcases::geometry
