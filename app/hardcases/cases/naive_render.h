// Control of the image cases: a path tracer as it is often written. Lambert surfaces, one light
// sample a bounce, the hit point as o + t d, and one fixed length against self-hits.
#pragma once

#include "app/hardcases/cases/case_scenes.h"

namespace talbot::hardcases::geometry {

ImageRgba naive_render(const SceneDesc& desc, const Camera& camera, const RenderWith& with,
                       float epsilon);

// The room of cornell_desc with diffuse surfaces only.
SceneDesc plain_desc();

}  // namespace talbot::hardcases::geometry
