#include "core/scene/scene.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/check.h"
#include "core/math/robust.h"

namespace talbot {
namespace {

// A mesh is copied into world space when that costs at most this many triangles over sharing it.
constexpr uint64_t kBakedTriangleBudget = 2048;

Vec3d transform_point(const Mat4d& m, const Vec3d& p) {
    return Vec3d(m * Vec4d(p, 1.0));
}

Mat3d cofactor(const Mat3d& m) {
    return Mat3d(cross(m[1], m[2]), cross(m[2], m[0]), cross(m[0], m[1]));
}

struct BoundsD {
    Vec3d lower{std::numeric_limits<double>::infinity()};
    Vec3d upper{-std::numeric_limits<double>::infinity()};

    bool is_empty() const { return !(lower.x <= upper.x); }
    void add(const Vec3d& p) {
        lower = glm::min(lower, p);
        upper = glm::max(upper, p);
    }
    void add_transformed(const BoundsD& box, const Mat4d& m) {
        if (box.is_empty()) return;
        for (int corner = 0; corner < 8; ++corner) {
            add(transform_point(m, Vec3d((corner & 1) ? box.upper.x : box.lower.x,
                                         (corner & 2) ? box.upper.y : box.lower.y,
                                         (corner & 4) ? box.upper.z : box.lower.z)));
        }
    }
    Vec3d center() const { return 0.5 * lower + 0.5 * upper; }
};

BoundsD mesh_bounds(const Mesh& mesh) {
    BoundsD box;
    for (const Vec3f& p : mesh.positions) {
        if (is_finite(p)) box.add(Vec3d(p));
    }
    return box;
}

// Largest side of a box after the linear part of a transform: it does not depend on where things
// are.
double side_after(const BoundsD& box, const Mat4d& m) {
    const Vec3d sides = box.upper - box.lower;
    Vec3d after(0);
    for (int axis = 0; axis < 3; ++axis) after += glm::abs(Vec3d(m[axis])) * sides[axis];
    return max_component(after);
}

// The component-wise lower median of where things are: it moves with the scene and ignores a few
// far or huge things. Rounded to a step from the things' own sizes, so that it moves exactly when
// the scene is moved by whole steps: then re-centred coordinates keep every bit. Neither rounding
// has its ties where coordinates and sizes of models usually lie.
Vec3d choose_origin(const SceneDesc& desc, const std::vector<BoundsD>& boxes) {
    constexpr double kTie = 0.381966;
    constexpr int kStepsPerSide = 6;  // as a power of two
    std::vector<Vec3d> centers;
    std::vector<double> sides;
    for (const MeshInstance& instance : desc.instances) {
        const BoundsD& box = boxes[instance.mesh];
        if (box.is_empty()) continue;
        centers.push_back(transform_point(instance.world_from_object, box.center()));
        sides.push_back(side_after(box, instance.world_from_object));
    }
    for (const Sphere& sphere : desc.spheres) {
        centers.push_back(sphere.center);
        sides.push_back(2 * sphere.radius);
    }
    Vec3d origin(0);
    if (centers.empty()) return origin;
    const auto middle = static_cast<std::ptrdiff_t>((centers.size() - 1) / 2);
    std::nth_element(sides.begin(), sides.begin() + middle, sides.end());
    int exponent = 0;
    const double mantissa = std::frexp(sides[static_cast<std::size_t>(middle)], &exponent);
    const double step = std::ldexp(mantissa > 0 ? 1.0 : 0.0,
                                   exponent - kStepsPerSide + (mantissa > 0.5 + kTie / 2 ? 1 : 0));
    for (int axis = 0; axis < 3; ++axis) {
        std::nth_element(centers.begin(), centers.begin() + middle, centers.end(),
                         [axis](const Vec3d& a, const Vec3d& b) { return a[axis] < b[axis]; });
        const double center = centers[static_cast<std::size_t>(middle)][axis];
        origin[axis] = step > 0 ? std::floor(center / step + kTie) * step : center;
    }
    return origin;
}

// Moves a mesh to re-centred world coordinates; a mirroring transform also turns the winding, so
// that the geometric normal by winding stays on the front.
void bake(Mesh& mesh, const Mat4d& world_from_object) {
    const Mat3d linear(world_from_object);
    const Mat3d normal_from_object = cofactor(linear);
    const bool mirrored = glm::determinant(linear) < 0;
    const double side = mirrored ? -1.0 : 1.0;
    for (Vec3f& p : mesh.positions) p = Vec3f(transform_point(world_from_object, Vec3d(p)));
    for (Vec3f& n : mesh.normals)
        n = safe_normalize(Vec3f(side * (normal_from_object * Vec3d(n))), n);
    for (Vec4f& t : mesh.tangents) {
        const Vec3f direction = safe_normalize(Vec3f(linear * Vec3d(Vec3f(t))), Vec3f(t));
        t = Vec4f(direction, mirrored ? -t.w : t.w);
    }
    if (mirrored) {
        for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3)
            std::swap(mesh.indices[i + 1], mesh.indices[i + 2]);
    }
}

SceneInstance place(const MeshInstance& source, const Mat4d& recentred) {
    SceneInstance instance;
    instance.mesh = source.mesh;
    instance.object = source.object;
    instance.identity = false;
    instance.world_from_object = recentred;
    const Mat3d linear(recentred);
    instance.linear = Mat3f(linear);
    instance.mirrored = glm::determinant(linear) < 0;
    // The cofactor matrix is scaled to unit size, so that tiny instances do not underflow in float.
    Mat3d normals = cofactor(linear) * (instance.mirrored ? -1.0 : 1.0);
    double largest = 0;
    for (int c = 0; c < 3; ++c) largest = std::max(largest, max_component(glm::abs(normals[c])));
    if (largest > 0) normals /= std::exp2(std::floor(std::log2(largest)));
    instance.normal_from_object = Mat3f(normals);
    return instance;
}

// White is no colour; interpolated it would not be white to the last bit.
void drop_white_colors(Mesh& mesh) {
    if (std::all_of(mesh.colors.begin(), mesh.colors.end(),
                    [](const Vec4f& c) { return c == Vec4f(1); }))
        mesh.colors.clear();
}

void place_meshes(SceneDesc& desc, SceneGeometry& geometry) {
    for (Mesh& mesh : desc.meshes) drop_white_colors(mesh);
    std::vector<uint64_t> uses(desc.meshes.size(), 0);
    for (const MeshInstance& instance : desc.instances) ++uses[instance.mesh];
    // Shared meshes keep their index; baked ones are appended or moved.
    geometry.meshes.resize(desc.meshes.size());
    std::vector<bool> shared(desc.meshes.size(), false);
    for (std::size_t i = 0; i < desc.meshes.size(); ++i) {
        shared[i] = uses[i] > 1 && desc.meshes[i].triangle_count() * uses[i] > kBakedTriangleBudget;
        if (shared[i]) geometry.meshes[i] = std::move(desc.meshes[i]);
    }
    for (const MeshInstance& source : desc.instances) {
        Mat4d recentred = source.world_from_object;
        recentred[3] -= Vec4d(geometry.origin, 0.0);
        SceneInstance instance = place(source, recentred);
        if (!shared[source.mesh]) {
            Mesh mesh = --uses[source.mesh] == 0 ? std::move(desc.meshes[source.mesh])
                                                 : desc.meshes[source.mesh];
            bake(mesh, recentred);
            instance.mesh = static_cast<uint32_t>(geometry.meshes.size());
            instance.identity = true;
            instance.mirrored = false;
            instance.world_from_object = Mat4d(1.0);
            instance.linear = Mat3f(1.0f);
            instance.normal_from_object = Mat3f(1.0f);
            geometry.meshes.push_back(std::move(mesh));
        }
        instance.material = geometry.meshes[instance.mesh].material;
        geometry.instances.push_back(instance);
    }
}

BoundsD instance_bounds(const SceneGeometry& geometry, const SceneInstance& instance) {
    BoundsD box;
    Mat4d world = instance.world_from_object;
    world[3] += Vec4d(geometry.origin, 0.0);
    box.add_transformed(mesh_bounds(geometry.meshes[instance.mesh]), world);
    return box;
}

void add_sphere(BoundsD& box, const SceneGeometry& geometry, const Sphere& sphere) {
    box.add(sphere.center + geometry.origin - sphere.radius);
    box.add(sphere.center + geometry.origin + sphere.radius);
}

void give_bounds(const BoundsD& box, Vec3d& lower, Vec3d& upper) {
    lower = box.is_empty() ? Vec3d(-0.5) : box.lower;
    upper = box.is_empty() ? Vec3d(0.5) : box.upper;
}

}  // namespace

