// One glTF primitive to one Mesh: indices of any mode become a triangle list over just the vertices
// that it uses, attributes become floats, and what cannot be drawn is dropped with a warning that
// names the mesh.
#include "core/io/gltf/meshes.h"

#include <algorithm>

#include "core/geometry/exact_sign.h"
#include "core/io/gltf/attributes.h"
#include "core/io/gltf/deform.h"
#include "core/io/gltf/tangents.h"
#include "core/io/gltf/triangles.h"
#include "core/io/gltf/values.h"
#include "core/math/robust.h"

namespace talbot::gltf {

namespace {

class PrimitiveLoader {
  public:
    PrimitiveLoader(const Document& document, const PrimitiveRequest& request, MemoryBudget& budget,
                    uint64_t max_bytes)
        : document_(document),
          request_(request),
          in_(document.model.meshes[request.mesh].primitives[request.primitive]),
          element_(primitive_name(request.mesh, request.primitive)),
          source_(document, in_, element_),
          budget_(budget),
          max_bytes_(max_bytes) {}

    Result<PrimitiveResult> run() {
        if (in_.mode < TINYGLTF_MODE_TRIANGLES) {
            result_.is_points_or_lines = true;
            return std::move(result_);
        }
        if (!source_.has("POSITION")) {
            warn("has no POSITION; it is not drawn");
            return std::move(result_);
        }
        for (const auto step :
             {&PrimitiveLoader::read_compressed, &PrimitiveLoader::read_triangles,
              &PrimitiveLoader::read_positions, &PrimitiveLoader::read_normals,
              &PrimitiveLoader::read_tangents, &PrimitiveLoader::read_texture_coordinates,
              &PrimitiveLoader::read_colors, &PrimitiveLoader::deform}) {
            if (Status done = (this->*step)(); !done) return done.error();
            if (is_empty_) return std::move(result_);
        }
        drop_unused_vertices();
        repair_normals();
        repair_tangents();
        if (request_.wants_tangents && mesh_.tangents.empty() && !mesh_.normals.empty() &&
            !mesh_.uv[request_.tangent_uv_set].empty()) {
            if (!budget_.reserve(mesh_.positions.size() * sizeof(Vec4f)))
                return over_budget(document_, max_bytes_);
            generate_tangents(mesh_, request_.tangent_uv_set);
        }
        const std::string& name = document_.model.meshes[request_.mesh].name;
        mesh_.name = name.empty() ? "mesh " + std::to_string(request_.mesh) : name;
        mesh_.material = request_.material;
        result_.mesh = std::move(mesh_);
        return std::move(result_);
    }

  private:
    void warn(const std::string& what) { result_.warnings.push_back(element_ + ": " + what); }
    Error fail(const std::string& what) const { return document_.error(element_, what); }

    template <typename T>
    Status allocate(std::vector<T>& values, uint64_t count) {
        if (!budget_.reserve(count * sizeof(T))) return over_budget(document_, max_bytes_);
        values.resize(count);
        return Done{};
    }

    Status read_compressed() { return source_.decompress(budget_, max_bytes_); }

    // The order in which vertices are drawn.
    Status read_order(size_t vertex_count, std::vector<uint32_t>& order) {
        if (source_.draco()) {
            if (source_.draco()->point_count != vertex_count)
                return fail("has the wrong count of vertices");
            order = std::move(source_.draco()->indices);
            return Done{};
        }
        if (in_.indices < 0) {
            if (vertex_count > 0xFFFFFFFFull) return fail("has more than 2^32 vertices");
            if (Status done = allocate(order, vertex_count); !done) return done;
            for (size_t i = 0; i < order.size(); ++i) order[i] = static_cast<uint32_t>(i);
            return Done{};
        }
        const Result<AccessorView> view = open_accessor(document_, in_.indices);
        if (!view) return view.error();
        const bool integers = view->component_type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE ||
                              view->component_type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ||
                              view->component_type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
        if (view->components != 1 || !integers)
            return fail("its indices are not unsigned integers");
        if (Status done = allocate(order, view->count); !done) return done;
        read_indices(*view, order.data());
        for (const uint32_t index : order) {
            if (index >= vertex_count) {
                return fail("index " + std::to_string(index) + " is out of range: there are " +
                            std::to_string(vertex_count) + " vertices");
            }
        }
        return Done{};
    }

