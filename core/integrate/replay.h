// One sample again, alone, with every step written down: the first tool for a black pixel or a
// firefly.
#pragma once

#include <string>

#include "core/integrate/render_scene.h"

namespace talbot {

// Lines of text; the last gives the radiance, in decimal and as hexadecimal floats, equal to the
// bit to what the film got.
std::string replay_sample(const RenderScene& scene, const CameraRays& camera,
                          const PathSettings& settings, uint32_t x, uint32_t y,
                          uint64_t sample_index);

}  // namespace talbot