AccelInput accel_input(const SceneGeometry& geometry, BuildQuality quality) {
    AccelInput input;
    input.quality = quality;
    for (const Mesh& mesh : geometry.meshes) input.meshes.push_back({mesh.positions, mesh.indices});
    for (const SceneInstance& instance : geometry.instances) {
        input.instances.push_back(
            {instance.mesh, instance.identity, instance.world_from_object, true});
    }
    for (const Sphere& sphere : geometry.spheres)
        input.spheres.push_back({sphere.center, sphere.radius, true});
    return input;
}

std::shared_ptr<const Scene> Scene::build(SceneDesc desc, WorkerPool& pool,
                                          const SceneBuildOptions& options) {
    auto scene = std::make_shared<Scene>();
    auto geometry = std::make_shared<SceneGeometry>();
    std::vector<BoundsD> boxes;
    boxes.reserve(desc.meshes.size());
    for (const Mesh& mesh : desc.meshes) boxes.push_back(mesh_bounds(mesh));
    geometry->origin = choose_origin(desc, boxes);
    place_meshes(desc, *geometry);
    for (Sphere& sphere : desc.spheres) sphere.center -= geometry->origin;
    geometry->spheres = std::move(desc.spheres);
    geometry->objects = std::move(desc.objects);
    const AccelInput input = accel_input(*geometry, options.quality);
    if (options.brute_force) {
        geometry->accel = build_brute_force(input);
    } else {
        if (options.previous) {
            geometry->accel = refit_accel(options.previous->accel(), input, pool, options.stop);
        }
        if (!geometry->accel)
            geometry->accel = build_accel(input, pool, options.stop, options.progress);
    }
    if (!geometry->accel) return nullptr;
    if (const AccelStats& stats = geometry->accel->stats(); stats.crowd >= kCrowdWorthSaying) {
        desc.warnings.push_back(geometry->meshes[stats.crowd_mesh].name + ": " +
                                std::to_string(stats.crowd) +
                                " triangles lie in one place; rays that come there are slow");
    }
    geometry->bounds = geometry->accel->bounds();
    scene->geometry_ = std::move(geometry);
    scene->textures_ = std::make_shared<const std::vector<Texture>>(std::move(desc.textures));
    scene->materials_ = std::move(desc.materials);
    scene->measure_textures(pool);
    scene->lights_ = std::move(desc.lights);
    scene->cameras_ = std::move(desc.cameras);
    scene->environment_ = std::move(desc.environment);
    scene->about_ = std::make_shared<const About>(
        About{std::move(desc.file), std::move(desc.name), std::move(desc.sha256),
              std::move(desc.reading), std::move(desc.extensions), std::move(desc.warnings)});
    return scene;
}