    Status read_triangles() {
        const Result<AccessorView> positions = source_.open("POSITION");
        if (!positions) return positions.error();
        range_.total = positions->count;
        std::vector<uint32_t> order;
        if (Status done = read_order(range_.total, order); !done) return done;
        if (order.size() < 3) {
            warn("has fewer than three indices; it is not drawn");
            is_empty_ = true;
            return Done{};
        }
        if (in_.mode == TINYGLTF_MODE_TRIANGLES || source_.draco()) {
            if (order.size() % 3 != 0) {
                warn("the number of indices is not a multiple of three; the rest is not drawn");
                order.resize(order.size() - order.size() % 3);
            }
            mesh_.indices = std::move(order);
        } else {
            if (!budget_.reserve(order.size() * 2 * sizeof(uint32_t)))
                return over_budget(document_, max_bytes_);
            expand(order);
        }
        drop_collapsed();
        const auto [low, high] = std::minmax_element(mesh_.indices.begin(), mesh_.indices.end());
        is_empty_ = low == mesh_.indices.end();
        if (is_empty_) return Done{};
        range_.first = *low;
        range_.count = size_t{*high} - *low + 1;
        for (uint32_t& index : mesh_.indices) index -= static_cast<uint32_t>(range_.first);
        return Done{};
    }

    // Strips and fans (glTF 2.0, section 3.7.2.1): every triangle keeps the winding of the first.
    void expand(const std::vector<uint32_t>& order) {
        mesh_.indices.reserve((order.size() - 2) * 3);
        for (size_t i = 0; i + 2 < order.size(); ++i) {
            if (in_.mode == TINYGLTF_MODE_TRIANGLE_FAN) {
                mesh_.indices.insert(mesh_.indices.end(), {order[i + 1], order[i + 2], order[0]});
            } else {
                mesh_.indices.insert(mesh_.indices.end(),
                                     {order[i], order[i + 1 + i % 2], order[i + 2 - i % 2]});
            }
        }
    }

    // Strips are joined by triangles that name a vertex twice.
    void drop_collapsed() {
        collapsed_ = keep_triangles(mesh_.indices, [](uint32_t a, uint32_t b, uint32_t c) {
            return a != b && b != c && c != a;
        });
        if (mesh_.indices.empty()) warn_of_no_area();
    }

    void warn_of_no_area() {
        warn("all " + std::to_string(collapsed_ + mesh_.triangle_count()) +
             " triangles are lines or points; it is not drawn");
    }

    // One triangle with an area is enough: the ray engine drops and counts the others.
    void drop_without_area() {
        const std::vector<Vec3f>& p = mesh_.positions;
        const std::vector<uint32_t>& v = mesh_.indices;
        for (size_t i = 0; i < v.size(); i += 3) {
            if (!exactly_collinear(p[v[i]], p[v[i + 1]], p[v[i + 2]])) return;
        }
        warn_of_no_area();
        is_empty_ = true;
    }

    template <typename T>
    Status read_attribute(const std::string& name, size_t width_min, std::vector<T>& out,
                          const T& fill) {
        constexpr auto kWidth = static_cast<size_t>(T::length());
        const Result<AccessorView> view = source_.open(name, range_.total, width_min, kWidth);
        if (!view) return view.error();
        if (Status done = allocate(out, range_.count); !done) return done;
        if (view->components < kWidth) std::fill(out.begin(), out.end(), fill);
        read_floats(*view, range_.first, range_.count, kWidth, &out[0].x);
        return Done{};
    }

    Status read_positions() { return read_attribute("POSITION", 3, mesh_.positions, Vec3f(0)); }

    // Morph targets, then the skin, as the request's shape has them.
    Status deform() {
        if (request_.shape && !request_.shape->weights.empty()) {
            const Status done = apply_morph_targets(source_, range_, request_.shape->weights,
                                                    request_.uv_sets, budget_, max_bytes_, mesh_);
            if (!done) return done;
        }
        if (request_.shape && !request_.shape->joints.empty()) {
            if (Status done = apply_skin(source_, range_, request_.shape->joints, mesh_); !done)
                return done;
        }
        drop_unusable();
        return Done{};
    }

    void drop_unusable() {
        // One vertex further out than any world reaches must not take the whole mesh with it.
        const auto usable = [&](uint32_t v) {
            return is_finite(mesh_.positions[v]) &&
                   max_component(glm::abs(mesh_.positions[v])) < kMaxWorldCoordinate;
        };
        const size_t dropped =
            keep_triangles(mesh_.indices, [&](uint32_t a, uint32_t b, uint32_t c) {
                return usable(a) && usable(b) && usable(c);
            });
        if (dropped > 0)
            warn("positions that are not finite or out of range (" + world_range() +
                 "): " + std::to_string(dropped) + " triangles are not drawn");
        is_empty_ = mesh_.indices.empty();
        if (!is_empty_) drop_without_area();
    }

    Status read_normals() {
        if (!source_.has("NORMAL")) return Done{};
        return read_attribute("NORMAL", 3, mesh_.normals, Vec3f(0));
    }

    // Without normals the file's tangents must be ignored (glTF 2.0, section 3.7.2.1).
    Status read_tangents() {
        if (!request_.wants_tangents || mesh_.normals.empty() || !source_.has("TANGENT"))
            return Done{};
        return read_attribute("TANGENT", 4, mesh_.tangents, Vec4f(0));
    }

