// The emission map against dense lookups: no lit texel is ever called black, black parts are found,
// and means are those of the texels.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "core/lights/emission_map.h"
#include "core/math/robust.h"

namespace talbot {
namespace {

Texture sparse_texture(uint32_t width, uint32_t height, std::mt19937& random, int lit_texels) {
    auto image = std::make_shared<Image8>();
    image->width = width;
    image->height = height;
    image->rgba.assign(std::size_t{4} * width * height, 0);
    for (int i = 0; i < lit_texels; ++i) {
        const std::size_t texel = random() % (std::size_t{width} * height);
        for (std::size_t c = 0; c < 3; ++c) image->rgba[4 * texel + c] = 200;
    }
    Texture texture;
    texture.image = image;
    return texture;
}

Material emissive_material() {
    Material material;
    material.emissive_factor = Rgb(1, 0.5f, 0.25f);
    material.emissive_strength = 3;
    material.emissive_texture.texture = 0;
    return material;
}

TEST(EmissionMap, CallsNothingBlackThatShines) {
    std::mt19937 random(7);
    std::uniform_real_distribution<float> unit(0, 1);
    const Material material = emissive_material();
    int black = 0;
    for (int round = 0; round < 60; ++round) {
        Texture texture =
            sparse_texture(1 + static_cast<uint32_t>(random() % 70),
                           1 + static_cast<uint32_t>(random() % 70), random, 1 + round % 4);
        texture.wrap_u = static_cast<TextureWrap>(random() % 3);
        texture.wrap_v = static_cast<TextureWrap>(random() % 3);
        texture.filter = static_cast<TextureFilter>(random() % 2);
        const std::vector<Texture> textures{texture};
        const EmissionMap map(material, textures);
        for (int box = 0; box < 400; ++box) {
            const Vec2f lower(6 * unit(random) - 3, 6 * unit(random) - 3);
            const Vec2f size(std::pow(unit(random), 3.0f) * 1.5f,
                             std::pow(unit(random), 3.0f) * 1.5f);
            if (map.mean(lower, lower + size) > 0) continue;
            ++black;
            for (int i = 0; i < 100; ++i) {
                // Most lookups along the sides of the box, where a texel is lost first.
                Vec2f at(unit(random), unit(random));
                if (i % 5 < 4) at[i % 5 / 2] = static_cast<float>(i % 2);
                at = lower + size * at;
                const Vec4f texel = eval_texture(texture, at, TextureEncoding::srgb);
                ASSERT_EQ(texel.x, 0) << "round " << round << " uv " << at.x << " " << at.y;
            }
        }
    }
    // The test saw black boxes at all.
    EXPECT_GT(black, 2000);
}

TEST(EmissionMap, MeansAreThoseOfTheTexels) {
    std::mt19937 random(11);
    const Texture texture = sparse_texture(256, 128, random, 8000);
    const std::vector<Texture> textures{texture};
    const Material material = emissive_material();
    const EmissionMap map(material, textures);
    const auto texel_mean = [&](uint32_t x0, uint32_t x1, uint32_t y0, uint32_t y1) {
        double sum = 0;
        for (uint32_t y = y0; y < y1; ++y) {
            for (uint32_t x = x0; x < x1; ++x) {
                const Vec2f uv((static_cast<float>(x) + 0.5f) / 256,
                               (static_cast<float>(y) + 0.5f) / 128);
                sum += luminance(material.emissive_factor * material.emissive_strength *
                                 Rgb(eval_texture(texture, uv, TextureEncoding::srgb)));
            }
        }
        return sum / ((x1 - x0) * (y1 - y0));
    };
    const double whole = texel_mean(0, 256, 0, 128);
    EXPECT_NEAR(map.mean() / whole, 1, 1e-5);
    // Two texels inside blocks 4 to 7 and 3 to 5, so that the guard stays within them.
    const double part = map.mean(Vec2f(34.0f / 256, 26.0f / 128), Vec2f(61.0f / 256, 45.0f / 128));
    EXPECT_NEAR(part / texel_mean(32, 64, 24, 48), 1, 1e-5);
    // The same place three turns away, and a box across the seam.
    EXPECT_EQ(part,
              map.mean(Vec2f(3 + 34.0f / 256, 26.0f / 128), Vec2f(3 + 61.0f / 256, 45.0f / 128)));
    EXPECT_NEAR(map.mean(Vec2f(0, 0), Vec2f(1, 1)) / whole, 1, 1e-5);
}

TEST(EmissionMap, WithoutTextureIsTheFactor) {
    Material material = emissive_material();
    material.emissive_texture = TextureSlot{};
    const EmissionMap map(material, {});
    const double expected = luminance(material.emissive_factor * material.emissive_strength);
    EXPECT_EQ(map.mean(), expected);
    EXPECT_EQ(map.mean(Vec2f(0), Vec2f(1)), expected);
}

}  // namespace
}  // namespace talbot
