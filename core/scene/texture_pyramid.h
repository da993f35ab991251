// Coarser levels of images, each of half the size of the one before, for lookups of areas. Made
// from the mean of linear light over exactly the area of a texel, whatever the size, and stored as
// bytes of the image's own encoding: a third of the image on top.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "core/base/worker_pool.h"
#include "core/scene/texture.h"

namespace talbot {

class Scene;

// What the levels are means of. Colours of surfaces with coverage are weighted by alpha, so that
// what is not there does not colour what is.
enum class TexelMean : uint8_t { linear, srgb, srgb_by_alpha };
inline constexpr std::size_t kTexelMeans = 3;

constexpr TextureEncoding encoding_of(TexelMean mean) {
    return mean == TexelMean::linear ? TextureEncoding::linear : TextureEncoding::srgb;
}

// The image in half the size (rounded down, at least 1), and so on to a single texel.
std::vector<std::shared_ptr<const Image8>> coarser_levels(const Image8& image, TexelMean mean);

// A texture with its levels; the first is the image itself, looked up as the others are.
struct TexturePyramid {
    std::vector<Texture> levels;
    float log2_side = 0;  // of the image: half the logarithm of its number of texels
};

// Lookup at a level that counts from 0, the image, in steps of a factor of two; at 0 and below, or
// where it is no number, that of the texture by itself. Between levels as the texture asks.
Vec4f eval_pyramid(const Texture& texture, const TexturePyramid& pyramid, const Vec2f& uv,
                   float level, TextureEncoding encoding);

// The pyramids of a scene. Immutable and shared.
class TexturePyramids {
  public:
    // Null where there is none: the lookup is that of the texture.
    const TexturePyramid* find(uint32_t texture, TexelMean mean) const {
        return table_[texture][static_cast<std::size_t>(mean)].get();
    }
    bool is_empty() const { return bytes() == 0; }
    // Of all coarser levels.
    uint64_t bytes() const;

  private:
    friend std::shared_ptr<const TexturePyramids> make_texture_pyramids(
        const Scene& scene, WorkerPool& pool, const TexturePyramids* previous);
    std::vector<std::array<std::shared_ptr<const TexturePyramid>, kTexelMeans>> table_;
};

// Of every texture that a material looks up but for light that it emits. Reuses the levels of
// `previous`, which may be null.
std::shared_ptr<const TexturePyramids> make_texture_pyramids(const Scene& scene, WorkerPool& pool,
                                                             const TexturePyramids* previous);

}  // namespace talbot