void Scene::measure_textures(WorkerPool& pool) {
    auto facts = std::make_shared<TexelFacts>();
    facts->ranges.resize(textures_->size());
    pool.parallel_for(textures_->size(), [&](uint64_t i, unsigned) {
        const Texture& texture = (*textures_)[i];
        if (texture.image) facts->ranges[i] = talbot::texel_range(*texture.image);
    });
    facts->alpha.resize(geometry_->meshes.size());
    // By texture, so that only one pyramid is held at a time.
    std::vector<std::vector<uint32_t>> meshes(textures_->size());
    for (uint32_t i = 0; i < geometry_->meshes.size(); ++i) {
        const Mesh& mesh = geometry_->meshes[i];
        if (mesh.indices.empty() || !mesh.colors.empty() || mesh.material >= materials_.size())
            continue;
        const TextureSlot& slot = materials_[mesh.material].base_color_texture;
        if (slot.used() && !facts->ranges[slot.texture].is_constant(kChannelAlpha))
            meshes[slot.texture].push_back(i);
    }
    for (std::size_t t = 0; t < meshes.size(); ++t) {
        if (meshes[t].empty()) continue;
        const Texture& texture = (*textures_)[t];
        const AlphaPyramid pyramid(*texture.image);
        pool.parallel_for(meshes[t].size(), [&](uint64_t k, unsigned) {
            const Mesh& mesh = geometry_->meshes[meshes[t][k]];
            facts->alpha[meshes[t][k]] = std::make_unique<const MeshAlpha>(measure_alpha(
                mesh, materials_[mesh.material].base_color_texture, texture, pyramid));
        });
    }
    texel_facts_ = std::move(facts);
}

