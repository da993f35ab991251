// G16: chains of 1 to 32 glTF nodes that turn, scale and move, and back again.
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>

#include "app/hardcases/cases/case_run.h"
#include "app/hardcases/cases/case_scenes.h"
#include "core/integrate/surface_interaction.h"
#include "core/integrate/tiers.h"

namespace talbot::hardcases::g16 {
namespace {

using namespace geometry;
using Json = nlohmann::json;

// An affine map in any precision, as a matrix by rows.
template <class T>
struct Affine {
    T m[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    T at[3] = {0, 0, 0};

    Affine operator*(const Affine& b) const {
        Affine r;
        for (int i = 0; i < 3; ++i) {
            r.at[i] = at[i];
            for (int k = 0; k < 3; ++k) r.at[i] += m[i][k] * b.at[k];
            for (int j = 0; j < 3; ++j) {
                r.m[i][j] = 0;
                for (int k = 0; k < 3; ++k) r.m[i][j] += m[i][k] * b.m[k][j];
            }
        }
        return r;
    }
};

// Numbers of one node, as the file has them.
struct Node {
    double matrix[16];

    template <class T>
    Affine<T> affine() const {
        Affine<T> a;
        for (int i = 0; i < 3; ++i) {
            for (int j = 0; j < 3; ++j) a.m[i][j] = static_cast<T>(matrix[4 * j + i]);
            a.at[i] = static_cast<T>(matrix[12 + i]);
        }
        return a;
    }
};

Node turn_scale_move(int level, bool back) {
    // Turned about an axis, scaled by 1.7, moved by 1e3; or the inverse of it.
    const double angle = 0.4 + 0.1 * level;
    const double c = std::cos(angle);
    const double s = std::sin(angle);
    Mat3d turn(1.0);
    const int i = level % 3;
    const int j = (level + 1) % 3;
    turn[i][i] = turn[j][j] = c;
    turn[i][j] = s;
    turn[j][i] = -s;
    Mat4d m(turn * 1.7);
    m[3] = Vec4d(600, -600, 529, 1);
    if (back) m = glm::inverse(m);
    Node node{};
    for (int col = 0; col < 4; ++col) {
        for (int row = 0; row < 4; ++row) node.matrix[4 * col + row] = m[col][row];
    }
    return node;
}

// `levels` nodes out, as many back, so that the mesh stands near the world's origin again.
std::vector<Node> chain(int levels, bool and_back) {
    std::vector<Node> nodes;
    for (int k = 0; k < levels; ++k) nodes.push_back(turn_scale_move(k, false));
    for (int k = levels - 1; and_back && k >= 0; --k) nodes.push_back(turn_scale_move(k, true));
    return nodes;
}

template <class T>
Affine<T> composed(const std::vector<Node>& nodes) {
    Affine<T> world;
    for (const Node& node : nodes) world = world * node.affine<T>();
    return world;
}

// The mesh of the text hung under the chain, twice so that it stays an instance.
std::string with_chain(const std::string& text, const std::vector<Node>& nodes) {
    Json json = Json::parse(text);
    Json list = Json::array();
    for (size_t k = 0; k < nodes.size(); ++k) {
        Json node = {{"matrix", nodes[k].matrix}};
        if (k + 1 < nodes.size()) {
            node["children"] = {k + 1};
        } else {
            node["mesh"] = 0;
        }
        list.push_back(node);
    }
    Json twin = list.back();
    twin["matrix"] = Json::array({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1});
    twin["mesh"] = 0;
    twin.erase("children");
    list.back()["children"] = {list.size()};
    list.push_back(twin);
    json["nodes"] = list;
    json["scenes"][0]["nodes"] = {0};
    json.erase("cameras");
    return json.dump();
}

struct Deep {
    Largest point;  // in eps times the extent
    Failures leaks;
    void merge(const Deep& later) {
        point.merge(later.point);
        leaks.merge(later.leaks);
    }
};

Deep see_chain(const Mesh& mesh, const std::string& text, const std::vector<Node>& nodes,
               uint64_t seed, uint64_t rays) {
    Deep all;
    const Result<SceneDesc> desc = load_text(with_chain(text, nodes));
    if (!desc || desc->instances.size() != 2) {
        all.leaks.see(false, true, [&] { return desc ? "instances" : desc.error().line(); });
        return all;
    }
    const auto scene = Scene::build(*desc, workers());
    const Affine<long double> exact = composed<long double>(nodes);
    const Affine<float> naive = composed<float>(nodes);
    // Size of the object in the world.
    double extent = 0;
    for (int i = 0; i < 3; ++i) {
        double reach = 0;
        for (int j = 0; j < 3; ++j) reach += std::abs(static_cast<double>(exact.m[i][j]));
        extent = std::max(extent, 2 * reach);
    }
    const auto point = [&](const auto& map, const Vec3d& p, auto zero) {
        using T = decltype(zero);
        Vec3d out;
        for (int i = 0; i < 3; ++i) {
            T sum = map.at[i];
            for (int j = 0; j < 3; ++j) sum += map.m[i][j] * static_cast<T>(p[j]);
            out[i] = static_cast<double>(sum - static_cast<T>(scene->origin()[i]));
        }
        return out;
    };
    return over_inputs<Deep>(seed, rays, [&](Rng& rng, Deep& score) {
        const uint32_t triangle = rng.below(static_cast<uint32_t>(mesh.triangle_count()));
        const uint32_t* index = &mesh.indices[size_t{3} * triangle];
        const bool edge = rng.below(2) != 0;
        const double b1 = rng.uniform();
        const double b2 = edge ? 0 : (1 - b1) * static_cast<double>(rng.uniform());
        const Vec3d object = (1 - b1 - b2) * Vec3d(mesh.positions[index[0]]) +
                             b1 * Vec3d(mesh.positions[index[1]]) +
                             b2 * Vec3d(mesh.positions[index[2]]);
        const Vec3d target = point(exact, object, 0.0L);
        const Vec3d inside = point(exact, Vec3d(rng.in_box(-0.2f, 0.2f)), 0.0L);
        Ray ray;
        ray.o = Vec3f(inside);
        ray.d = Vec3f(target - Vec3d(ray.o));
        Hit hit;
        const bool found = scene->accel().closest(ray, hit);
        const auto where = [&] { return line("%zu nodes ", nodes.size()) + hex(ray); };
        score.leaks.see(false, !found, where);
        if (!found) return;
        const auto si = make_surface_interaction<kMatteTier>(*scene, ray, hit);
        const Mesh& stored =
            scene->geometry().meshes[scene->geometry().instances[hit.id.instance].mesh];
        const uint32_t* at = &stored.indices[size_t{3} * hit.id.primitive];
        const double u = hit.u;
        const double v = hit.v;
        const Vec3d hit_object = (1 - u - v) * Vec3d(stored.positions[at[0]]) +
                                 u * Vec3d(stored.positions[at[1]]) +
                                 v * Vec3d(stored.positions[at[2]]);
        const Vec3d expected = point(exact, hit_object, 0.0L);
        score.point.see(length(point(naive, hit_object, 0.0f) - expected) / (0x1p-24 * extent),
                        length(Vec3d(si.p) - expected) / (0x1p-24 * extent), where);
    });
}

CaseResult run(Effort effort) {
    CaseResult result;
    Mesh mesh = uv_sphere_mesh(24, 48);
    mesh.normals.clear();
    SceneDesc desc;
    add_mesh(desc, mesh, add_material(desc, diffuse(Rgb(0.5f))));
    const std::string text = gltf_text(desc, Camera{}, 64, 64);
    Deep all;
    Sweep sweep{"levels", "error of hit points in eps times the extent", false, 8, {}};
    uint64_t seed = 0;
    for (const bool and_back : {false, true}) {
        for (const int levels : {1, 2, 4, 8, 16, 32}) {
            const Deep d =
                see_chain(mesh, text, chain(levels, and_back), ++seed, inputs(effort, 1500, 60000));
            if (and_back)
                sweep.points.push_back({static_cast<double>(levels), d.point.naive, d.point.own});
            all.merge(d);
        }
    }
    result.measures.push_back(all.point.measure("error of hit points in eps times the extent", 8));
    Measure leaks = all.leaks.measure("rays that leave the closed mesh");
    leaks.naive = NAN;
    result.measures.push_back(leaks);
    result.sweeps = {sweep};
    return result;
}

const bool kAdded =
    add_case({"G16", Priority::p1, "deep instancing", "matrices multiplied in float",
              "one matrix a placed mesh, composed in double, re-centred",
              "developer.blender.org/D6250", run});

}  // namespace
}  // namespace talbot::hardcases::g16
