// One sample again, alone, with every step written down: the first tool for a black pixel or a
// firefly.
#pragma once

#include <string>
#include <vector>

#include "core/integrate/render_scene.h"

namespace talbot {

// Lines of text; the last gives the radiance, in decimal and as hexadecimal floats, equal to the
// bit to what the film got.
struct ReplayedPath {
    struct Vertex {
        Vec3d point{0};  // world
        uint32_t material = 0;
        uint32_t object = 0;
        float pdf = 0;  // of the direction in which it goes on; 0 where it ends
    };
    uint32_t x = 0;
    uint32_t y = 0;
    uint64_t sample = 0;
    Rgb radiance{0};
    Vec3d start{0};  // on the lens, world
    std::vector<Vertex> vertices;
    bool escapes = false;     // its last ray meets nothing
    Vec3d last_direction{0};  // of that ray
    std::string log;
};
ReplayedPath replay_path(const RenderScene& scene, const CameraRays& camera,
                         const PathSettings& settings, uint32_t x, uint32_t y,
                         uint64_t sample_index);

// The log alone.
std::string replay_sample(const RenderScene& scene, const CameraRays& camera,
                          const PathSettings& settings, uint32_t x, uint32_t y,
                          uint64_t sample_index);

}  // namespace talbot
