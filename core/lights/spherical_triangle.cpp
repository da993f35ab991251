#include "core/lights/spherical_triangle.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace talbot {
namespace {

Vec3d unit(const Vec3d& v) {
    const double l = length(v);
    return l > 0 ? v / l : Vec3d(0);
}

// The part of v that is orthogonal to unit n, normalised.
Vec3d orthogonal_part(const Vec3d& v, const Vec3d& n) {
    return unit(v - dot(v, n) * n);
}

// |p . (q x r)| from the edges at p, which should be the nearest of the three.
double volume(const Vec3d& p, const Vec3d& q, const Vec3d& r) {
    return std::abs(dot(p, cross(q - p, r - p)));
}

// A spherical triangle that is swept round its hub.
struct Sector {
    Vec3d from{0}, hub{0}, to{0};
    double volume = 0;
};

// Van Oosterom and Strackee 1983.
double solid_angle(const Sector& s) {
    const double la = length(s.from);
    const double lb = length(s.hub);
    const double lc = length(s.to);
    const double denominator =
        la * lb * lc + dot(s.from, s.hub) * lc + dot(s.from, s.to) * lb + dot(s.hub, s.to) * la;
    return 2 * std::atan2(s.volume, denominator);
}

Vec3d sample(const Sector& s, double omega, double u, double v) {
    const Vec3d a = unit(s.from);
    const Vec3d b = unit(s.hub);
    const Vec3d c = unit(s.to);
    // The corner c' on arc ac that leaves a sub-triangle of area u omega: a mirrored at a vector in
    // the plane of both, whose parts follow from the half-angle formula of the area.
    const double half = 0.5 * u * omega;
    const double unit_volume = s.volume / (length(s.from) * length(s.hub) * length(s.to));
    const double along_a = unit_volume * std::cos(half) - (dot(a, c) + dot(b, c)) * std::sin(half);
    const double along_c = (1 + dot(a, b)) * std::sin(half);
    const Vec3d axis = along_a * a + along_c * c;
    const double square = dot(axis, axis);
    const Vec3d corner = square > 0 ? 2 * dot(a, axis) / square * axis - a : a;
    // Along the arc from b to c', uniformly in the cosine, counted from 1.
    const Vec3d chord = corner - b;
    const double t = v * 0.5 * dot(chord, chord);
    return (1 - t) * b + std::sqrt(std::max(0.0, t * (2 - t))) * orthogonal_part(corner, b);
}

// Corners that lie almost opposite one another leave the formulas above no digits: a slender
// triangle that passes close by. It is then cut into sectors with no side beyond a right angle: at
// the place nearest to the viewer, the hub, and where a side comes nearest. Swept in order they are
// as continuous as the whole.
struct Sectors {
    std::array<Sector, 6> sector;
    std::array<double, 6> omega{};
    std::size_t count = 0;
    double total = 0;

    void add(const Vec3d& from, const Vec3d& hub, const Vec3d& to) {
        sector[count] = {from, hub, to, volume(hub, from, to)};
        omega[count] = solid_angle(sector[count]);
        total += omega[count];
        ++count;
    }
};

Vec3d nearest_on_edge(const Vec3d& p, const Vec3d& q) {
    const Vec3d edge = q - p;
    const double square = dot(edge, edge);
    return square > 0 ? p + std::clamp(-dot(p, edge) / square, 0.0, 1.0) * edge : p;
}

Sectors cut(const TriangleView& view) {
    const std::array<Vec3d, 4> corner{view.a, view.b, view.c, view.a};
    std::array<Vec3d, 3> near;
    const Vec3d normal = cross(view.b - view.a, view.c - view.a);
    bool above = true;
    Vec3d hub = view.a;
    for (std::size_t i = 0; i < 3; ++i) {
        near[i] = nearest_on_edge(corner[i], corner[i + 1]);
        above = above && dot(cross(corner[i], corner[i + 1]), normal) > 0;
        if (dot(near[i], near[i]) < dot(hub, hub)) hub = near[i];
    }
    if (above) hub = dot(hub, normal) / dot(normal, normal) * normal;
    Sectors sectors;
    for (std::size_t i = 0; i < 3; ++i) {
        if (dot(corner[i], corner[i + 1]) < 0) {
            sectors.add(corner[i], hub, near[i]);
            sectors.add(near[i], hub, corner[i + 1]);
        } else {
            sectors.add(corner[i], hub, corner[i + 1]);
        }
    }
    return sectors;
}

Sector whole(const TriangleView& view) {
    return {view.a, view.b, view.c, volume(view.a, view.b, view.c)};
}

}  // namespace

bool is_wide(const TriangleView& view) {
    return dot(view.a, view.b) < 0 || dot(view.b, view.c) < 0 || dot(view.c, view.a) < 0;
}

double solid_angle(const TriangleView& view) {
    return is_wide(view) ? cut(view).total : solid_angle(whole(view));
}

Vec3d sample_solid_angle(const TriangleView& view, double omega, const Vec2f& u) {
    const auto u0 = static_cast<double>(u.x);
    const auto u1 = static_cast<double>(u.y);
    if (!is_wide(view)) return sample(whole(view), omega, u0, u1);
    const Sectors sectors = cut(view);
    double left = u0 * sectors.total;
    std::size_t last = 0;
    for (std::size_t i = 0; i < sectors.count; ++i) {
        if (!(sectors.omega[i] > 0)) continue;
        last = i;
        if (left < sectors.omega[i]) break;
        left -= sectors.omega[i];
    }
    return sample(sectors.sector[last], sectors.omega[last],
                  std::min(left / sectors.omega[last], 1.0), u1);
}

}  // namespace talbot
