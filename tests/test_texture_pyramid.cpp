// Coarser levels of images: means of linear light over exact areas, against sums in double; lookups
// between them; what they take of memory.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/scene/texture_pyramid.h"
#include "oracles/scene_builder.h"
#include "tests/effect_scenes.h"

namespace talbot {
namespace {

WorkerPool& workers() {
    static WorkerPool pool(2);
    return pool;
}

Image8 random_image(uint32_t width, uint32_t height, uint64_t seed) {
    std::mt19937_64 random(seed);
    Image8 image{width, height, {}, "random"};
    for (uint32_t y = 0; y < height; ++y) {
        for (uint32_t x = 0; x < width; ++x) {
            // The last column and row are bright, so that an image that loses them is darker.
            const bool edge = x + 1 == width || y + 1 == height;
            for (int c = 0; c < 4; ++c)
                image.rgba.push_back(static_cast<uint8_t>(edge ? 250 : random() % 200));
        }
    }
    return image;
}

double decoded(uint8_t byte, bool srgb) {
    const double x = byte / 255.0;
    if (!srgb) return x;
    return x <= 0.04045 ? x / 12.92 : std::pow((x + 0.055) / 1.055, 2.4);
}

// Mean of a channel over [x0, x1) x [y0, y1), in texels; weighted by alpha on demand.
double area_mean(const Image8& image, int channel, bool srgb, bool by_alpha, double x0, double x1,
                 double y0, double y1) {
    double sum = 0, weights = 0;
    for (uint32_t y = 0; y < image.height; ++y) {
        const double h = std::min(y1, y + 1.0) - std::max(y0, 0.0 + y);
        if (h <= 0) continue;
        for (uint32_t x = 0; x < image.width; ++x) {
            const double w = std::min(x1, x + 1.0) - std::max(x0, 0.0 + x);
            if (w <= 0) continue;
            const uint8_t* t = &image.rgba[4 * (std::size_t{y} * image.width + x)];
            const double weight = w * h * (by_alpha ? t[3] / 255.0 : 1);
            sum += weight * decoded(t[channel], srgb && channel < 3);
            weights += weight;
        }
    }
    return sum / weights;
}

// Half the distance of neighbouring bytes about x, in linear light.
double half_step(double x, bool srgb) {
    if (!srgb) return 0.5 / 255;
    int i = 0;
    while (i < 254 && decoded(static_cast<uint8_t>(i + 1), true) <= x) ++i;
    return 0.5 *
           (decoded(static_cast<uint8_t>(i + 1), true) - decoded(static_cast<uint8_t>(i), true));
}

const std::array<std::pair<uint32_t, uint32_t>, 9> kSizes{
    {{2, 2}, {64, 64}, {3, 3}, {5, 4}, {7, 2}, {13, 1}, {1, 6}, {31, 17}, {100, 60}}};

// The largest deviation of a level's mean from the image's, in its own half steps.
template <typename Levels>
double worst_mean(const Image8& image, TexelMean mean, const Levels& levels) {
    const bool srgb = mean == TexelMean::srgb;
    double worst = 0;
    for (const auto& level : levels) {
        for (int c = 0; c < 4; ++c) {
            const bool coded = srgb && c < 3;
            const double want = area_mean(image, c, srgb, false, 0, image.width, 0, image.height);
            const double is = area_mean(*level, c, srgb, false, 0, level->width, 0, level->height);
            // Each texel is off by at most half the coarsest step in the image.
            const double step =
                level->width * level->height == 1 ? half_step(want, coded) : half_step(1, coded);
            worst = std::max(worst, std::abs(is - want) / step);
        }
    }
    return worst;
}

TEST(TexturePyramid, EveryLevelHasTheImagesMean) {
    uint64_t seed = 1;
    for (const auto& [width, height] : kSizes) {
        const Image8 image = random_image(width, height, seed++);
        for (const TexelMean mean : {TexelMean::linear, TexelMean::srgb}) {
            const auto levels = coarser_levels(image, mean);
            ASSERT_FALSE(levels.empty());
            EXPECT_EQ(levels.back()->width, 1u);
            EXPECT_EQ(levels.back()->height, 1u);
            EXPECT_LE(worst_mean(image, mean, levels), 1.001) << width << "x" << height;
        }
    }
    // Controls: levels that drop the odd column and row, and levels of means of bytes.
    const Image8 odd = random_image(5, 5, seed);
    auto dropped = std::make_shared<Image8>();
    dropped->width = dropped->height = 2;
    auto of_bytes = std::make_shared<Image8>();
    of_bytes->width = of_bytes->height = 1;
    for (std::size_t y = 0; y < 2; ++y) {
        for (std::size_t x = 0; x < 2; ++x) {
            for (std::size_t c = 0; c < 4; ++c) {
                const auto at = [&](std::size_t i, std::size_t j) {
                    return unsigned{odd.rgba[4 * ((2 * y + j) * 5 + 2 * x + i) + c]};
                };
                dropped->rgba.push_back(
                    static_cast<uint8_t>((at(0, 0) + at(1, 0) + at(0, 1) + at(1, 1)) / 4));
            }
        }
    }
    for (std::size_t c = 0; c < 4; ++c) {
        unsigned sum = 0;
        for (std::size_t i = 0; i < 25; ++i) sum += odd.rgba[4 * i + c];
        of_bytes->rgba.push_back(static_cast<uint8_t>(sum / 25));
    }
    using Levels = std::vector<std::shared_ptr<const Image8>>;
    EXPECT_GT(worst_mean(odd, TexelMean::linear, Levels{dropped}), 4);
    EXPECT_GT(worst_mean(odd, TexelMean::srgb, Levels{of_bytes}), 4);
}

TEST(TexturePyramid, TexelsAreMeansOverTheirAreas) {
    uint64_t seed = 100;
    for (const auto& [width, height] : kSizes) {
        const Image8 image = random_image(width, height, seed++);
        for (const TexelMean mean :
             {TexelMean::linear, TexelMean::srgb, TexelMean::srgb_by_alpha}) {
            const Image8 half = *coarser_levels(image, mean).front();
            const bool srgb = mean != TexelMean::linear;
            const double sx = static_cast<double>(width) / half.width;
            const double sy = static_cast<double>(height) / half.height;
            for (uint32_t y = 0; y < half.height; ++y) {
                for (uint32_t x = 0; x < half.width; ++x) {
                    for (int c = 0; c < 4; ++c) {
                        const bool by_alpha = mean == TexelMean::srgb_by_alpha && c < 3;
                        const double want = area_mean(image, c, srgb, by_alpha, x * sx,
                                                      (x + 1) * sx, y * sy, (y + 1) * sy);
                        const double is = decoded(half.rgba[4 * (std::size_t{y} * half.width + x) +
                                                            static_cast<std::size_t>(c)],
                                                  srgb && c < 3);
                        // Transparent texels weigh next to nothing, but not nothing.
                        const double room = by_alpha ? 0.002 : 1e-6;
                        EXPECT_NEAR(is, want, half_step(want, srgb && c < 3) + room)
                            << width << "x" << height << " " << x << "," << y << " " << c;
                    }
                }
            }
        }
    }
}

TEST(TexturePyramid, WhatIsTransparentDoesNotColourWhatIsNot) {
    const Image8 leaf{2, 1, {200, 40, 10, 254, 0, 255, 0, 0}, "leaf"};
    const Image8 weighted = *coarser_levels(leaf, TexelMean::srgb_by_alpha).front();
    EXPECT_EQ(weighted.rgba, (std::vector<uint8_t>{200, 40, 10, 127}));
    const Image8 plain = *coarser_levels(leaf, TexelMean::srgb).front();
    EXPECT_GT(plain.rgba[1], 150) << "control";
    // Where nothing is opaque the plain mean is left.
    const Image8 clear{2, 1, {200, 0, 0, 0, 200, 0, 100, 0}, "clear"};
    const Image8 mean = *coarser_levels(clear, TexelMean::srgb_by_alpha).front();
    EXPECT_EQ(mean.rgba[0], 200);
    EXPECT_EQ(mean.rgba[3], 0);
}

TEST(TexturePyramid, LookupsGoFromTheTextureItselfToItsMean) {
    SceneBuilder builder;
    const uint32_t index = add_texture(builder.desc(), 8, [](uint32_t x, uint32_t y) {
        return (x + y) % 2 == 0 ? std::array{255, 255, 255, 255} : std::array{0, 0, 0, 255};
    });
    Material m = SceneBuilder::diffuse(1);
    m.base_color_texture = slot_of(index);
    m.normal_texture = slot_of(index);
    builder.mesh(textured_quad(Vec3f(0), Vec3f(1, 0, 0), Vec3f(0, 1, 0)), builder.material(m));
    const auto scene = builder.build(workers());
    const auto pyramids = make_texture_pyramids(*scene, workers(), nullptr);
    const TexturePyramid* pyramid = pyramids->find(index, TexelMean::srgb);
    ASSERT_NE(pyramid, nullptr);
    EXPECT_NE(pyramids->find(index, TexelMean::linear), nullptr);
    EXPECT_EQ(pyramids->find(index, TexelMean::srgb_by_alpha), nullptr) << "nobody asks for it";
    EXPECT_EQ(pyramid->log2_side, 3);
    Texture texture = scene->textures()[index];
    const Vec2f uv(0.5f / 8, 0.5f / 8);  // the middle of a white texel
    const auto at = [&](float level) {
        return eval_pyramid(texture, *pyramid, uv, level, TextureEncoding::srgb).x;
    };
    const float grey = at(1);
    EXPECT_NEAR(grey, 0.5f, 0.004f);
    for (const float level : {-kInfinity, -1.0f, 0.0f, std::nanf("")}) EXPECT_EQ(at(level), 1);
    EXPECT_NEAR(at(0.25f), 1 + 0.25f * (grey - 1), 1e-6f);
    for (const float level : {1.5f, 3.0f, 40.0f, kInfinity}) EXPECT_EQ(at(level), grey);
    texture.levels = TextureLevels::nearest;
    EXPECT_EQ(at(0.49f), 1);
    EXPECT_EQ(at(0.51f), grey);
}

TEST(TexturePyramid, ATextureWithoutLevelsHasNone) {
    SceneBuilder builder;
    const auto noise = [](uint32_t x, uint32_t y) {
        return std::array{static_cast<int>(x * 16), static_cast<int>(y * 16), 0, 255};
    };
    const uint32_t with = add_texture(builder.desc(), 16, noise);
    const uint32_t without = add_texture(builder.desc(), 16, noise);
    const uint32_t lamp = add_texture(builder.desc(), 16, noise);
    const uint32_t even = add_texture(builder.desc(), 16, [](uint32_t, uint32_t) {
        return std::array{9, 9, 9, 255};
    });
    builder.desc().textures[without].levels = TextureLevels::none;
    Material m = SceneBuilder::diffuse(1);
    m.base_color_texture = slot_of(with);
    m.normal_texture = slot_of(without);
    m.emissive_texture = slot_of(lamp);
    m.metallic_roughness_texture = slot_of(even);
    builder.mesh(textured_quad(Vec3f(0), Vec3f(1, 0, 0), Vec3f(0, 1, 0)), builder.material(m));
    const auto scene = builder.build(workers());
    const auto pyramids = make_texture_pyramids(*scene, workers(), nullptr);
    EXPECT_NE(pyramids->find(with, TexelMean::srgb), nullptr);
    for (const uint32_t t : {without, lamp, even}) {
        for (const TexelMean mean : {TexelMean::linear, TexelMean::srgb, TexelMean::srgb_by_alpha})
            EXPECT_EQ(pyramids->find(t, mean), nullptr) << t;
    }
    // A third of the one image that has levels, rounded down.
    EXPECT_EQ(pyramids->bytes(), 4u * (64 + 16 + 4 + 1));
    // An edited copy of the scene shares them.
    const auto again = make_texture_pyramids(*scene, workers(), pyramids.get());
    EXPECT_EQ(again->find(with, TexelMean::srgb)->levels[1].image,
              pyramids->find(with, TexelMean::srgb)->levels[1].image);
}

}  // namespace
}  // namespace talbot
