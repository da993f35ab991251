// Mesh instances (one per node, or many by EXT_mesh_gpu_instancing) and analytic spheres
// (KHR_implicit_shapes with TALBOT_implicit_surface on the node).
#include "core/io/gltf/surfaces.h"

#include <algorithm>
#include <cmath>

#include "core/io/gltf/accessor.h"
#include "core/io/gltf/flatten.h"
#include "core/io/gltf/values.h"
#include "core/math/robust.h"

namespace talbot::gltf {

namespace {

// Whether its products, too, are finite.
bool is_finite_matrix(const Mat4d& m) {
    for (int c = 0; c < 4; ++c) {
        if (!is_finite(Vec3d(m[c]))) return false;
    }
    const Mat3d linear(m);
    return is_finite(length(linear[0]) * length(linear[1]) * length(linear[2]));
}

// Whether an instance there has any extent that can be seen.
bool is_seen(const Mat4d& world) {
    return is_finite_matrix(world) && rank_of(world) >= 2;
}

class SurfaceFinder {
  public:
    explicit SurfaceFinder(Loading& loading)
        : loading_(loading), model_(loading.document.model), shapes_(loading) {}

    Result<SurfaceUses> run(const std::vector<PlacedNode>& nodes) {
        for (const PlacedNode& placed : nodes) {
            const tinygltf::Node& node = model_.nodes[placed.node];
            if (!placed.is_visible) continue;
            if (node.mesh >= 0) {
                if (Status done = add_meshes(placed, node); !done) return done.error();
            }
            if (const auto* surface =
                    find_extension_value(node.extensions, "TALBOT_implicit_surface")) {
                if (Status done = add_sphere(placed, *surface); !done) return done.error();
            }
        }
        if (infinite_ > 0) {
            loading_.warn(first_infinite_,
                          std::to_string(infinite_) +
                              " instances of infinite size or place, of which this is the first, "
                              "are not drawn");
        }
        uses_.shapes = shapes_.take();
        return std::move(uses_);
    }

  private:
    // What a scale of zero hides is left out without a word; what is not finite is counted.
    bool is_drawn(const PlacedNode& placed, const Mat4d& world) {
        if (!is_finite_matrix(world) && infinite_++ == 0)
            first_infinite_ = element_name("nodes", placed.node);
        return is_seen(world);
    }

    // Animations may show at another moment what is hidden at this one: then tables keep their
    // order at any moment.
    bool may_appear() const { return !model_.animations.empty(); }

    uint32_t object_of(const PlacedNode& placed) {
        const std::string& name = model_.nodes[placed.node].name;
        loading_.desc.objects.push_back(
            {name.empty() ? "node " + std::to_string(placed.node) : name});
        return static_cast<uint32_t>(loading_.desc.objects.size() - 1);
    }

    Status add_meshes(const PlacedNode& placed, const tinygltf::Node& node) {
        std::vector<Mat4d> worlds{placed.world};
        const auto* instancing = find_extension_value(node.extensions, "EXT_mesh_gpu_instancing");
        // A skinned mesh stands where its joints are, whatever its node says.
        if (instancing && node.skin < 0) {
            const Status done = read_instances(placed, *instancing, worlds);
            if (!done) return done.error();
        }
        if (node.skin < 0)
            std::erase_if(worlds, [&](const Mat4d& world) { return !is_drawn(placed, world); });
        if (worlds.empty() && !may_appear()) return Done{};
        const Result<uint32_t> shape = shapes_.shape_of(node);
        if (!shape) return shape.error();
        if (node.skin >= 0) worlds = {shapes_[*shape].world};
        const uint32_t object = object_of(placed);
        for (const Mat4d& world : worlds)
            uses_.meshes.push_back({*shape, object, world, node.skin < 0 && rank_of(world) == 2});
        return Done{};
    }

