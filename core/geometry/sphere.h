// Ray-sphere intersection in double, with the origin's distance to the surface from compensated
// sums: a ground sphere of radius 1e7 seen from a millimetre above it and a marble at 1e7 radii
// come out alike. References: Haines, Guenther, Akenine-Moeller 2019, "Precision improvements for
// ray/sphere intersection" (Ray Tracing Gems, chapter 7); Ogita, Rump, Oishi 2005, "Accurate sum
// and dot product".
#pragma once

#include <cmath>

#include "core/math/ray.h"
#include "core/math/vec.h"

namespace talbot {

namespace sphere_detail {

inline constexpr double kSplitter = 0x1p27 + 1;

// The rounding error of a * a (Dekker 1971).
inline double square_error(double a, double square) {
    const double t = kSplitter * a;
    const double high = t - (t - a);
    const double low = a - high;
    return ((high * high - square) + 2 * high * low) + low * low;
}

inline void add_exactly(double& sum, double& error, double x) {
    const double s = sum + x;
    const double x_part = s - sum;
    error += (sum - (s - x_part)) + (x - x_part);
    sum = s;
}

// |o - c|^2 - r^2 as if in twice the precision.
inline double power_of_point(const Vec3d& o, const Vec3d& c, double r) {
    double sum = 0;
    double error = 0;
    for (int i = 0; i < 3; ++i) {
        double f = o[i];
        double f_error = 0;
        add_exactly(f, f_error, -c[i]);
        const double square = f * f;
        add_exactly(sum, error, square);
        error += square_error(f, square) + 2 * f * f_error;
    }
    const double square = r * r;
    add_exactly(sum, error, -square);
    return sum + (error - square_error(r, square));
}

}  // namespace sphere_detail

// Both crossings of the ray's line with the sphere in rising order; false when it misses.
inline bool sphere_roots(const Vec3d& o, const Vec3d& d, const Vec3d& center, double radius,
                         double& t0, double& t1) {
    const Vec3d f = o - center;
    const double a = dot(d, d);
    const double b = 0.0 - dot(f, d);  // never -0, whose sign would swap the roots
    // Squared distance from the centre to the line, free of the cancellation in b^2 - a c.
    const Vec3d nearest = f + (b / a) * d;
    const double discriminant = radius * radius - dot(nearest, nearest);
    if (!(discriminant >= 0)) return false;
    const double c = sphere_detail::power_of_point(o, center, radius);
    const double q = b + std::copysign(std::sqrt(a * discriminant), b);
    const double far_root = q / a;
    const double near_root = q == 0 ? 0.0 : c / q;
    t0 = b >= 0 ? near_root : far_root;
    t1 = b >= 0 ? far_root : near_root;
    return true;
}

// Crossings that count for a ray that may start on this sphere (skip_from) or end on it (skip_to):
// at most two, in rising order. A ray that leaves the surface never meets it again; one that goes
// inside meets only the far side. At its end, the crossing nearest to t_max is the end point
// itself.
inline int sphere_hits(const Ray& ray, bool skip_from, bool skip_to, const Vec3d& center,
                       double radius, float (&t)[2]) {
    double t0 = 0;
    double t1 = 0;
    const Vec3d o(ray.o);
    const Vec3d d(ray.d);
    if (skip_from && !(dot(o - center, d) < 0)) return 0;
    if (!sphere_roots(o, d, center, radius, t0, t1)) return 0;
    bool use0 = !skip_from;
    bool use1 = true;
    if (skip_to) {
        const double end = ray.t_max;
        if (std::abs(t0 - end) < std::abs(t1 - end)) {
            use0 = false;
        } else {
            use1 = false;
        }
    }
    int count = 0;
    if (use0) t[count++] = static_cast<float>(t0);
    if (use1) t[count++] = static_cast<float>(t1);
    return count;
}

}  // namespace talbot
