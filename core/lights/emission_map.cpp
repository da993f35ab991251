#include "core/lights/emission_map.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/scene/texel_runs.h"

namespace talbot {
namespace {

constexpr uint32_t kBlock = 8;  // texels

}  // namespace

EmissionMap::EmissionMap(const Material& material, std::span<const Texture> textures) {
    const Rgb factor = material.emissive_factor * material.emissive_strength;
    if (!material.emissive_texture.used()) {
        mean_ = luminance(factor);
        return;
    }
    const Texture& texture = textures[material.emissive_texture.texture];
    const TexelRange range = texel_range(*texture.image);
    if (range.is_constant(kChannelsRgb)) {
        mean_ = luminance(factor * Rgb(range.value(TextureEncoding::srgb)));
        return;
    }
    texture_ = texture;
    sum_blocks(*texture_.image, factor);
}

void EmissionMap::sum_blocks(const Image8& image, const Rgb& factor) {
    std::array<std::array<float, 256>, 3> terms{};
    for (int c = 0; c < 3; ++c) {
        Rgb one(0);
        one[c] = factor[c];
        const float scale = luminance(one);
        for (int i = 0; i < 256; ++i)
            terms[static_cast<std::size_t>(c)][static_cast<std::size_t>(i)] =
                scale * decode_byte(static_cast<uint8_t>(i), TextureEncoding::srgb);
    }
    blocks_x_ = (image.width + kBlock - 1) / kBlock;
    const uint32_t blocks_y = (image.height + kBlock - 1) / kBlock;
    const std::size_t stride = std::size_t{blocks_x_} + 1;
    sums_.assign(stride * (std::size_t{blocks_y} + 1), 0);
    lit_.assign(sums_.size(), 0);
    for (uint32_t y = 0; y < image.height; ++y) {
        const uint8_t* texel = &image.rgba[std::size_t{4} * y * image.width];
        double* row = &sums_[(std::size_t{y} / kBlock + 1) * stride + 1];
        for (uint32_t x = 0; x < image.width; x += kBlock) {
            float sum = 0;
            for (uint32_t i = x; i < std::min(x + kBlock, image.width); ++i, texel += 4)
                sum += terms[0][texel[0]] + terms[1][texel[1]] + terms[2][texel[2]];
            row[x / kBlock] += sum;
        }
    }
    for (std::size_t y = 1; y <= blocks_y; ++y) {
        double across = 0;
        uint32_t lit_across = 0;
        for (std::size_t x = 1; x < stride; ++x) {
            const std::size_t i = y * stride + x;
            across += sums_[i];
            lit_across += sums_[i] > 0 ? 1 : 0;
            sums_[i] = across + sums_[i - stride];
            lit_[i] = lit_across + lit_[i - stride];
        }
    }
    mean_ = sums_.back() / (static_cast<double>(image.width) * image.height);
}

double EmissionMap::mean(const Vec2f& lower, const Vec2f& upper) const {
    if (!texture_.image) return mean_;
    const TexelRuns across =
        texels_between(lower.x, upper.x, texture_.image->width, texture_.wrap_u);
    const TexelRuns down =
        texels_between(lower.y, upper.y, texture_.image->height, texture_.wrap_v);
    const std::size_t stride = std::size_t{blocks_x_} + 1;
    double sum = 0;
    double texels = 0;
    uint32_t lit = 0;
    for (int j = 0; j < down.count; ++j) {
        const std::size_t y0 = down.first[j] / kBlock * stride;
        const std::size_t y1 = (down.last[j] / kBlock + 1) * stride;
        for (int i = 0; i < across.count; ++i) {
            const std::size_t x0 = across.first[i] / kBlock;
            const std::size_t x1 = across.last[i] / kBlock + 1;
            sum += sums_[y1 + x1] - sums_[y0 + x1] - sums_[y1 + x0] + sums_[y0 + x0];
            lit += lit_[y1 + x1] - lit_[y0 + x1] - lit_[y1 + x0] + lit_[y0 + x0];
            texels += static_cast<double>((x1 - x0) * kBlock) *
                      static_cast<double>((y1 - y0) / stride * kBlock);
        }
    }
    if (lit == 0) return 0;
    // The difference of large sums may round to nothing; a lit block must keep its chance.
    constexpr double kFloor = 0x1p-20;
    return std::max(sum / texels, kFloor * mean_);
}

}  // namespace talbot