    // `width` floats per instance; the first attribute read sets the count.
    Status read_instance_attribute(const std::string& element, const tinygltf::Value& attributes,
                                   const char* name, size_t width, std::optional<size_t>& count,
                                   std::vector<float>& out) {
        const tinygltf::Value* value = member(attributes, name);
        if (!value) return Done{};
        const std::optional<uint32_t> index = index_member(attributes, name);
        const std::string attribute = element + ".attributes." + name;
        if (!index || *index >= model_.accessors.size()) {
            return loading_.document.error(attribute, "its accessor is out of range: there are " +
                                                          std::to_string(model_.accessors.size()) +
                                                          " accessors");
        }
        const Result<AccessorView> view =
            open_accessor(loading_.document, static_cast<int>(*index));
        if (!view) return view.error();
        if (view->components != width)
            return loading_.document.error(attribute, "has the wrong type");
        if (count && *count != view->count) {
            return loading_.document.error(attribute, "has " + std::to_string(view->count) +
                                                          " elements, another attribute has " +
                                                          std::to_string(*count));
        }
        count = view->count;
        if (!loading_.budget.reserve(view->count * (width * sizeof(float) + sizeof(Mat4d)))) {
            return over_budget(loading_.document, loading_.options.max_bytes);
        }
        out.resize(view->count * width);
        read_floats(*view, 0, view->count, width, out.data());
        return Done{};
    }

    // World = node * instance; the plain mesh is not drawn.
    Status read_instances(const PlacedNode& placed, const tinygltf::Value& instancing,
                          std::vector<Mat4d>& worlds) {
        const std::string element =
            element_name("nodes", placed.node) + ".extensions.EXT_mesh_gpu_instancing";
        const tinygltf::Value* attributes = member(instancing, "attributes");
        if (!attributes || !attributes->IsObject())
            return loading_.document.error(element, "lacks attributes");
        std::optional<size_t> count;
        std::vector<float> t, r, s;
        if (Status done = read_instance_attribute(element, *attributes, "TRANSLATION", 3, count, t);
            !done)
            return done;
        if (Status done = read_instance_attribute(element, *attributes, "ROTATION", 4, count, r);
            !done)
            return done;
        if (Status done = read_instance_attribute(element, *attributes, "SCALE", 3, count, s);
            !done)
            return done;
        if (!count) return Done{};
        size_t without_rotation = 0;
        worlds.clear();
        worlds.reserve(*count);
        for (size_t i = 0; i < *count; ++i) {
            const Vec3d translation =
                t.empty() ? Vec3d(0) : Vec3d(t[3 * i], t[3 * i + 1], t[3 * i + 2]);
            const Vec4d rotation = r.empty()
                                       ? Vec4d(0, 0, 0, 1)
                                       : Vec4d(r[4 * i], r[4 * i + 1], r[4 * i + 2], r[4 * i + 3]);
            if (rotation == Vec4d(0)) ++without_rotation;
            const Vec3d scale = s.empty() ? Vec3d(1) : Vec3d(s[3 * i], s[3 * i + 1], s[3 * i + 2]);
            worlds.push_back(placed.world * compose(translation, rotation, scale));
        }
        if (without_rotation > 0) {
            loading_.warn(element + ".attributes.ROTATION",
                          std::to_string(without_rotation) +
                              " are 0, 0, 0, 0, which is no rotation; none is made");
        }
        return Done{};
    }

    // The radius of shape `index` of KHR_implicit_shapes; empty when it is no sphere.
    std::optional<double> sphere_radius(uint32_t index) const {
        const auto found = model_.extensions.find("KHR_implicit_shapes");
        if (found == model_.extensions.end()) return std::nullopt;
        const tinygltf::Value* shapes = member(found->second, "shapes");
        if (!shapes || !shapes->IsArray() || index >= shapes->ArrayLen()) return std::nullopt;
        const tinygltf::Value& shape = shapes->Get(static_cast<int>(index));
        const tinygltf::Value* type = member(shape, "type");
        if (!type || !type->IsString() || type->Get<std::string>() != "sphere") return std::nullopt;
        const tinygltf::Value* sphere = member(shape, "sphere");
        const double radius = sphere ? number_member(*sphere, "radius", 0.5) : 0.5;
        return radius > 0 && is_finite(radius) ? std::optional<double>(radius) : std::nullopt;
    }

    Status add_sphere(const PlacedNode& placed, const tinygltf::Value& surface) {
        const std::string element =
            element_name("nodes", placed.node) + ".extensions.TALBOT_implicit_surface";
        const std::optional<uint32_t> shape = index_member(surface, "shape");
        const std::optional<double> radius = shape ? sphere_radius(*shape) : std::nullopt;
        if (!radius) {
            return loading_.document.error(
                element, "its shape is not a sphere of KHR_implicit_shapes with a positive radius");
        }
        SphereUse use;
        use.radius = *radius;
        use.world = placed.world;
        if (member(surface, "material")) {
            const std::optional<uint32_t> material = index_member(surface, "material");
            if (!material || *material >= model_.materials.size()) {
                return loading_.document.error(element + ".material",
                                               "is out of range: there are " +
                                                   std::to_string(model_.materials.size()) +
                                                   " materials");
            }
            use.material = *material + 1;
        }
        if (!is_drawn(placed, use.world) && !may_appear()) return Done{};
        use.object = object_of(placed);
        uses_.spheres.push_back(use);
        return Done{};
    }

