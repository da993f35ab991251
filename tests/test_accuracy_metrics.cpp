// Error metrics against closed forms, and the block test against the null and planted differences.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "core/accuracy/metrics.h"

namespace talbot {
namespace {

ImageRgba constant_image(uint32_t width, uint32_t height, const Rgb& c) {
    ImageRgba image;
    image.width = width;
    image.height = height;
    image.rgb.assign(std::size_t{width} * height, c);
    return image;
}

TEST(Metrics, ClosedForms) {
    const ImageRgba reference = constant_image(20, 12, Rgb(0.5f, 1, 2));
    EXPECT_EQ(compare_images(reference, reference, 0).relrmse_percent, 0);
    const ImageRgba image = constant_image(20, 12, Rgb(0.75f, 1, 1.5f));
    const ImageErrors e = compare_images(image, reference, 0);
    const double relmse = (0.0625 / 0.26 + 0.25 / 4.01) / 3;
    EXPECT_NEAR(e.relmse, relmse, 1e-15);
    EXPECT_NEAR(e.relrmse_percent, 100 * std::sqrt(relmse), 1e-12);
    EXPECT_NEAR(e.trimmed_percent, 100 * std::sqrt(relmse), 1e-12);
    EXPECT_NEAR(e.worst_block_percent, 100 * std::sqrt(relmse), 1e-12);
    EXPECT_NEAR(e.mse, 0.3125 / 3, 1e-15);
    EXPECT_NEAR(e.rmse, std::sqrt(0.3125 / 3), 1e-15);
    EXPECT_NEAR(e.mae, 0.25, 1e-15);
    EXPECT_NEAR(e.bias, -0.25 / 3.5, 1e-15);
}

// Exposing the images and exposing the metric are the same.
TEST(Metrics, ExposureScalesTheConstant) {
    std::mt19937 random(1);
    std::exponential_distribution<float> value(10);
    ImageRgba a = constant_image(9, 9, Rgb(0)), b = a;
    for (std::size_t i = 0; i < a.rgb.size(); ++i) {
        a.rgb[i] = Rgb(value(random), value(random), value(random));
        b.rgb[i] = Rgb(value(random), value(random), value(random));
    }
    ImageRgba a8 = a, b8 = b;
    for (Rgb& c : a8.rgb) c *= 8;
    for (Rgb& c : b8.rgb) c *= 8;
    const ImageErrors exposed = compare_images(a, b, 3), scaled = compare_images(a8, b8, 0);
    EXPECT_NEAR(exposed.relmse / scaled.relmse, 1, 1e-12);
    EXPECT_NEAR(exposed.mse / scaled.mse, 1, 1e-12);
    EXPECT_NEAR(exposed.mae / scaled.mae, 1, 1e-12);
    EXPECT_NE(compare_images(a, b, 0).relmse, scaled.relmse);
}

TEST(Metrics, OnePixelInTheTrimAndItsBlock) {
    const ImageRgba reference = constant_image(100, 50, Rgb(1));
    ImageRgba image = reference;
    image.rgb[33 * 100 + 77] = Rgb(100);
    const ImageErrors e = compare_images(image, reference, 0);
    const double one = 99.0 * 99 / 1.01;
    EXPECT_NEAR(e.relmse / (one / 5000), 1, 1e-12);
    EXPECT_EQ(e.trimmed_percent, 0);
    EXPECT_EQ(e.worst_block_x, 72u);
    EXPECT_EQ(e.worst_block_y, 32u);
    EXPECT_NEAR(e.worst_block_percent, 100 * std::sqrt(one / 64), 1e-9);
    // The last column of blocks is four pixels wide.
    image = reference;
    image.rgb[99] = Rgb(2);
    EXPECT_NEAR(compare_images(image, reference, 0).worst_block_percent,
                100 * std::sqrt(1 / 1.01 / 32), 1e-9);
}

TEST(Metrics, NotFinitePixelsAreNeverHidden) {
    const ImageRgba reference = constant_image(4, 4, Rgb(1));
    for (const float bad :
         {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
        ImageRgba image = reference;
        image.rgb[5].y = bad;
        const ImageErrors e = compare_images(image, reference, 0);
        EXPECT_EQ(e.not_finite, 1u);
        EXPECT_TRUE(std::isinf(e.relrmse_percent));
        const std::vector<float> map = pixel_errors(image, reference, 0);
        EXPECT_TRUE(std::isinf(map[5]));
        const ImageBytes picture = error_picture(map, 4, 4);
        EXPECT_EQ(picture.bytes[15], 255);
        EXPECT_EQ(picture.bytes[16], 0);
        EXPECT_EQ(picture.bytes[17], 255);
        EXPECT_EQ(compare_images(reference, image, 0).not_finite, 1u);
    }
}

TEST(Metrics, ErrorPictureRisesFromBlackToWhite) {
    const std::vector<float> errors{0, 1e-4f, 1e-3f, 3e-3f, 1e-2f, 3e-2f, 1e-1f, 0.3f, 1, 50};
    const ImageBytes picture = error_picture(errors, 10, 1);
    ASSERT_EQ(picture.bytes.size(), 30u);
    const auto brightness = [&](std::size_t i) {
        return picture.bytes[3 * i] + 2 * picture.bytes[3 * i + 1] + picture.bytes[3 * i + 2] / 2;
    };
    EXPECT_EQ(brightness(0), 0);
    EXPECT_EQ(brightness(2), 0);
    for (std::size_t i = 3; i < 9; ++i) EXPECT_GT(brightness(i), brightness(i - 1)) << i;
    EXPECT_EQ(picture.bytes[24], 255);
    EXPECT_EQ(picture.bytes[25], 255);
    EXPECT_EQ(picture.bytes[29], 255);
}

MeasuredImage noisy(ImageRgba& storage, float mean, float sd, uint32_t seed, float factor = 1) {
    std::mt19937 random(seed);
    std::normal_distribution<float> noise(mean, sd);
    storage = constant_image(128, 64, Rgb(0));
    for (Rgb& c : storage.rgb) c = factor * Rgb(noise(random), noise(random), noise(random));
    MeasuredImage image;
    image.image = &storage;
    image.variance.assign(storage.rgb.size(), Rgb(factor * factor * sd * sd));
    return image;
}

TEST(BlockTest, EqualMeansAreRarelyRejected) {
    int rejected = 0;
    for (uint32_t seed = 0; seed < 200; ++seed) {
        ImageRgba a, b;
        const BlockTest t =
            test_blocks(noisy(a, 1, 0.3f, 2 * seed), noisy(b, 1, 0.2f, 2 * seed + 1), 32, 0.05);
        EXPECT_EQ(t.tests, 8u * 3);
        rejected += t.rejected > 0;
        EXPECT_EQ(t.rejected > 0, t.p_value < 0.05);
    }
    // Family-wise 5 %: 10 of 200 expected, 4 standard deviations are 12.
    EXPECT_LE(rejected, 22);
    EXPECT_GE(rejected, 1);
}

TEST(BlockTest, PlantedBiasIsFoundWhereItIs) {
    ImageRgba a, b;
    const MeasuredImage left = noisy(a, 1, 0.3f, 7);
    const MeasuredImage right = noisy(b, 1, 0.3f, 8);
    // 6 % in one block: 0.06 / (0.3 sqrt(2 / 1024)) = 4.5 standard deviations.
    for (uint32_t y = 32; y < 64; ++y) {
        for (uint32_t x = 64; x < 96; ++x) b.rgb[y * 128 + x] += Rgb(0.06f);
    }
    const BlockTest t = test_blocks(left, right);
    EXPECT_GE(t.rejected, 1u);
    EXPECT_EQ(t.x, 64u);
    EXPECT_EQ(t.y, 32u);
    EXPECT_LT(t.p_value, 0.01);
    EXPECT_GT(t.max_z, 3);
}

// Light that 1 of 500 samples finds, 16 in the image: a side that has found little also looks sure
// of it. With the variances as measured, 1.6 % of the images are rejected.
TEST(BlockTest, RareLightIsNoBias) {
    constexpr int kSamples = 32, kOdds = 500, kRuns = 2000;
    const ImageRgba exact = constant_image(16, 16, Rgb(1));
    const std::vector<Rgb> known(exact.rgb.size(), Rgb(1e-6f));
    std::mt19937 random(17);
    std::binomial_distribution<int> hits(kSamples, 1.0 / kOdds);
    int rejected = 0;
    for (int run = 0; run < kRuns; ++run) {
        ImageRgba found = exact;
        std::vector<Rgb> variance;
        for (Rgb& pixel : found.rgb) {
            const float mean = static_cast<float>(hits(random) * kOdds) / kSamples;
            pixel = Rgb(mean);
            variance.emplace_back(mean * (kOdds - mean) / (kSamples - 1));
        }
        rejected += test_blocks({&exact, known}, {&found, variance}).p_value < 0.01;
    }
    std::printf("rejected %d of %d\n", rejected, kRuns);
    EXPECT_LE(rejected, 0.01 * kRuns);
}

TEST(BlockTest, WithoutVarianceOnlyEqualIsEqual) {
    ImageRgba a = constant_image(8, 8, Rgb(1)), b = a;
    MeasuredImage left{&a, std::vector<Rgb>(64, Rgb(0))}, right{&b, std::vector<Rgb>(64, Rgb(0))};
    EXPECT_EQ(test_blocks(left, right).p_value, 1);
    b.rgb[0].x = 1.5f;
    EXPECT_EQ(test_blocks(left, right).p_value, 0);
    EXPECT_EQ(test_blocks(left, right).rejected, 1u);
}

}  // namespace
}  // namespace talbot
