// Images and the way they are looked up. Texels are decoded to linear light before filtering, as
// glTF asks.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/math/vec.h"

namespace talbot {

// 8-bit texels as stored in the file, row 0 on top. Four channels always; a grey file is
// replicated, missing alpha is 255.
struct Image8 {
    uint32_t width = 0;
    uint32_t height = 0;
    std::vector<uint8_t> rgba;
    std::string name;
};

// Bits of the channels R, G, B, A.
inline constexpr unsigned kChannelsRgb = 7;
inline constexpr unsigned kChannelsRgba = 15;
inline constexpr unsigned kChannelAlpha = 8;

enum class TextureWrap : uint8_t { repeat, mirrored_repeat, clamp_to_edge };
enum class TextureFilter : uint8_t { linear, nearest };
// What of an image's coarser levels a lookup takes, should levels be in use at all.
enum class TextureLevels : uint8_t { none, nearest, blended };

// An image with its sampler. Immutable and shared.
struct Texture {
    std::shared_ptr<const Image8> image;
    TextureWrap wrap_u = TextureWrap::repeat;
    TextureWrap wrap_v = TextureWrap::repeat;
    TextureFilter filter = TextureFilter::linear;
    // Where a texel is smaller than what is looked up (glTF's minFilter).
    TextureLevels levels = TextureLevels::blended;
    TextureFilter level_filter = TextureFilter::linear;
};

// How colour channels are decoded: the alpha channel is linear in both.
enum class TextureEncoding : uint8_t { linear, srgb };

// A stored byte as linear light.
float decode_byte(uint8_t byte, TextureEncoding encoding);

// Least and greatest byte of each channel over a whole image.
struct TexelRange {
    std::array<uint8_t, 4> least{0, 0, 0, 0};
    std::array<uint8_t, 4> most{255, 255, 255, 255};

    // Whether each of these channels has the same byte everywhere, so that every lookup gives it.
    bool is_constant(unsigned channels) const {
        for (unsigned c = 0; c < 4; ++c) {
            if ((channels >> c & 1) != 0 && least[c] != most[c]) return false;
        }
        return true;
    }
    // What a lookup gives where the channels are constant.
    Vec4f value(TextureEncoding encoding) const;
};
TexelRange texel_range(const Image8& image);

// Filtered lookup at uv (V down, any finite value; non-finite gives texel 0,0). Channels in 0..1.
Vec4f eval_texture(const Texture& texture, const Vec2f& uv, TextureEncoding encoding);

inline constexpr uint32_t kNoTexture = 0xFFFFFFFFu;

// A material slot's reference: which texture, which UV set, and KHR_texture_transform folded to uv'
// = matrix * (u, v, 1).
struct TextureSlot {
    uint32_t texture = kNoTexture;  // index into the scene's texture table
    uint8_t uv_set = 0;             // 0 or 1
    bool has_transform = false;
    Vec3f transform_u{1, 0, 0};  // u' = dot(transform_u, (u, v, 1))
    Vec3f transform_v{0, 1, 0};

    bool used() const { return texture != kNoTexture; }
    Vec2f apply(const Vec2f& uv) const {
        if (!has_transform) return uv;
        const Vec3f p(uv.x, uv.y, 1.0f);
        return Vec2f(dot(transform_u, p), dot(transform_v, p));
    }
    bool operator==(const TextureSlot&) const = default;
};

}  // namespace talbot
