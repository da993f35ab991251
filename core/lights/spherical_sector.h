// A spherical triangle that is swept round its hub, from one side to the other: its solid angle
// (Van Oosterom and Strackee 1983) and uniform sampling of it (Arvo 1995, with the corner of Peters
// 2021).
#pragma once

#include <algorithm>
#include <cmath>

#include "core/math/vec.h"

namespace talbot {

// Corners relative to the point that sees them, with their distances, and the volume of the
// parallelepiped that they span, taken from edges: it decides about small and distant sectors.
struct Sector {
    Vec3d from{0}, hub{0}, to{0};
    double l_from = 0, l_hub = 0, l_to = 0;
    double volume = 0;

    double solid_angle() const {
        const double denominator = l_from * l_hub * l_to + dot(from, hub) * l_to +
                                   dot(from, to) * l_hub + dot(hub, to) * l_from;
        return 2 * std::atan2(volume, denominator);
    }

    // A unit direction; u of the sector's area lie between `from` and it.
    Vec3d sample(double omega, double u, double v) const {
        const Vec3d a = unit(from, l_from);
        const Vec3d b = unit(hub, l_hub);
        const Vec3d c = unit(to, l_to);
        // The corner c' on arc ac that leaves a sub-triangle of area u omega: a mirrored at a
        // vector in the plane of both, whose parts follow from the half-angle formula of the area.
        const double half = 0.5 * u * omega;
        const double unit_volume = volume / (l_from * l_hub * l_to);
        const double sine = std::sin(half);
        const double along_a = unit_volume * std::cos(half) - (dot(a, c) + dot(b, c)) * sine;
        const double along_c = (1 + dot(a, b)) * sine;
        const Vec3d axis = along_a * a + along_c * c;
        const double square = dot(axis, axis);
        const Vec3d corner = square > 0 ? 2 * dot(a, axis) / square * axis - a : a;
        // Along the arc from b to c', uniformly in the cosine, counted from 1.
        const Vec3d chord = corner - b;
        const double t = v * 0.5 * dot(chord, chord);
        const Vec3d across = corner - dot(corner, b) * b;
        return (1 - t) * b + std::sqrt(std::max(0.0, t * (2 - t))) * unit(across, length(across));
    }

  private:
    static Vec3d unit(const Vec3d& v, double l) { return l > 0 ? v / l : Vec3d(0); }
};

}  // namespace talbot
