#include "core/io/gltf/flatten.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/geometry/exact_sign.h"
#include "core/io/gltf/triangles.h"
#include "core/math/robust.h"

namespace talbot::gltf {

namespace {

// Unit columns of the linear part; zero where a column is.
Mat3d directions_of(const Mat4d& m) {
    Mat3d directions(m);
    for (int c = 0; c < 3; ++c) {
        const double size = length(directions[c]);
        directions[c] = size > 0 ? directions[c] / size : Vec3d(0);
    }
    return directions;
}

// The cross product of the two directions that are furthest from parallel.
Vec3d widest_cross(const Mat3d& directions) {
    Vec3d widest(0);
    for (int c = 0; c < 3; ++c) {
        const Vec3d product = cross(directions[c], directions[(c + 1) % 3]);
        if (length(product) > length(widest)) widest = product;
    }
    return widest;
}

// Triangles that the flattening leaves no area.
void drop_lines(Mesh& mesh) {
    const std::vector<Vec3f>& p = mesh.positions;
    keep_triangles(mesh.indices, [&](uint32_t a, uint32_t b, uint32_t c) {
        const bool finite = is_finite(p[a]) && is_finite(p[b]) && is_finite(p[c]);
        return !finite || !exactly_collinear(p[a], p[b], p[c]);
    });
}

}  // namespace

int rank_of(const Mat4d& m) {
    const Mat3d linear(m);
    const double volume = length(linear[0]) * length(linear[1]) * length(linear[2]);
    if (std::abs(glm::determinant(linear)) > kSingularRatio * volume) return 3;
    const Mat3d directions = directions_of(m);
    // So small that the determinant underflows.
    if (std::abs(glm::determinant(directions)) > kSingularRatio) return 0;
    if (length(widest_cross(directions)) > kSingularRatio) return 2;
    return directions == Mat3d(0) ? 0 : 1;
}

Mesh flattened(const Mesh& mesh, const Mat4d& world) {
    const Mat3d linear(world);
    const Mat3d directions = directions_of(world);
    const Vec3d normal = normalize(widest_cross(directions));
    // The direction of the mesh that is lost, on the side from which the thin mesh is not mirrored.
    Vec3d depth = widest_cross(directions_of(Mat4d(glm::transpose(linear))));
    if (depth != Vec3d(0)) depth = normalize(depth);
    if (glm::determinant(linear + glm::outerProduct(normal, depth)) < 0) depth = -depth;
    double lowest = std::numeric_limits<double>::infinity();
    double highest = -lowest;
    for (const Vec3f& p : mesh.positions) {
        lowest = std::min(lowest, dot(depth, Vec3d(p)));
        highest = std::max(highest, dot(depth, Vec3d(p)));
    }
    const double middle = 0.5 * lowest + 0.5 * highest;
    double scale = 0;
    for (int c = 0; c < 3; ++c) scale = std::max(scale, length(linear[c]));

    Mesh flat = mesh;
    for (Vec3f& p : flat.positions) p = Vec3f(linear * Vec3d(p));
    drop_lines(flat);
    for (size_t v = 0; v < flat.positions.size(); ++v) {
        const Vec3d p(mesh.positions[v]);
        const double layer = kFlatLayerShare * scale * (dot(depth, p) - middle);
        flat.positions[v] = Vec3f(linear * p + layer * normal);
    }
    flat.normals.assign(flat.positions.size(), Vec3f(normal));
    const Vec3f along(directions[directions[0] == Vec3d(0) ? 1 : 0]);
    for (Vec4f& t : flat.tangents) {
        const Vec3d turned = linear * Vec3d(Vec3f(t));
        const double size = length(turned);
        t = Vec4f(size > 0 ? Vec3f(turned / size) : along, t.w);
    }
    return flat;
}

uint64_t flattened_bytes(const Mesh& mesh) {
    return mesh.positions.size() * 2 * sizeof(Vec3f) +
           (mesh.tangents.size() + mesh.colors.size()) * sizeof(Vec4f) +
           (mesh.uv[0].size() + mesh.uv[1].size()) * sizeof(Vec2f) +
           mesh.indices.size() * sizeof(uint32_t);
}

}  // namespace talbot::gltf
