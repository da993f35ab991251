// The tables of a scene as the double build wants them: the same numbers, each float widened.
#pragma once

#include "core/integrate/render_scene.h"
#include "core/scene/camera.h"
#include "core/scene/scene_desc.h"
#include "double/core/integrate/render_scene.h"
#include "double/core/scene/camera.h"
#include "double/core/scene/scene_desc.h"

namespace twin {

talbot_double::SceneDesc to_double(const talbot::SceneDesc& desc);
talbot_double::Camera to_double(const talbot::Camera& camera);
talbot_double::PathSettings to_double(const talbot::PathSettings& settings);

}  // namespace twin