void Scene::world_bounds(Vec3d& lower, Vec3d& upper) const {
    BoundsD box;
    for (const SceneInstance& instance : geometry_->instances) {
        const BoundsD own = instance_bounds(*geometry_, instance);
        if (own.is_empty()) continue;
        box.add(own.lower);
        box.add(own.upper);
    }
    for (const Sphere& sphere : geometry_->spheres) add_sphere(box, *geometry_, sphere);
    give_bounds(box, lower, upper);
}

void Scene::object_bounds(uint32_t object, Vec3d& lower, Vec3d& upper) const {
    BoundsD box;
    for (const SceneInstance& instance : geometry_->instances) {
        if (instance.object != object) continue;
        const BoundsD own = instance_bounds(*geometry_, instance);
        if (own.is_empty()) continue;
        box.add(own.lower);
        box.add(own.upper);
    }
    for (const Sphere& sphere : geometry_->spheres) {
        if (sphere.object == object) add_sphere(box, *geometry_, sphere);
    }
    give_bounds(box, lower, upper);
}

std::shared_ptr<const Scene> Scene::with_material(uint32_t index, Material material) const {
    TALBOT_CHECK(index < materials_.size());
    auto scene = std::make_shared<Scene>(*this);
    scene->materials_[index] = std::move(material);
    return scene;
}

std::shared_ptr<const Scene> Scene::with_materials(std::vector<Material> materials) const {
    TALBOT_CHECK(materials.size() == materials_.size());
    auto scene = std::make_shared<Scene>(*this);
    scene->materials_ = std::move(materials);
    return scene;
}

std::shared_ptr<const Scene> Scene::with_geometry(
    std::shared_ptr<const SceneGeometry> geometry) const {
    auto scene = std::make_shared<Scene>(*this);
    scene->geometry_ = std::move(geometry);
    return scene;
}

std::shared_ptr<const Scene> Scene::with_punctual_light(uint32_t index, PunctualLight light) const {
    TALBOT_CHECK(index < lights_.size());
    auto scene = std::make_shared<Scene>(*this);
    scene->lights_[index] = std::move(light);
    return scene;
}

std::shared_ptr<const Scene> Scene::with_environment(Environment environment) const {
    auto scene = std::make_shared<Scene>(*this);
    scene->environment_ = std::move(environment);
    return scene;
}

std::shared_ptr<const Scene> Scene::with_motion(std::shared_ptr<const SceneMotion> motion) const {
    auto scene = std::make_shared<Scene>(*this);
    scene->motion_ = std::move(motion);
    return scene;
}

Camera frame_bounds(const Vec3d& lower, const Vec3d& upper, double aspect) {
    constexpr double kMargin = 1.05;
    const Vec3d center = 0.5 * lower + 0.5 * upper;
    double radius = 0.5 * length(upper - lower);
    if (!(radius > 0)) radius = 1;
    Camera camera;
    camera.name = "framed";
    camera.yfov = 40.0 * std::numbers::pi / 180;
    const double half = std::tan(camera.yfov / 2) * std::min(1.0, aspect);
    const double distance = kMargin * radius / std::sin(std::atan(half));
    look_at(camera, center + distance * normalize(Vec3d(0.55, 0.4, 1.0)), center);
    return camera;
}

}  // namespace talbot