    Loading& loading_;
    const tinygltf::Model& model_;
    ShapeTable shapes_;
    SurfaceUses uses_;
    size_t infinite_ = 0;
    std::string first_infinite_;
};

// Whether the linear part is a rotation (or reflection) times one scale, up to the rounding of a
// file's floats.
bool is_similarity(const Mat4d& m, double& scale) {
    const Mat3d linear(m);
    const Mat3d square = glm::transpose(linear) * linear;
    const double mean = (square[0][0] + square[1][1] + square[2][2]) / 3;
    for (int c = 0; c < 3; ++c) {
        for (int r = 0; r < 3; ++r) {
            if (std::abs(square[c][r] - (c == r ? mean : 0)) > kUniformScaleTolerance * mean)
                return false;
        }
    }
    scale = std::cbrt(std::abs(glm::determinant(linear)));
    return true;
}

// A unit sphere of triangles about the origin, poles on the Y axis, U eastwards and V down.
Mesh tessellate_sphere() {
    constexpr uint32_t kRings = 64;
    constexpr uint32_t kSegments = 128;
    Mesh mesh;
    for (uint32_t ring = 0; ring <= kRings; ++ring) {
        const double theta = std::numbers::pi * ring / kRings;
        for (uint32_t segment = 0; segment <= kSegments; ++segment) {
            const double phi = 2 * std::numbers::pi * segment / kSegments;
            const Vec3d n(std::sin(theta) * std::cos(phi), std::cos(theta),
                          -std::sin(theta) * std::sin(phi));
            mesh.positions.push_back(Vec3f(n));
            mesh.normals.push_back(Vec3f(n));
            mesh.uv[0].push_back(
                Vec2f(static_cast<float>(segment) / kSegments, static_cast<float>(ring) / kRings));
        }
    }
    for (uint32_t ring = 0; ring < kRings; ++ring) {
        for (uint32_t segment = 0; segment < kSegments; ++segment) {
            const uint32_t a = ring * (kSegments + 1) + segment;
            const uint32_t b = a + kSegments + 1;
            if (ring > 0) mesh.indices.insert(mesh.indices.end(), {a, b, a + 1});
            if (ring + 1 < kRings) mesh.indices.insert(mesh.indices.end(), {a + 1, b, b + 1});
        }
    }
    return mesh;
}

}  // namespace

Result<SurfaceUses> find_surfaces(Loading& loading, const std::vector<PlacedNode>& nodes) {
    return SurfaceFinder(loading).run(nodes);
}

Status place_spheres(Loading& loading, const std::vector<SphereUse>& spheres) {
    SceneDesc& desc = loading.desc;
    for (const SphereUse& use : spheres) {
        if (!is_seen(use.world)) continue;
        double scale = 1;
        if (is_similarity(use.world, scale)) {
            desc.spheres.push_back(
                {Vec3d(use.world[3]), use.radius * scale, use.material, use.object});
            continue;
        }
        Mesh mesh = tessellate_sphere();
        if (!loading.budget.reserve(mesh.positions.size() * (2 * sizeof(Vec3f) + sizeof(Vec2f)) +
                                    mesh.indices.size() * sizeof(uint32_t))) {
            return over_budget(loading.document, loading.options.max_bytes);
        }
        mesh.name = desc.objects[use.object].name;
        mesh.material = use.material;
        loading.warn(mesh.name, "a sphere under non-uniform scale is drawn as triangles");
        Mat4d world = use.world * compose(Vec3d(0), Vec4d(0, 0, 0, 1), Vec3d(use.radius));
        if (rank_of(world) == 2) {
            mesh = flattened(mesh, world);
            world = compose(Vec3d(world[3]), Vec4d(0, 0, 0, 1), Vec3d(1));
        }
        desc.instances.push_back({static_cast<uint32_t>(desc.meshes.size()), use.object, world});
        desc.meshes.push_back(std::move(mesh));
    }
    return Done{};
}

}  // namespace talbot::gltf
