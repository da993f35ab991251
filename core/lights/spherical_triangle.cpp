#include "core/lights/spherical_triangle.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/lights/spherical_sector.h"

namespace talbot {
namespace {

// |p . (q x r)| from the edges at p, which should be the nearest of the three.
double volume(const Vec3d& p, const Vec3d& q, const Vec3d& r) {
    return std::abs(dot(p, cross(q - p, r - p)));
}

Sector sector_of(const Vec3d& from, const Vec3d& hub, const Vec3d& to, double volume) {
    return {from, hub, to, length(from), length(hub), length(to), volume};
}

// Corners that lie almost opposite one another leave the formulas above no digits: a slender
// triangle that passes close by. It is then cut into sectors with no side beyond a right angle: at
// the place nearest to the viewer, the hub, and where a side comes nearest. Swept in order they are
// as continuous as the whole.
struct Sectors {
    std::array<Sector, 8> sector;
    std::array<double, 8> omega{};
    std::size_t count = 0;
    double total = 0;

    void add(const Vec3d& from, const Vec3d& hub, const Vec3d& to) {
        sector[count] = sector_of(from, hub, to, volume(hub, from, to));
        omega[count] = sector[count].solid_angle();
        total += omega[count];
        ++count;
    }
};

Vec3d nearest_on_edge(const Vec3d& p, const Vec3d& q) {
    const Vec3d edge = q - p;
    const double square = dot(edge, edge);
    return square > 0 ? p + std::clamp(-dot(p, edge) / square, 0.0, 1.0) * edge : p;
}

// A convex polygon of three or four corners.
template <std::size_t kCorners>
Sectors cut(const std::array<Vec3d, kCorners>& corner, const Vec3d& normal) {
    std::array<Vec3d, kCorners> near;
    bool above = true;
    Vec3d hub = corner[0];
    for (std::size_t i = 0; i < kCorners; ++i) {
        const Vec3d& next = corner[(i + 1) % kCorners];
        near[i] = nearest_on_edge(corner[i], next);
        above = above && dot(cross(corner[i], next), normal) > 0;
        if (dot(near[i], near[i]) < dot(hub, hub)) hub = near[i];
    }
    if (above) hub = dot(hub, normal) / dot(normal, normal) * normal;
    Sectors sectors;
    for (std::size_t i = 0; i < kCorners; ++i) {
        const Vec3d& next = corner[(i + 1) % kCorners];
        if (dot(corner[i], next) < 0) {
            sectors.add(corner[i], hub, near[i]);
            sectors.add(near[i], hub, next);
        } else {
            sectors.add(corner[i], hub, next);
        }
    }
    return sectors;
}

Sectors cut(const TriangleView& view) {
    return cut(std::array{view.a, view.b, view.c}, cross(view.b - view.a, view.c - view.a));
}

Vec3d sample(const Sectors& sectors, const Vec2d& u) {
    double left = u.x * sectors.total;
    std::size_t last = 0;
    for (std::size_t i = 0; i < sectors.count; ++i) {
        if (!(sectors.omega[i] > 0)) continue;
        last = i;
        if (left < sectors.omega[i]) break;
        left -= sectors.omega[i];
    }
    return sectors.sector[last].sample(sectors.omega[last],
                                       std::min(left / sectors.omega[last], 1.0), u.y);
}

Sector whole(const TriangleView& view) {
    return sector_of(view.a, view.b, view.c, volume(view.a, view.b, view.c));
}

}  // namespace

bool is_wide(const TriangleView& view) {
    return dot(view.a, view.b) < 0 || dot(view.b, view.c) < 0 || dot(view.c, view.a) < 0;
}

double solid_angle(const TriangleView& view) {
    return is_wide(view) ? cut(view).total : whole(view).solid_angle();
}

Vec3d sample_solid_angle(const TriangleView& view, double omega, const Vec2d& u) {
    return is_wide(view) ? sample(cut(view), u) : whole(view).sample(omega, u.x, u.y);
}

namespace {

// A parallelogram's corners: a, b and c beside it, d across.
struct Parallelogram {
    Vec3d a, b, c, d;

    explicit Parallelogram(const ParallelogramView& view)
        : a(view.a), b(view.a + view.e1), c(view.a + view.e2), d(b + view.e2) {}

    bool is_wide() const {
        return dot(a, b) < 0 || dot(a, c) < 0 || dot(b, c) < 0 || dot(b, d) < 0 || dot(c, d) < 0;
    }
};

Sectors cut(const Parallelogram& p, const ParallelogramView& view) {
    return cut(std::array{p.a, p.b, p.d, p.c}, cross(view.e1, view.e2));
}

// The halves, swept one after the other round b. Both span the same volume.
struct Halves {
    Sector one, two;
    double omega_one = 0, omega_two = 0;

    Halves(const Parallelogram& p, double volume) {
        const double la = length(p.a), lb = length(p.b), lc = length(p.c), ld = length(p.d);
        one = {p.a, p.b, p.c, la, lb, lc, volume};
        two = {p.c, p.b, p.d, lc, lb, ld, volume};
        omega_one = one.solid_angle();
        omega_two = two.solid_angle();
    }
};

}  // namespace

double solid_angle(const ParallelogramView& view) {
    const Parallelogram p(view);
    if (p.is_wide()) return cut(p, view).total;
    const Halves h(p, std::abs(dot(view.a, cross(view.e1, view.e2))));
    return h.omega_one + h.omega_two;
}

ParallelogramSample sample_solid_angle(const ParallelogramView& view, const Vec2f& u) {
    const Parallelogram p(view);
    const double volume = dot(view.a, cross(view.e1, view.e2));
    ParallelogramSample result;
    if (p.is_wide()) {
        const Sectors sectors = cut(p, view);
        result.omega = sectors.total;
        if (!(result.omega > 0)) return result;
        result.direction = sample(sectors, Vec2d(u));
        // On a's side of the plane through b and c or not.
        result.second = dot(result.direction, cross(p.b, p.c)) * volume < 0;
        return result;
    }
    const Halves h(p, std::abs(volume));
    result.omega = h.omega_one + h.omega_two;
    if (!(result.omega > 0)) return result;
    const double swept = static_cast<double>(u.x) * result.omega;
    result.second = swept >= h.omega_one;
    const double omega = result.second ? h.omega_two : h.omega_one;
    const double left = result.second ? swept - h.omega_one : swept;
    result.direction =
        (result.second ? h.two : h.one)
            .sample(omega, omega > 0 ? std::min(left / omega, 1.0) : 0.0, static_cast<double>(u.y));
    return result;
}

}  // namespace talbot
