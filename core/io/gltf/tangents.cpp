// MikkTSpace-compatible tangents (Mikkelsen 2008, "Simulation of wrinkled surfaces revisited",
// section 3.3 and appendix): corners are welded by position, normal and texture coordinate; around
// a welded vertex, triangles of one handedness that follow each other over shared edges form a
// group; a group's tangent is the mean of its triangles' tangents, projected into the plane of the
// normal and weighted by the corner's angle. The angular threshold is 180 degrees: groups are not
// divided.
#include "core/io/gltf/tangents.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <numeric>
#include <span>
#include <tuple>

#include "core/math/robust.h"

namespace talbot::gltf {

namespace {

constexpr uint32_t kNone = 0xFFFFFFFFu;

struct Face {
    std::array<uint32_t, 3> vertex;                         // welded
    std::array<uint32_t, 3> neighbor{kNone, kNone, kNone};  // over the edge from corner i to i + 1
    std::array<uint32_t, 3> group{kNone, kNone, kNone};
    Vec3f tangent{0};
    bool positive = false;    // texture coordinates keep the handedness
    bool fits_any = false;    // no area in texture space: takes part in any group
    bool degenerate = false;  // two corners in one place
};

struct Group {
    Vec3f sum{0};
    uint32_t vertex = 0;
    bool positive = false;
};

// What welds two vertices: position, normal and texture coordinate, bit by bit.
using WeldKey = std::array<uint32_t, 8>;

size_t weld_hash(const WeldKey& key) {
    uint64_t h = 0;
    for (const uint32_t b : key) {
        h = (h ^ b) * 0x9E3779B97F4A7C15ull;
        h ^= h >> 32;
    }
    return static_cast<size_t>(h);
}

Vec3f project(const Vec3f& v, const Vec3f& n) {
    return safe_normalize(v - n * dot(n, v), Vec3f(0));
}

class TangentBuilder {
  public:
    TangentBuilder(Mesh& mesh, const std::vector<Vec2f>& uv) : mesh_(mesh), uv_(uv) {}

    void run() {
        weld();
        make_faces();
        link_neighbors();
        for (uint32_t f = 0; f < faces_.size(); ++f) {
            for (uint32_t corner = 0; corner < 3; ++corner) start_group(f, corner);
        }
        sum_groups();
        write();
    }

  private:
    uint32_t source(uint32_t face, uint32_t corner) const {
        return mesh_.indices[size_t{3} * face + corner];
    }
    const Vec3f& position(uint32_t welded) const { return mesh_.positions[welded]; }

    WeldKey weld_key(uint32_t v) const {
        const Vec3f p = mesh_.positions[v] + 0.0f;  // -0 becomes 0
        const Vec3f n = mesh_.normals[v] + 0.0f;
        const Vec2f t = uv_[v] + 0.0f;
        WeldKey key;
        std::memcpy(key.data(), &p, 12);
        std::memcpy(key.data() + 3, &n, 12);
        std::memcpy(key.data() + 6, &t, 8);
        return key;
    }

    // welded_[v] is the first vertex with the same key, found in a table with open addressing.
    void weld() {
        const size_t mask = std::bit_ceil(mesh_.positions.size() * 2) - 1;
        std::vector<uint32_t> table(mask + 1, kNone);
        welded_.resize(mesh_.positions.size());
        for (uint32_t v = 0; v < welded_.size(); ++v) {
            const WeldKey key = weld_key(v);
            size_t slot = weld_hash(key) & mask;
            while (table[slot] != kNone && weld_key(table[slot]) != key) slot = (slot + 1) & mask;
            if (table[slot] == kNone) table[slot] = v;
            welded_[v] = table[slot];
        }
    }

