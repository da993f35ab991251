// C01: cameras far from the world's origin or with a tiny field of view: where the rays go, to a
// hundredth of a pixel.
#include <numbers>

#include "app/hardcases/worst.h"
#include "core/scene/camera.h"

namespace talbot::hardcases::c01 {
namespace {

using Real = long double;
struct Vec3l {
    Real x, y, z;
};
Vec3l operator+(const Vec3l& a, const Vec3l& b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
}
Vec3l operator-(const Vec3l& a, const Vec3l& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
Vec3l operator*(Real s, const Vec3l& v) {
    return {s * v.x, s * v.y, s * v.z};
}
Real dot(const Vec3l& a, const Vec3l& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
Real length(const Vec3l& v) {
    return std::sqrt(dot(v, v));
}
Vec3l wide(const Vec3d& v) {
    return {v.x, v.y, v.z};
}
Vec3l wide(const Vec3f& v) {
    return wide(Vec3d(v));
}

constexpr uint32_t kPixels = 1000;

// Distance of a point from the line through `from` along `along`, over the distance along it.
Real angle_off(const Vec3l& point, const Vec3l& from, const Vec3l& along) {
    const Vec3l v = point - from;
    const Vec3l unit = (1 / length(along)) * along;
    const Real s = dot(v, unit);
    return length(v - s * unit) / std::abs(s);
}

// The control: a direction as the difference of two world points in float (unprojected, as by an
// inverse view-projection).
Vec3f naive_direction(const Camera& camera, const Vec3l& exact) {
    const Vec3f eye(camera.position);
    const Vec3l point = wide(camera.position) + exact;
    const Vec3f world(static_cast<float>(point.x), static_cast<float>(point.y),
                      static_cast<float>(point.z));
    return glm::normalize(world - eye);
}

// Largest error of rays in pixels, at the distance of what the camera looks at: the world's origin
// lies `offset` away from the scene, the scene's size is what the camera sees.
void look(Worst& naive, Worst& own, double offset, double fov_degrees, bool mean_pixel, Draw& draw,
          int count) {
    const double fov = fov_degrees * std::numbers::pi / 180;
    const Vec3d target = offset * Vec3d(0.6, 0.64, -0.48);
    Camera camera;
    camera.yfov = fov;
    // A scene of 2 m that fills the view, but not from nearer than 1 m.
    const double distance = std::max(1.0, 1 / std::tan(fov / 2));
    look_at(camera, target + distance * normalize(Vec3d(0.3, 0.5, 0.8)), target);
    const double extent = distance * std::tan(std::min(fov / 2, 1.5));
    const Bounds bounds{Vec3f(static_cast<float>(-extent)), Vec3f(static_cast<float>(extent))};
    const CameraRays rays(camera, target, kPixels, kPixels, bounds);
    const Real half = std::tan(static_cast<Real>(fov) / 2);
    for (int i = 0; i < count; ++i) {
        const auto px = static_cast<float>(draw.between(0, kPixels));
        const auto py = static_cast<float>(draw.between(0, kPixels));
        const Real x = (2 * static_cast<Real>(px) / kPixels - 1) * half;
        const Real y = (1 - 2 * static_cast<Real>(py) / kPixels) * half;
        const Vec3l exact = x * wide(camera.right) + y * wide(camera.up) - wide(camera.backward);
        // The pixel's own angle, which shrinks with the square of the cosine; or the mean one.
        const Real pixel = mean_pixel ? static_cast<Real>(fov) / kPixels
                                      : 2 * half / kPixels / (1 + x * x + y * y);
        const Vec3l eye = wide(camera.position) - wide(target);
        const auto where = [&] {
            return std::to_string(fov_degrees) + " degrees at " + std::to_string(offset) +
                   " m, position " + std::to_string(px) + "," + std::to_string(py);
        };
        // Where the ray is at the depth of the target, as a direction from the exact eye.
        const Ray ray = rays.ray(px, py, Vec2f(0));
        const Vec3l forward = wide(camera.forward());
        const auto error = [&](const Vec3l& o, const Vec3l& d) {
            const Real t = (distance - dot(o - eye, forward)) / dot(d, forward);
            return angle_off(o + t * d, eye, exact) / pixel;
        };
        own.add(static_cast<double>(error(wide(ray.o), wide(ray.d))), where);
        naive.add(static_cast<double>(error(wide(Vec3f(camera.position)) - wide(target),
                                            wide(naive_direction(camera, exact)))),
                  where);
    }
}

CaseResult run(Effort effort) {
    const int count = effort == Effort::full ? 20000 : 500;
    Draw draw(0xC01);
    Worst naive, own;
    Sweep by_offset{
        "distance from the world's origin in metres", "error of rays in pixels", true, 0.01, {}};
    Sweep by_fov{"field of view in degrees", "error of rays in pixels", true, 0.01, {}};
    const auto take = [&](double offset, double fov, Sweep& sweep, double parameter) {
        Worst n, o;
        look(n, o, offset, fov, false, draw, count);
        naive.add(n.figure, [&] { return n.where; });
        own.add(o.figure, [&] { return o.where; });
        sweep.points.push_back({parameter, n.figure, o.figure});
    };
    for (const double offset : {1e3, 1e4, 1e5, 1e6, 1e7}) take(offset, 40, by_offset, offset);
    for (const double fov : {1e-4, 1e-3, 1e-2, 0.1, 1.0, 10.0, 90.0, 170.0})
        take(1e7, fov, by_fov, fov);
    CaseResult result;
    result.measures.push_back(
        {"error of rays in pixels of 1000 rows, 1e3 to 1e7 m away, 1e-4 to 170 degrees",
         naive.figure, own.figure, 0.01, Gate::at_most, own.where});
    // In the corner of such a view a pixel's own angle is 2 tan(fov / 2) / 1000 / (1 + 2 tan^2) =
    // 9e-7 radians: a hundredth of it is less than the rounding of a float direction, 6e-8. At 170
    // degrees it is ten times more than that.
    Worst wide_naive, wide_own;
    look(wide_naive, wide_own, 1e7, 179.9, true, draw, count);
    result.measures.push_back({"the same at 179.9 degrees, in pixels of the mean angle",
                               wide_naive.figure, wide_own.figure, 0.01, Gate::at_most,
                               wide_own.where});
    result.sweeps = {by_offset, by_fov};
    return result;
}

const bool kAdded = add_case(
    {"C01", Priority::p0, "far cameras and tiny fields of view",
     "direction between two world points in float",
     "direction in camera space in double; rays of a far camera begin where the scene does",
     "three-gpu-pathtracer#178, mitsuba3#62, mrdoob/three.js#10408", run});

}  // namespace
}  // namespace talbot::hardcases::c01
