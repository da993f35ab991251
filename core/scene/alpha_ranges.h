// What the base colour texture's alpha can be over each triangle of a mesh, so that coverage is
// only asked where it varies: the classes of opacity micromaps, per triangle.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/scene/material.h"
#include "core/scene/mesh.h"
#include "core/scene/texture.h"

namespace talbot {

// Bounds on the texels' alpha bytes.
struct AlphaRange {
    uint8_t least = 0;
    uint8_t most = 255;
};

// The alpha of an image by blocks, for bounds over any box of texels.
class AlphaPyramid {
  public:
    explicit AlphaPyramid(const Image8& image);

    // Bounds over texels x0..x1, y0..y1, both ends included and inside the image. Never too tight.
    AlphaRange range(uint32_t x0, uint32_t y0, uint32_t x1, uint32_t y1) const;

  private:
    struct Level {
        uint32_t width = 0;
        uint32_t height = 0;
        std::vector<AlphaRange> cells;
    };
    const Image8& image_;
    std::vector<Level> levels_;  // cells of 4, 8, 16 ... texels
};

struct MeshAlpha {
    TextureSlot slot;  // what was looked at
    AlphaRange whole;  // over all triangles
    std::vector<AlphaRange> triangles;
};

// Bounds for every triangle, rounding of coordinates included.
MeshAlpha measure_alpha(const Mesh& mesh, const TextureSlot& slot, const Texture& texture,
                        const AlphaPyramid& pyramid);

// How a material's alpha mode judges a texel's byte where nothing else contributes.
struct CoverageLimits {
    uint16_t opaque_from = 256;  // a triangle whose bytes all reach this is always there
    uint16_t clear_below = 0;    // one whose bytes all stay below this never is
};
CoverageLimits coverage_limits(const Material& material);

}  // namespace talbot
