// How bright an emissive texture is over parts of it: block sums, so that a triangle's power is
// that of its own texels and a triangle that shows none but black ones is known not to be a light.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/scene/material.h"
#include "core/scene/texture.h"

namespace talbot {

class EmissionMap {
  public:
    // Of the material's emissive factor, strength and texture, which may be unused.
    EmissionMap(const Material& material, std::span<const Texture> textures);

    // Mean luminance, in nits, of everything that the texture shows.
    double mean() const { return mean_; }
    // The same near texture coordinates (after the slot's transform) between two corners. 0 only
    // where every lookup between them is black.
    double mean(const Vec2f& lower, const Vec2f& upper) const;

  private:
    void sum_blocks(const Image8& image, const Rgb& factor);

    double mean_ = 0;
    Texture texture_;  // without an image where the emission is the same everywhere
    uint32_t blocks_x_ = 0;
    // Summed over all blocks above and to the left, one row and column of zeros first.
    std::vector<double> sums_;
    std::vector<uint32_t> lit_;  // blocks with a texel that is not black
};

}  // namespace talbot
