// G04: needles under grazing rays, and triangles without area among good ones.
#include <cmath>
#include <cstdint>

#include "app/hardcases/cases/case_run.h"
#include "app/hardcases/cases/case_scenes.h"
#include "app/hardcases/cases/exact_oracles.h"
#include "app/hardcases/cases/mesh_shapes.h"

namespace talbot::hardcases::g04 {
namespace {

using namespace geometry;

struct NeedleScore {
    Failures set;      // hit or miss differs from binary128
    Failures outside;  // the hit lies outside the triangle's bounds by more than the bound on t
    Largest t_error;   // in units of eps (|o| + t)

    void merge(const NeedleScore& later) {
        set.merge(later.set);
        outside.merge(later.outside);
        t_error.merge(later.t_error);
    }
};

struct Needle {
    std::array<Vec3f, 3> triangle;
    Ray ray;
};

// Aspect 10 to 1e8, the ray within half a degree of its plane.
Needle random_needle(Rng& rng) {
    const float aspect = std::pow(10.0f, rng.uniform(1, 8));
    const int axis = rng.between(0, 2);
    const auto point = [&](float along, float across, float up) {
        Vec3f p;
        p[axis] = along;
        p[(axis + 1) % 3] = across;
        p[(axis + 2) % 3] = up;
        return p;
    };
    const float width = 1 / aspect;
    Needle needle;
    needle.triangle = {point(0, 0, 0), point(1, rng.uniform(-width, width), 0),
                       point(rng.uniform(), width, rng.uniform(-width, width))};
    const Vec3f shift = rng.below(2) != 0 ? Vec3f(0) : rng.in_box(-10, 10);
    for (Vec3f& p : needle.triangle) p += shift;
    float b0 = rng.uniform();
    float b1 = rng.uniform();
    if (b0 + b1 > 1) {
        b0 = 1 - b0;
        b1 = 1 - b1;
    }
    const auto& tri = needle.triangle;
    const Vec3f target = tri[0] + b0 * (tri[1] - tri[0]) + b1 * (tri[2] - tri[0]);
    const float angle = rng.uniform(-1, 1) * kPi / 360;
    const float turn = rng.uniform(0, 2 * kPi);
    needle.ray.o =
        target + rng.uniform(0.5f, 20) * point(std::cos(turn), std::sin(turn), std::sin(angle));
    needle.ray.d = target - needle.ray.o;
    return needle;
}

double beyond(const std::array<Vec3f, 3>& tri, const Ray& ray, double t) {
    double far = 0;
    for (int i = 0; i < 3; ++i) {
        const double p = ray.o[i] + t * ray.d[i];
        const double low = std::min({tri[0][i], tri[1][i], tri[2][i]});
        const double high = std::max({tri[0][i], tri[1][i], tri[2][i]});
        far = std::max({far, low - p, p - high});
    }
    return far;
}

// Moeller-Trumbore's t, or NaN where it has none.
double naive_t(const Ray& ray, const std::array<Vec3f, 3>& tri) {
    if (!moeller_trumbore(ray, tri)) return NAN;
    const Vec3f e1 = tri[1] - tri[0];
    const Vec3f e2 = tri[2] - tri[0];
    const Vec3f q = talbot::cross(ray.o - tri[0], e1);
    return talbot::dot(e2, q) / talbot::dot(e1, talbot::cross(ray.d, e2));
}

void see_needle(Rng& rng, NeedleScore& score) {
    const Needle needle = random_needle(rng);
    const auto& tri = needle.triangle;
    const Ray& ray = needle.ray;
    if (ray.d == Vec3f(0)) return;
    const auto where = [&] { return hex(ray) + " triangle " + hex(tri); };
    Quad numerator = 0;
    Quad denominator = 0;
    const bool expect = exact_triangle<Quad>(ray, tri, numerator, denominator);
    TriangleHit hit{};
    const bool found = own_triangle(ray, tri, hit);
    const double naive = naive_t(ray, tri);
    const bool ahead = expect && (numerator > 0) == (denominator > 0) && numerator != 0;
    score.set.see(std::isnan(naive) == ahead, found != expect, where);
    const double direction = length(Vec3d(ray.d));
    const double origin = length(Vec3d(ray.o));
    // eps (|o| + t) as a length.
    const auto unit = [&](double t) { return 0x1p-24 * (origin + std::abs(t) * direction); };
    const auto is_outside = [&](double t) { return beyond(tri, ray, t) > 32 * unit(t); };
    score.outside.see(!std::isnan(naive) && is_outside(naive), found && is_outside(hit.t), where);
    if (!found || !expect) return;
    const auto t = static_cast<double>(numerator / denominator);
    const double naive_error = std::isnan(naive) ? 0 : std::abs(naive - t) * direction / unit(t);
    score.t_error.see(naive_error, std::abs(hit.t - t) * direction / unit(t), where);
}

// Triangles without area among the mesh's own vertices: points, doubled vertices and, on edges
// along an axis, midpoints.
void add_degenerate(Mesh& mesh, Rng& rng, int count) {
    const auto vertices = static_cast<uint32_t>(mesh.positions.size());
    const auto corners = static_cast<uint32_t>(mesh.indices.size());
    for (int i = 0; i < count; ++i) {
        const uint32_t a = mesh.indices[rng.below(corners)];
        const uint32_t b = rng.below(vertices);
        const Vec3f edge = glm::abs(mesh.positions[1] - mesh.positions[0]);
        const bool along_axis = max_component(edge) == edge.x + edge.y + edge.z;
        if (i % 3 == 2 && along_axis && mesh.normals.empty()) {
            mesh.positions.push_back(0.5f * (mesh.positions[0] + mesh.positions[1]));
            const auto middle = static_cast<uint32_t>(mesh.positions.size() - 1);
            mesh.indices.insert(mesh.indices.end(), {0, middle, 1});
        } else {
            mesh.indices.insert(mesh.indices.end(), {a, a, i % 2 == 0 ? a : b});
        }
    }
}

SceneDesc lamp_scene(bool with_degenerate) {
    SceneDesc desc = cornell_desc();
    if (!with_degenerate) return desc;
    Rng rng(7);
    for (Mesh& mesh : desc.meshes) add_degenerate(mesh, rng, 60);
    return desc;
}

// Control: unit normals as often written.
uint64_t naive_nan_normals() {
    uint64_t bad = 0;
    for (const Mesh& mesh : lamp_scene(true).meshes) {
        for (size_t i = 0; i < mesh.triangle_count(); ++i) {
            const Vec3f& a = mesh.positions[mesh.indices[3 * i]];
            const Vec3f n = talbot::cross(mesh.positions[mesh.indices[3 * i + 1]] - a,
                                          mesh.positions[mesh.indices[3 * i + 2]] - a);
            const Vec3f unit = n / std::sqrt(talbot::dot(n, n));
            bad += !(unit.x == unit.x && unit.y == unit.y && unit.z == unit.z);
        }
    }
    return bad;
}

CaseResult run(Effort effort) {
    CaseResult result;
    const NeedleScore needles = over_inputs<NeedleScore>(1, inputs(effort, 2e5, 3e6), see_needle);
    result.measures.push_back(needles.set.measure("needles hit or missed against binary128"));
    result.measures.push_back(needles.outside.measure("hits outside the padded bounds"));
    result.measures.push_back(needles.t_error.measure("error of t in units of eps (|o| + t)", 32));

    const Camera camera = cornell_camera();
    RenderWith with;
    with.passes = effort == Effort::full ? 64 : 4;
    const Rendering plain = render(lamp_scene(false), camera, with);
    const Rendering mixed = render(lamp_scene(true), camera, with);
    result.nonfinite = mixed.nonfinite;
    result.measures.push_back(
        {"pixels that change with triangles without area", static_cast<double>(naive_nan_normals()),
         static_cast<double>(differing_pixels(plain, mixed)), 0, Gate::at_most, ""});
    result.measures.push_back({"normals or samples that are not finite",
                               static_cast<double>(naive_nan_normals()),
                               static_cast<double>(mixed.nonfinite), 0, Gate::at_most, ""});
    return result;
}

const bool kAdded = add_case(
    {"G04", Priority::p0, "needles and triangles without area",
     "Moeller-Trumbore; normalised cross product",
     "exactly degenerate triangles are dropped and counted; the hit set and t are those of the "
     "float inputs",
     "RenderKit/embree#387, OpenMoonRay/openmoonray#251, svenstaro/bvh#44", run});

}  // namespace
}  // namespace talbot::hardcases::g04