    void repair_tangents() {
        for (Vec4f& t : mesh_.tangents) {
            const Vec3f direction = safe_normalize(Vec3f(t), Vec3f(0));
            if (direction == Vec3f(0)) {
                warn("has tangents that are no directions; they are made anew");
                mesh_.tangents.clear();
                return;
            }
            t = Vec4f(direction, t.w < 0 ? -1.0f : 1.0f);
        }
    }

    Status read_texture_coordinates() {
        for (size_t set = 0; set < 2; ++set) {
            const std::string name = "TEXCOORD_" + std::to_string(request_.uv_sets[set]);
            if (!source_.has(name)) continue;
            std::vector<Vec2f>& uv = mesh_.uv[set];
            if (Status done = read_attribute(name, 2, uv, Vec2f(0)); !done) return done;
            for (Vec2f& t : uv) {
                if (!is_finite(t)) t = Vec2f(0);
            }
        }
        return Done{};
    }

    Status read_colors() {
        if (!source_.has("COLOR_0")) return Done{};
        if (Status done = read_attribute("COLOR_0", 3, mesh_.colors, Vec4f(1)); !done) return done;
        for (Vec4f& color : mesh_.colors) {
            for (int i = 0; i < 4; ++i) color[i] = color[i] > 0 ? std::min(color[i], 1.0f) : 0.0f;
        }
        return Done{};
    }

    template <typename T>
    static void gather(std::vector<T>& values, const std::vector<uint32_t>& kept) {
        if (values.empty()) return;
        for (size_t i = 0; i < kept.size(); ++i) values[i] = values[kept[i]];
        values.resize(kept.size());
        values.shrink_to_fit();
    }

    void drop_unused_vertices() {
        constexpr uint32_t kUnused = 0xFFFFFFFFu;
        std::vector<uint32_t> renumbered(mesh_.positions.size(), kUnused);
        for (const uint32_t index : mesh_.indices) renumbered[index] = 0;
        std::vector<uint32_t> kept;
        kept.reserve(renumbered.size());
        for (uint32_t v = 0; v < renumbered.size(); ++v) {
            if (renumbered[v] == kUnused) continue;
            renumbered[v] = static_cast<uint32_t>(kept.size());
            kept.push_back(v);
        }
        if (kept.size() == renumbered.size()) return;
        for (uint32_t& index : mesh_.indices) index = renumbered[index];
        gather(mesh_.positions, kept);
        gather(mesh_.normals, kept);
        gather(mesh_.tangents, kept);
        gather(mesh_.uv[0], kept);
        gather(mesh_.uv[1], kept);
        gather(mesh_.colors, kept);
    }

    // Unit length everywhere; a normal that is no direction is replaced by the area-weighted mean
    // of its triangles' normals.
    void repair_normals() {
        size_t bad = 0;
        for (Vec3f& n : mesh_.normals) {
            n = safe_normalize(n, Vec3f(0));
            if (n == Vec3f(0)) ++bad;
        }
        if (bad == 0) return;
        warn(std::to_string(bad) + " normals are no directions; they are taken from the triangles");
        std::vector<Vec3d> sums(mesh_.normals.size(), Vec3d(0));
        for (size_t i = 0; i < mesh_.indices.size(); i += 3) {
            const uint32_t* v = &mesh_.indices[i];
            const Vec3d p(mesh_.positions[v[0]]);
            const Vec3d n =
                cross(Vec3d(mesh_.positions[v[1]]) - p, Vec3d(mesh_.positions[v[2]]) - p);
            for (int k = 0; k < 3; ++k) sums[v[k]] += n;
        }
        for (size_t v = 0; v < sums.size(); ++v) {
            if (mesh_.normals[v] != Vec3f(0)) continue;
            const double size = length(sums[v]);
            mesh_.normals[v] = size > 0 && is_finite(size) ? Vec3f(sums[v] / size) : Vec3f(0, 0, 1);
        }
    }

    const Document& document_;
    const PrimitiveRequest& request_;
    const tinygltf::Primitive& in_;
    std::string element_;
    AttributeSource source_;
    MemoryBudget& budget_;
    uint64_t max_bytes_;
    PrimitiveResult result_;
    Mesh mesh_;
    VertexRange range_;      // the vertices of mesh_ among those of the accessors
    size_t collapsed_ = 0;   // triangles that name a vertex twice
    bool is_empty_ = false;  // nothing of it can be drawn
};

}  // namespace

std::string primitive_name(uint32_t mesh, uint32_t primitive) {
    return "meshes[" + std::to_string(mesh) + "].primitives[" + std::to_string(primitive) + "]";
}

Result<PrimitiveResult> load_primitive(const Document& document, const PrimitiveRequest& request,
                                       MemoryBudget& budget, uint64_t max_bytes) {
    return PrimitiveLoader(document, request, budget, max_bytes).run();
}

}  // namespace talbot::gltf