    void make_faces() {
        faces_.resize(mesh_.indices.size() / 3);
        for (uint32_t f = 0; f < faces_.size(); ++f) {
            Face& face = faces_[f];
            for (uint32_t c = 0; c < 3; ++c) face.vertex[c] = welded_[source(f, c)];
            const Vec3f d1 = position(face.vertex[1]) - position(face.vertex[0]);
            const Vec3f d2 = position(face.vertex[2]) - position(face.vertex[0]);
            face.degenerate = d1 == Vec3f(0) || d2 == Vec3f(0) || d1 == d2;
            // V is turned up, as the algorithm has it.
            const Vec2f t1 = (uv_[face.vertex[1]] - uv_[face.vertex[0]]) * Vec2f(1, -1);
            const Vec2f t2 = (uv_[face.vertex[2]] - uv_[face.vertex[0]]) * Vec2f(1, -1);
            const float area = t1.x * t2.y - t1.y * t2.x;
            face.positive = area > 0;
            const Vec3f along_u = t2.y * d1 - t1.y * d2;
            const Vec3f along_v = t1.x * d2 - t2.x * d1;
            face.tangent = safe_normalize(along_u, Vec3f(0)) * (face.positive ? 1.0f : -1.0f);
            face.fits_any = !(area != 0) || face.tangent == Vec3f(0) || along_v == Vec3f(0);
        }
    }

    struct Edge {
        uint32_t high, face, corner;
        bool forward;
    };

    // All edges, grouped by their lower vertex: those of vertex v are [start[v], start[v + 1]).
    std::vector<Edge> collect_edges(std::vector<uint32_t>& start) const {
        const auto for_each_edge = [&](const auto& visit) {
            for (uint32_t f = 0; f < faces_.size(); ++f) {
                if (faces_[f].degenerate) continue;
                for (uint32_t c = 0; c < 3; ++c)
                    visit(f, c, faces_[f].vertex[c], faces_[f].vertex[(c + 1) % 3]);
            }
        };
        start.assign(welded_.size() + 1, 0);
        for_each_edge(
            [&](uint32_t, uint32_t, uint32_t a, uint32_t b) { ++start[std::min(a, b) + 1]; });
        std::partial_sum(start.begin(), start.end(), start.begin());
        std::vector<uint32_t> next(start.begin(), start.end() - 1);
        std::vector<Edge> edges(start.back());
        for_each_edge([&](uint32_t f, uint32_t c, uint32_t a, uint32_t b) {
            edges[next[std::min(a, b)]++] = {std::max(a, b), f, c, a < b};
        });
        return edges;
    }

    // Two faces are neighbours when they run along the same edge in opposite directions.
    void link_neighbors() {
        std::vector<uint32_t> start;
        std::vector<Edge> edges = collect_edges(start);
        for (size_t v = 0; v + 1 < start.size(); ++v) {
            const std::span<Edge> around(edges.data() + start[v], start[v + 1] - start[v]);
            std::sort(around.begin(), around.end(), [](const Edge& a, const Edge& b) {
                return std::tie(a.high, a.face, a.corner) < std::tie(b.high, b.face, b.corner);
            });
            link_sorted(around);
        }
    }

    void link_sorted(std::span<const Edge> edges) {
        for (size_t i = 0; i < edges.size(); ++i) {
            uint32_t& mine = faces_[edges[i].face].neighbor[edges[i].corner];
            if (mine != kNone) continue;
            // Where many faces share an edge, only the nearest few are looked at.
            for (size_t j = i + 1;
                 j < edges.size() && j < i + kMaxEdgeSharers && edges[j].high == edges[i].high;
                 ++j) {
                uint32_t& theirs = faces_[edges[j].face].neighbor[edges[j].corner];
                if (edges[j].forward == edges[i].forward || theirs != kNone ||
                    edges[j].face == edges[i].face)
                    continue;
                mine = edges[j].face;
                theirs = edges[i].face;
                break;
            }
        }
    }

    // A new group at this corner, filled over neighbouring faces around the vertex.
    void start_group(uint32_t first_face, uint32_t first_corner) {
        Face& seed = faces_[first_face];
        if (seed.degenerate || seed.fits_any || seed.group[first_corner] != kNone) return;
        const auto id = static_cast<uint32_t>(groups_.size());
        groups_.push_back({Vec3f(0), seed.vertex[first_corner], seed.positive});
        stack_.assign(1, first_face);
        while (!stack_.empty()) {
            const uint32_t f = stack_.back();
            stack_.pop_back();
            join_group(f, id);
        }
    }

    void join_group(uint32_t f, uint32_t id) {
        Face& face = faces_[f];
        const Group& group = groups_[id];
        const auto at = std::find(face.vertex.begin(), face.vertex.end(), group.vertex);
        if (at == face.vertex.end()) return;
        const auto corner = static_cast<uint32_t>(at - face.vertex.begin());
        if (face.group[corner] != kNone) return;
        const bool untouched =
            face.group[0] == kNone && face.group[1] == kNone && face.group[2] == kNone;
        if (face.fits_any && untouched) face.positive = group.positive;
        if (face.positive != group.positive) return;
        face.group[corner] = id;
        const uint32_t left = face.neighbor[corner];
        const uint32_t right = face.neighbor[(corner + 2) % 3];
        if (right != kNone) stack_.push_back(right);
        if (left != kNone) stack_.push_back(left);
    }

