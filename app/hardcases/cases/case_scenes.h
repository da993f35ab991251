// Scenes in code for the image cases: put together and rendered by Talbot's own kernels.
#pragma once

#include <cstdint>
#include <string>

#include "app/hardcases/cases/gltf_text.h"
#include "app/hardcases/hard_case.h"
#include "core/base/result.h"
#include "core/film/film.h"
#include "core/film/image.h"
#include "core/scene/scene.h"

namespace talbot::hardcases::geometry {

Material diffuse(const Rgb& reflectance);
Material emitter(const Rgb& radiance);
// Of a closed body; white light takes on `color` after `distance` metres in it.
Material glass(float ior, const Rgb& color, float distance);

Mesh quad_mesh(const Vec3f& corner, const Vec3f& edge1, const Vec3f& edge2);
// Outward by winding.
Mesh box_mesh(const Vec3f& lower, const Vec3f& upper);
// A unit sphere of latitudes and longitudes with the exact normals of the sphere.
Mesh uv_sphere_mesh(uint32_t stacks, uint32_t slices);

uint32_t add_material(SceneDesc& desc, const Material& material);
void add_mesh(SceneDesc& desc, Mesh mesh, uint32_t material, const Mat4d& world = Mat4d(1.0));
void add_sphere(SceneDesc& desc, const Vec3d& center, double radius, uint32_t material);

Mat4d scaling(double s);
Mat4d translation(const Vec3d& by);

// A room with coloured walls, a lamp, a block with a decal just above its top, a ball of coloured
// glass, a faceted ball with smooth normals and a small glass plate; and its camera.
SceneDesc cornell_desc();
Camera cornell_camera();

// The scene and its camera with all lengths multiplied, or moved in double.
SceneDesc scaled(SceneDesc desc, double s);
Camera scaled(Camera camera, double s);
SceneDesc moved(SceneDesc desc, const Vec3d& by);
Camera moved(Camera camera, const Vec3d& by);

struct RenderWith {
    uint32_t width = 64;
    uint32_t height = 64;
    uint64_t passes = 4;
    uint32_t max_depth = 64;
    bool russian_roulette = true;
};

struct Rendering {
    Film film;
    ImageRgba image;
    uint64_t nonfinite = 0;
};

Rendering render(const SceneDesc& desc, const Camera& camera, const RenderWith& with);

// Pixels whose exact sums differ.
uint64_t differing_pixels(const Rendering& a, const Rendering& b);
double relmse(const ImageRgba& image, const ImageRgba& reference);

// Reads glTF text as a file would be read.
Result<SceneDesc> load_text(const std::string& gltf);

}  // namespace talbot::hardcases::geometry
