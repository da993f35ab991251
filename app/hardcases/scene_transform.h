// A whole scene moved, scaled, turned or mirrored, lights and camera with it, so that the picture
// should stay what it was.
#pragma once

#include <string>
#include <vector>

#include "app/hardcases/hard_case.h"
#include "core/scene/scene_desc.h"

namespace talbot::hardcases {

// What is promised of the picture.
enum class Promise {
    same_bytes,    // scaled by a power of two
    same_picture,  // moved or scaled otherwise: relMSE at most kSamePicture
    same_mean,  // turned or mirrored: sampling frames turn differently, so only within Monte Carlo
                // error
};

struct SceneTransform {
    std::string name;
    Mat3d turn{1.0};  // a signed permutation of axes
    double scale = 1;
    Vec3d shift{0};
    Promise promise = Promise::same_bytes;
};

// Those of a run: more powers of two and mirrors with full effort.
std::vector<SceneTransform> scene_transforms(Effort effort);

// Whether the scene's environment can be turned like that: an image only about +Y, and mirrored.
bool can_transform(const SceneDesc& scene, const SceneTransform& transform);

// Radiance stays: intensities of point and spot lights grow with the square of the scale, distances
// of attenuation with the scale.
SceneDesc transform_scene(const SceneDesc& scene, const SceneTransform& transform);
Camera transform_camera(const Camera& camera, const SceneTransform& transform);

// Positions of nodes, spheres and lights rounded to multiples of 2^-28 m, so that a shift of whole
// metres below 2^24 is exact.
void round_positions(SceneDesc& scene);
void round_position(Camera& camera);

}  // namespace talbot::hardcases