    void sum_groups() {
        for (const Face& face : faces_) {
            if (face.fits_any || face.degenerate) continue;
            for (uint32_t c = 0; c < 3; ++c) {
                const uint32_t v = face.vertex[c];
                const Vec3f& n = mesh_.normals[v];
                const Vec3f to_next = project(position(face.vertex[(c + 1) % 3]) - position(v), n);
                const Vec3f to_last = project(position(face.vertex[(c + 2) % 3]) - position(v), n);
                const float angle = std::acos(std::clamp(dot(to_next, to_last), -1.0f, 1.0f));
                groups_[face.group[c]].sum += angle * project(face.tangent, n);
            }
        }
    }

    Vec4f group_tangent(const Group& group) const {
        Vec3f t = safe_normalize(group.sum, Vec3f(0));
        if (t == Vec3f(0)) return any_tangent(group.vertex);
        return Vec4f(t, group.positive ? 1.0f : -1.0f);
    }

    Vec4f any_tangent(uint32_t vertex) const {
        Vec3f t, b;
        orthonormal_basis(mesh_.normals[vertex], t, b);
        return Vec4f(t, 1);
    }

    // Each vertex gets its first group's tangent; further groups at it get copies of the vertex.
    void write() {
        const auto count = static_cast<uint32_t>(mesh_.positions.size());
        std::vector<uint32_t> any_group(
            count, kNone);  // per welded vertex, for corners that belong to no group
        for (const Face& face : faces_) {
            for (uint32_t c = 0; c < 3; ++c) {
                if (face.group[c] != kNone && any_group[face.vertex[c]] == kNone)
                    any_group[face.vertex[c]] = face.group[c];
            }
        }
        std::vector<uint32_t> owner(count, kNone);      // group of the vertex as it stands
        std::vector<uint32_t> next_copy(count, kNone);  // chain of copies with other groups
        std::vector<bool> seen(count, false);
        mesh_.tangents.assign(count, Vec4f(1, 0, 0, 1));
        for (uint32_t f = 0; f < faces_.size(); ++f) {
            for (uint32_t c = 0; c < 3; ++c) {
                uint32_t group = faces_[f].group[c];
                if (group == kNone) group = any_group[faces_[f].vertex[c]];
                uint32_t v = source(f, c);
                if (!seen[v]) {
                    seen[v] = true;
                    owner[v] = group;
                    mesh_.tangents[v] = group == kNone ? any_tangent(faces_[f].vertex[c])
                                                       : group_tangent(groups_[group]);
                    continue;
                }
                while (owner[v] != group && next_copy[v] != kNone) v = next_copy[v];
                if (owner[v] != group) {
                    const uint32_t copy = duplicate(v);
                    mesh_.tangents.push_back(group_tangent(groups_[group]));
                    owner.push_back(group);
                    next_copy.push_back(kNone);
                    seen.push_back(true);
                    next_copy[v] = copy;
                    v = copy;
                }
                mesh_.indices[size_t{3} * f + c] = v;
            }
        }
    }

    uint32_t duplicate(uint32_t v) {
        const auto copy = [v](auto& values) {
            if (!values.empty()) values.push_back(values[v]);
        };
        copy(mesh_.positions);
        copy(mesh_.normals);
        copy(mesh_.uv[0]);
        copy(mesh_.uv[1]);
        copy(mesh_.colors);
        return static_cast<uint32_t>(mesh_.positions.size() - 1);
    }

    static constexpr size_t kMaxEdgeSharers = 64;

    Mesh& mesh_;
    const std::vector<Vec2f>& uv_;
    std::vector<uint32_t> welded_;
    std::vector<Face> faces_;
    std::vector<Group> groups_;
    std::vector<uint32_t> stack_;
};

}  // namespace

void generate_tangents(Mesh& mesh, uint32_t uv_set) {
    TangentBuilder(mesh, mesh.uv[uv_set]).run();
}

}  // namespace talbot::gltf
