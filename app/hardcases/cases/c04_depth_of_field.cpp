// C04: the limits of a thin lens: no aperture, focus at nought and at infinity, size of the blur.
#include <bit>

#include "app/hardcases/worst.h"
#include "core/math/robust.h"
#include "core/scene/camera.h"

namespace talbot::hardcases::c04 {
namespace {

constexpr uint32_t kPixels = 256;

Camera lens(double aperture, double focus) {
    Camera camera;
    look_at(camera, Vec3d(1, 2, 3), Vec3d(0, 0.5, 0));
    camera.aperture_radius = aperture;
    camera.focus_distance = focus;
    return camera;
}

bool same_bits(const Vec3f& a, const Vec3f& b) {
    for (int i = 0; i < 3; ++i) {
        if (std::bit_cast<uint32_t>(a[i]) != std::bit_cast<uint32_t>(b[i])) return false;
    }
    return true;
}

// A textbook lens: through the focal point that lies `focus` along the pinhole ray.
Ray naive_ray(const Camera& camera, const Ray& pinhole, const Vec2f& disk) {
    const auto focus = static_cast<float>(camera.focus_distance);
    Ray ray = pinhole;
    const Vec3f point = pinhole.o + focus * pinhole.d;
    ray.o = pinhole.o + Vec3f(camera.right) * disk.x + Vec3f(camera.up) * disk.y;
    ray.d = glm::normalize(point - ray.o);
    return ray;
}

// Where the ray passes the plane at a distance along the axis, in the camera's frame.
Vec2d at_distance(const Camera& camera, const Ray& ray, double distance) {
    const Vec3d o = Vec3d(ray.o) - camera.position;
    const Vec3d d(ray.d);
    const double t = (distance - dot(o, camera.forward())) / dot(d, camera.forward());
    const Vec3d p = o + t * d;
    return Vec2d(dot(p, camera.right), dot(p, camera.up));
}

CaseResult run(Effort effort) {
    const int count = effort == Effort::full ? 1000000 : 50000;
    Draw draw(0xC04);
    double pinhole_differs = 0;
    Worst naive_parallel, own_parallel, naive_blur, own_blur;
    const Camera sharp = lens(0, 0);
    const Camera far = lens(0.1, std::numeric_limits<double>::infinity());
    const CameraRays sharp_rays(sharp, Vec3d(0), kPixels, kPixels);
    const CameraRays far_rays(far, Vec3d(0), kPixels, kPixels);
    const CameraRays closed(lens(0, 2), Vec3d(0), kPixels, kPixels);
    const CameraRays unfocused(lens(0.1, 0), Vec3d(0), kPixels, kPixels);
    for (int i = 0; i < count; ++i) {
        const auto px = static_cast<float>(draw.between(0, kPixels));
        const auto py = static_cast<float>(draw.between(0, kPixels));
        const Vec2f u(static_cast<float>(draw.unit()) * kOneMinusEpsilon,
                      static_cast<float>(draw.unit()) * kOneMinusEpsilon);
        const Ray pinhole = sharp_rays.ray(px, py, u);
        for (const CameraRays* other : {&closed, &unfocused}) {
            const Ray ray = other->ray(px, py, u);
            pinhole_differs += same_bits(ray.o, pinhole.o) && same_bits(ray.d, pinhole.d) ? 0 : 1;
        }
        // Rays of one pixel are parallel when the focus is at infinity.
        const Ray parallel = far_rays.ray(px, py, u);
        const Vec2f disk = 0.1f * Vec2f(u.x - 0.5f, u.y - 0.5f);
        own_parallel.add(length(Vec3d(parallel.d) - Vec3d(pinhole.d)) /
                         static_cast<double>(kFloatEpsilon));
        naive_parallel.add(length(Vec3d(naive_ray(far, pinhole, disk).d) - Vec3d(pinhole.d)));
        // The blur at a distance d is the lens's point times 1 - d / focus.
        const double focus = draw.log_between(1e-3, 1e6);
        const double radius = draw.log_between(1e-3, 0.3) * focus;
        const double distance = focus * draw.log_between(0.01, 100);
        if (std::abs(distance / focus - 1) < 0.05) continue;
        const Camera camera = lens(radius, focus);
        const CameraRays rays(camera, camera.position, kPixels, kPixels);
        Camera placed = camera;
        placed.position = Vec3d(0);
        const CameraRays centre(lens(0, 0), camera.position, kPixels, kPixels);
        const Ray ray = rays.ray(px, py, u);
        const Ray middle = centre.ray(px, py, u);
        const Vec2d point(dot(Vec3d(ray.o), camera.right), dot(Vec3d(ray.o), camera.up));
        const Vec2d exact = point * (1 - distance / focus);
        const double size = radius * std::abs(1 - distance / focus);
        const auto blur = [&](const Ray& r) {
            return at_distance(placed, r, distance) - at_distance(placed, middle, distance);
        };
        const auto where = [&] {
            return "focus " + std::to_string(focus) + ", radius " + std::to_string(radius) +
                   ", distance " + std::to_string(distance);
        };
        own_blur.add(glm::length(blur(ray) - exact) / size, where);
        naive_blur.add(glm::length(blur(naive_ray(camera, middle, Vec2f(point))) - exact) / size,
                       where);
    }
    CaseResult result;
    result.measures.push_back({"rays without aperture or focus that differ from a pinhole's",
                               kNoControl, pinhole_differs, 0, Gate::at_most, ""});
    result.measures.push_back({"angle between rays of a pixel with focus at infinity, in roundoffs",
                               naive_parallel.figure / static_cast<double>(kFloatEpsilon),
                               own_parallel.figure, 4, Gate::at_most, ""});
    result.measures.push_back(
        {"relative error of the blur against the thin lens, lenses of 1 mm to 1e6 m",
         naive_blur.figure, own_blur.figure, 0.01, Gate::at_most, own_blur.where});
    return result;
}

const bool kAdded =
    add_case({"C04", Priority::p1, "limits of depth of field", "focal point along the pinhole ray",
              "focal plane across the axis, direction from the inverse distance in double",
              "lunadigital/btoa#86", run});

}  // namespace
}  // namespace talbot::hardcases::c04
