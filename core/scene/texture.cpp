// Texture lookup: bilinear or nearest, texels at +0.5, V down. Every texel is decoded to linear
// light before it is weighted.
#include "core/scene/texture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "core/math/robust.h"

namespace talbot {

namespace {

struct DecodeTables {
    std::array<float, 256> linear;
    std::array<float, 256> srgb;
};

// The sRGB transfer function of IEC 61966-2-1, decoded for every byte.
DecodeTables make_decode_tables() {
    DecodeTables tables{};
    for (int i = 0; i < 256; ++i) {
        const double x = i / 255.0;
        const double decoded = x <= 0.04045 ? x / 12.92 : std::pow((x + 0.055) / 1.055, 2.4);
        tables.linear[static_cast<size_t>(i)] = static_cast<float>(x);
        tables.srgb[static_cast<size_t>(i)] = static_cast<float>(decoded);
    }
    return tables;
}

const DecodeTables kDecode = make_decode_tables();

// The coordinate brought into [0, 1] by the wrap mode; a mirrored one is folded.
inline float wrap_coordinate(float u, TextureWrap wrap) {
    switch (wrap) {
        case TextureWrap::repeat:
            return u - std::floor(u);
        case TextureWrap::mirrored_repeat: {
            const float t = u - 2 * std::floor(0.5f * u);
            return t > 1 ? 2 - t : t;
        }
        case TextureWrap::clamp_to_edge:
            break;
    }
    return clamp01(u);
}

struct TexelPair {
    uint32_t first;
    uint32_t second;
    float weight;  // of the second
};

// The two texels beside coordinate u in [0, 1]. Folded and clamped coordinates meet the edge texel
// twice.
inline TexelPair texel_pair(float u, uint32_t size, TextureWrap wrap) {
    const float x = u * static_cast<float>(size) - 0.5f;
    const float below = std::floor(x);
    const auto last = static_cast<int32_t>(size) - 1;
    const auto i = static_cast<int32_t>(below);
    const bool repeats = wrap == TextureWrap::repeat;
    const int32_t first = i < 0 ? (repeats ? last : 0) : (i > last ? last : i);
    const int32_t second = i + 1 > last ? (repeats ? 0 : last) : i + 1;
    return {static_cast<uint32_t>(first), static_cast<uint32_t>(second), x - below};
}

inline uint32_t nearest_texel(float u, uint32_t size) {
    const auto i = static_cast<uint32_t>(u * static_cast<float>(size));
    return i < size ? i : size - 1;
}

}  // namespace

float decode_byte(uint8_t byte, TextureEncoding encoding) {
    return encoding == TextureEncoding::srgb ? kDecode.srgb[byte] : kDecode.linear[byte];
}

Vec4f eval_texture(const Texture& texture, const Vec2f& uv, TextureEncoding encoding) {
    const Image8& image = *texture.image;
    const float* color =
        encoding == TextureEncoding::srgb ? kDecode.srgb.data() : kDecode.linear.data();
    const float* alpha = kDecode.linear.data();
    const uint8_t* texels = image.rgba.data();
    const auto decode = [&](uint32_t x, uint32_t y) {
        const uint8_t* t = texels + 4 * (static_cast<size_t>(y) * image.width + x);
        return Vec4f(color[t[0]], color[t[1]], color[t[2]], alpha[t[3]]);
    };
    if (!is_finite(uv)) return decode(0, 0);

    const float u = wrap_coordinate(uv.x, texture.wrap_u);
    const float v = wrap_coordinate(uv.y, texture.wrap_v);
    if (texture.filter == TextureFilter::nearest) {
        return decode(nearest_texel(u, image.width), nearest_texel(v, image.height));
    }
    const TexelPair x = texel_pair(u, image.width, texture.wrap_u);
    const TexelPair y = texel_pair(v, image.height, texture.wrap_v);
    // In this form equal texels give exactly their value in every channel, whatever the weights:
    // weights that sum to 1 only up to rounding would leave traces in an even area.
    const auto between = [](const Vec4f& a, const Vec4f& b, float weight) {
        return a + (b - a) * weight;
    };
    const Vec4f top = between(decode(x.first, y.first), decode(x.second, y.first), x.weight);
    const Vec4f bottom = between(decode(x.first, y.second), decode(x.second, y.second), x.weight);
    return between(top, bottom, y.weight);
}

Vec4f TexelRange::value(TextureEncoding encoding) const {
    return Vec4f(decode_byte(least[0], encoding), decode_byte(least[1], encoding),
                 decode_byte(least[2], encoding), decode_byte(least[3], TextureEncoding::linear));
}

TexelRange texel_range(const Image8& image) {
    TexelRange range;
    if (image.rgba.size() < 4) return range;
    // Four texels side by side, a byte a lane.
    using Row = uint8_t __attribute__((vector_size(16)));
    Row least = ~Row{};
    Row most{};
    const std::size_t size = image.rgba.size() / 4 * 4;
    const uint8_t* const bytes = image.rgba.data();
    std::size_t i = 0;
    for (; i + sizeof(Row) <= size; i += sizeof(Row)) {
        Row row;
        std::memcpy(&row, bytes + i, sizeof(Row));
        least = row < least ? row : least;
        most = row > most ? row : most;
    }
    for (; i < size; ++i) {
        least[i % sizeof(Row)] = std::min<uint8_t>(least[i % sizeof(Row)], bytes[i]);
        most[i % sizeof(Row)] = std::max<uint8_t>(most[i % sizeof(Row)], bytes[i]);
    }
    range.least = {255, 255, 255, 255};
    range.most = {0, 0, 0, 0};
    for (std::size_t k = 0; k < sizeof(Row); ++k) {
        range.least[k % 4] = std::min<uint8_t>(range.least[k % 4], least[k]);
        range.most[k % 4] = std::max<uint8_t>(range.most[k % 4], most[k]);
    }
    return range;
}

}  // namespace talbot
