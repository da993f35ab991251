#include "app/hardcases/scene_transform.h"

#include <algorithm>
#include <cmath>

namespace talbot::hardcases {
namespace {

constexpr double kPositionStep = 0x1p-28;

// Column i is where axis i goes.
Mat3d axes_to(const Vec3d& x, const Vec3d& y, const Vec3d& z) {
    return Mat3d(x, y, z);
}

SceneTransform shifted(double distance) {
    SceneTransform t;
    char name[32];
    std::snprintf(name, sizeof(name), "moved by %.0e m", distance);
    t.name = name;
    t.shift = Vec3d(distance, -distance, distance);
    t.promise = Promise::same_picture;
    return t;
}

SceneTransform scaled(int exponent) {
    SceneTransform t;
    t.name = "scaled by 2^" + std::to_string(exponent);
    t.scale = std::ldexp(1.0, exponent);
    return t;
}

SceneTransform scaled_by(const char* name, double scale) {
    SceneTransform t;
    t.name = name;
    t.scale = scale;
    t.promise = Promise::same_picture;
    return t;
}

SceneTransform turned(const char* name, const Mat3d& turn) {
    SceneTransform t;
    t.name = name;
    t.turn = turn;
    t.promise = Promise::same_mean;
    return t;
}

bool turns_about_y(const Mat3d& turn) {
    return turn[1] == Vec3d(0, 1, 0);
}

Mat4d whole_matrix(const SceneTransform& t) {
    Mat4d m(t.turn * t.scale);
    m[3] = Vec4d(t.shift, 1.0);
    return m;
}

Vec3d move_point(const SceneTransform& t, const Vec3d& p) {
    return t.scale * (t.turn * p) + t.shift;
}

// Columns in the opposite order: the sky seen in a mirror across x or z, up to a turn about Y.
std::shared_ptr<const EnvironmentImage> reversed(const EnvironmentImage& image) {
    auto mirrored = std::make_shared<EnvironmentImage>(image);
    for (uint32_t row = 0; row < image.height; ++row) {
        const auto begin =
            mirrored->texels.begin() + static_cast<std::ptrdiff_t>(std::size_t{row} * image.width);
        std::reverse(begin, begin + static_cast<std::ptrdiff_t>(image.width));
    }
    return mirrored;
}

// The lookup is u = atan2(z, x) / 2 pi + 0.5 after the environment's own turn, counter-clockwise
// from above.
void turn_environment(Environment& environment, const Mat3d& turn) {
    if (environment.gradient) {
        environment.gradient->axis = Vec3f(turn * Vec3d(environment.gradient->axis));
    }
    if (!environment.image || turn == Mat3d(1.0)) return;
    const bool mirrors = glm::determinant(turn) < 0;
    // Where +X goes, as an angle counter-clockwise from above (from +X towards -Z).
    const double angle = std::atan2(-turn[0].z, turn[0].x) * 180 / std::numbers::pi;
    if (mirrors) {
        // A mirror across z turns angles round; one across x is that and half a turn.
        environment.image = reversed(*environment.image);
        environment.rotation_degrees = static_cast<float>(angle) - environment.rotation_degrees;
    } else {
        environment.rotation_degrees += static_cast<float>(angle);
    }
}

}  // namespace

std::vector<SceneTransform> scene_transforms(Effort effort) {
    const bool full = effort == Effort::full;
    std::vector<SceneTransform> list;
    for (int power = 2; power <= 7; ++power) list.push_back(shifted(std::pow(10.0, power)));
    for (int exponent = -20; exponent <= 20; ++exponent) {
        const int size = std::abs(exponent);
        if (size != 0 && (full || size == 20 || size == 10 || size == 1))
            list.push_back(scaled(exponent));
    }
    list.push_back(scaled_by("scaled by 1e-5", 1e-5));
    list.push_back(scaled_by("scaled by 1e5", 1e5));
    const Vec3d x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
    list.push_back(turned("turned by 90 degrees about Y", axes_to(-z, y, x)));
    list.push_back(turned("turned by 90 degrees about X", axes_to(x, z, -y)));
    if (full) list.push_back(turned("turned by 90 degrees about Z", axes_to(y, -x, z)));
    list.push_back(turned("mirrored across X", axes_to(-x, y, z)));
    if (full) list.push_back(turned("mirrored across Y", axes_to(x, -y, z)));
    if (full) list.push_back(turned("mirrored across Z", axes_to(x, y, -z)));
    list.push_back(turned("axes permuted", axes_to(y, z, x)));
    return list;
}

bool can_transform(const SceneDesc& scene, const SceneTransform& transform) {
    return !scene.environment.image || turns_about_y(transform.turn);
}

SceneDesc transform_scene(const SceneDesc& scene, const SceneTransform& transform) {
    SceneDesc moved = scene;
    const Mat4d matrix = whole_matrix(transform);
    const auto scale = static_cast<float>(transform.scale);
    for (MeshInstance& instance : moved.instances) {
        const Vec3d position = move_point(transform, Vec3d(instance.world_from_object[3]));
        instance.world_from_object = matrix * instance.world_from_object;
        instance.world_from_object[3] = Vec4d(position, 1.0);
    }
    for (Sphere& sphere : moved.spheres) {
        sphere.center = move_point(transform, sphere.center);
        sphere.radius *= transform.scale;
    }
    for (PunctualLight& light : moved.lights) {
        light.position = move_point(transform, light.position);
        light.direction = Vec3f(transform.turn * Vec3d(light.direction));
        light.range *= scale;
        if (light.kind != PunctualKind::directional) light.intensity *= scale * scale;
    }
    for (Material& material : moved.materials) {
        material.attenuation_distance *= scale;
        material.thickness_factor *= scale;
    }
    turn_environment(moved.environment, transform.turn);
    for (Camera& camera : moved.cameras) camera = transform_camera(camera, transform);
    return moved;
}

Camera transform_camera(const Camera& camera, const SceneTransform& transform) {
    Camera moved = camera;
    moved.position = move_point(transform, camera.position);
    moved.right = transform.turn * camera.right;
    moved.up = transform.turn * camera.up;
    moved.backward = transform.turn * camera.backward;
    moved.xmag *= transform.scale;
    moved.ymag *= transform.scale;
    moved.aperture_radius *= transform.scale;
    moved.focus_distance *= transform.scale;
    return moved;
}

namespace {

Vec3d rounded(const Vec3d& p) {
    return glm::round(p / kPositionStep) * kPositionStep;
}

}  // namespace

void round_positions(SceneDesc& scene) {
    for (MeshInstance& instance : scene.instances) {
        instance.world_from_object[3] = Vec4d(rounded(Vec3d(instance.world_from_object[3])), 1.0);
    }
    for (Sphere& sphere : scene.spheres) sphere.center = rounded(sphere.center);
    for (PunctualLight& light : scene.lights) light.position = rounded(light.position);
}

void round_position(Camera& camera) {
    camera.position = rounded(camera.position);
}

}  // namespace talbot::hardcases
