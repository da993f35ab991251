// Tone mapping against properties that each curve is published with, and the develop step against
// hand-made pixels.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/film/tone_map.h"

namespace talbot {
namespace {

ImageRgba one_pixel(const Rgb& rgb) {
    ImageRgba image;
    image.width = image.height = 1;
    image.rgb = {rgb};
    return image;
}

TEST(ToneMap, NamesRoundTrip) {
    for (const ToneMapInfo& info : kToneMaps)
        EXPECT_EQ(tone_map_from_name(info.name), info.tone_map);
    EXPECT_FALSE(tone_map_from_name("filmic").has_value());
}

TEST(ToneMap, SrgbIsItsOwnInverseAndMeetsTheStandard) {
    for (int i = 0; i <= 255; ++i) {
        const float encoded = static_cast<float>(i) / 255.0f;
        EXPECT_NEAR(srgb_from_linear(linear_from_srgb(encoded)), encoded, 1e-6f);
    }
    // IEC 61966-2-1: linear 0.2140 is encoded 0.5.
    EXPECT_NEAR(linear_from_srgb(0.5f), 0.21404f, 1e-5f);
}

TEST(ToneMap, BlackStaysBlackAndEverythingStaysInRange) {
    for (const ToneMapInfo& info : kToneMaps) {
        const Rgb black = apply_tone_map(info.tone_map, Rgb(0));
        for (int c = 0; c < 3; ++c) EXPECT_LE(black[c], 0.5f / 255.0f / 12.92f) << info.name;
        for (float v = 1e-6f; v < 1e30f; v *= 3) {
            for (const Rgb& rgb : {Rgb(v), Rgb(v, 0, 0), Rgb(0, v, 0.5f * v)}) {
                const Rgb mapped = apply_tone_map(info.tone_map, rgb);
                for (int c = 0; c < 3; ++c) {
                    EXPECT_GE(mapped[c], 0) << info.name << " " << v;
                    EXPECT_LE(mapped[c], 1) << info.name << " " << v;
                }
            }
        }
    }
}

TEST(ToneMap, GreysStayGreyAndRise) {
    for (const ToneMapInfo& info : kToneMaps) {
        float last = -1;
        for (float v = 0.01f; v < 1000; v *= 1.1f) {
            const Rgb mapped = apply_tone_map(info.tone_map, Rgb(v));
            EXPECT_NEAR(mapped.x, mapped.y, 0.25f / 255) << info.name << " " << v;
            EXPECT_NEAR(mapped.x, mapped.z, 0.25f / 255) << info.name << " " << v;
            EXPECT_GE(mapped.y, last - 1e-6f) << info.name << " " << v;
            last = mapped.y;
        }
        EXPECT_GT(last, 0.9f) << info.name;
    }
}

// Khronos: between 0.08 and the start of compression the curve is the input less the Fresnel offset
// of 0.04.
TEST(ToneMap, NeutralKeepsBaseColours) {
    const Rgb mapped = apply_tone_map(ToneMap::neutral, Rgb(0.5f, 0.25f, 0.125f));
    EXPECT_NEAR(mapped.x, 0.46f, 1e-6f);
    EXPECT_NEAR(mapped.y, 0.21f, 1e-6f);
    EXPECT_NEAR(mapped.z, 0.085f, 1e-6f);
}

// AgX puts middle grey near display middle grey: 0.18 lands within 0.03 of 0.5 in encoded values.
TEST(ToneMap, AgxKeepsMiddleGrey) {
    const float encoded = srgb_from_linear(apply_tone_map(ToneMap::agx, Rgb(0.18f)).x);
    EXPECT_NEAR(encoded, 0.48f, 0.04f);
}

TEST(ToneMap, NonFiniteIsMagenta) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    for (const ToneMapInfo& info : kToneMaps) {
        EXPECT_EQ(apply_tone_map(info.tone_map, Rgb(nan, 0, 0)), Rgb(1, 0, 1));
        EXPECT_EQ(apply_tone_map(info.tone_map, Rgb(0, kInfinity, 0)), Rgb(1, 0, 1));
    }
}

TEST(ToneMap, DevelopExposesAndEncodes) {
    DisplaySettings display;
    display.tone_map = ToneMap::linear;
    display.exposure_ev = 1;
    const ImageBytes bytes = develop(one_pixel(Rgb(0.25f, 0.5f, 0)), display);
    ASSERT_EQ(bytes.channels, 3u);
    EXPECT_EQ(bytes.bytes[0], 188);  // sRGB of 0.5
    EXPECT_EQ(bytes.bytes[1], 255);
    EXPECT_EQ(bytes.bytes[2], 0);
}

TEST(ToneMap, DevelopGivesStraightAlpha) {
    ImageRgba image = one_pixel(Rgb(0.25f));
    image.alpha = {0.5f};
    DisplaySettings display;
    display.tone_map = ToneMap::linear;
    ImageBytes bytes = develop(image, display);
    ASSERT_EQ(bytes.channels, 4u);
    EXPECT_EQ(bytes.bytes[0], 188);
    EXPECT_EQ(bytes.bytes[3], 128);

    display.channel = DisplayChannel::alpha;
    bytes = develop(image, display);
    ASSERT_EQ(bytes.channels, 3u);
    EXPECT_EQ(bytes.bytes[0], 128);

    image.alpha = {0.0f};
    image.rgb = {Rgb(0)};
    display.channel = DisplayChannel::color;
    bytes = develop(image, display);
    EXPECT_EQ(bytes.bytes[3], 0);
}

TEST(ToneMap, DevelopShowsChannels) {
    DisplaySettings display;
    display.tone_map = ToneMap::linear;
    display.channel = DisplayChannel::green;
    const ImageBytes bytes = develop(one_pixel(Rgb(1, 0.5f, 0)), display);
    EXPECT_EQ(bytes.bytes[0], 188);
    EXPECT_EQ(bytes.bytes[2], 188);
}

// The bytes of the linear curve against the sRGB formula in double, over all magnitudes.
TEST(Develop, BytesAreTheFormulasRounded) {
    DisplaySettings display;
    display.tone_map = ToneMap::linear;
    for (int i = 0; i <= 60000; ++i) {
        const float x = static_cast<float>(std::exp2(-16.0 * (1 - i / 60000.0)));
        const double linear = static_cast<double>(x);
        const double srgb =
            linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
        const double wanted = 255 * srgb;
        if (std::abs(wanted - std::floor(wanted) - 0.5) < 1e-3) continue;  // either neighbour
        ASSERT_EQ(develop(one_pixel(Rgb(x)), display).bytes[0], std::lround(wanted)) << x;
    }
}

}  // namespace
}  // namespace talbot
