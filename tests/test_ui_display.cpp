// The display shader against core/film/tone_map.cpp on a grid of colours, offscreen; outline,
// checkerboard and fitting.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <memory>

#include "core/film/tone_map.h"
#include "core/math/ray.h"
#include "ui/display.h"

namespace talbot {
namespace {

constexpr uint32_t kGrid = 64;

// Colours over 30 stops, saturated and grey, with a few special ones.
std::shared_ptr<ImageRgba> make_grid(bool with_alpha) {
    auto image = std::make_shared<ImageRgba>();
    image->width = image->height = kGrid;
    for (uint32_t y = 0; y < kGrid; ++y) {
        for (uint32_t x = 0; x < kGrid; ++x) {
            const float level = std::exp2(-20.0f + 30.0f * static_cast<float>(x) / (kGrid - 1));
            const float angle = 6.2831853f * static_cast<float>(y) / (kGrid - 1);
            const float saturation = static_cast<float>(y % 4) / 3.0f;
            Rgb rgb;
            for (int c = 0; c < 3; ++c) {
                const float phase = angle + 2.0944f * static_cast<float>(c);
                rgb[c] = level * (1 - saturation * (0.5f + 0.5f * std::cos(phase)));
            }
            image->rgb.push_back(rgb);
            if (with_alpha) image->alpha.push_back(static_cast<float>(y) / (kGrid - 1));
        }
    }
    image->rgb[0] = Rgb(0);
    image->rgb[1] = Rgb(std::numeric_limits<float>::quiet_NaN(), 0, 0);
    image->rgb[2] = Rgb(0, std::numeric_limits<float>::infinity(), 0);
    image->rgb[3] = Rgb(1e38f);
    image->rgb[4] = Rgb(-1.0f, 0.5f, 0);
    return image;
}

class DisplayTest : public testing::TestWithParam<OffscreenKind> {
  protected:
    void SetUp() override {
        Result<std::unique_ptr<GlContext>> made =
            make_offscreen_context({kGrid, kGrid}, GetParam());
        if (!made) GTEST_SKIP() << "NO OPENGL CONTEXT, SHADER NOT TESTED: " << made.error().line();
        context = std::move(*made);
        display = std::make_unique<Display>(context->gl());
        const Status loaded = display->load();
        ASSERT_TRUE(loaded.ok()) << loaded.error().line();
    }

    ImageBytes draw(const PixelRect& rect, const DisplaySettings& settings,
                    const DisplayOverlay& overlay = {}) {
        context->bind_framebuffer();
        context->gl().ClearColor(0, 0, 0, 1);
        context->gl().Clear(GL_COLOR_BUFFER_BIT);
        display->draw(rect, context->size(), settings, overlay);
        context->present();
        return context->read_pixels();
    }

    std::unique_ptr<GlContext> context;
    std::unique_ptr<Display> display;
};

int largest_difference(const ImageBytes& a, const ImageBytes& b) {
    int worst = 0;
    for (std::size_t i = 0; i < a.bytes.size(); ++i) {
        worst = std::max(worst, std::abs(int{a.bytes[i]} - int{b.bytes[i]}));
    }
    return worst;
}

TEST_P(DisplayTest, ShaderIsTheTwinOfDevelop) {
    const std::shared_ptr<ImageRgba> image = make_grid(false);
    display->update(image, nullptr, 0, 0);
    for (const ToneMapInfo& info : kToneMaps) {
        for (const float ev : {-2.0f, 0.0f, 3.5f}) {
            for (const DisplayChannel channel :
                 {DisplayChannel::color, DisplayChannel::red, DisplayChannel::green,
                  DisplayChannel::blue, DisplayChannel::alpha, DisplayChannel::luminance}) {
                const DisplaySettings settings{ev, info.tone_map, channel};
                const ImageBytes shown = draw({0, 0, kGrid, kGrid}, settings);
                const ImageBytes expected = develop(*image, settings);
                ASSERT_EQ(shown.bytes.size(), expected.bytes.size());
                EXPECT_LE(largest_difference(shown, expected), 1)
                    << info.name << " at " << ev << " EV, channel " << static_cast<int>(channel);
            }
        }
    }
}

// The comparison notices a curve that is off by little: exposure wrong by a tenth of a stop.
TEST_P(DisplayTest, TwinComparisonNoticesATenthOfAStop) {
    const std::shared_ptr<ImageRgba> image = make_grid(false);
    display->update(image, nullptr, 0, 0);
    for (const ToneMapInfo& info : kToneMaps) {
        const ImageBytes shown = draw({0, 0, kGrid, kGrid}, {0.1f, info.tone_map});
        EXPECT_GT(largest_difference(shown, develop(*image, {0.0f, info.tone_map})), 1)
            << info.name;
    }
}

TEST_P(DisplayTest, TransparencyShowsTheCheckerboard) {
    const std::shared_ptr<ImageRgba> image = make_grid(true);
    for (std::size_t i = 0; i < image->rgb.size(); ++i) {
        image->rgb[i] = Rgb(0.5f * image->alpha[i]);
    }
    display->update(image, nullptr, 0, 0);
    const ImageBytes shown = draw({0, 0, kGrid, kGrid}, {0, ToneMap::linear});
    // Top row: nothing but two greys of the board; last row: opaque, sRGB of 0.5.
    EXPECT_NEAR(shown.bytes[0], 0.42 * 255, 27);
    EXPECT_NE(shown.bytes[0], shown.bytes[3 * 8]);
    EXPECT_NEAR(shown.bytes[3 * (kGrid * (kGrid - 1) + 5)], 188, 1);
}

TEST_P(DisplayTest, OutlineLiesAroundTheSelection) {
    auto image = std::make_shared<ImageRgba>();
    image->width = image->height = kGrid;
    image->rgb.assign(kGrid * kGrid, Rgb(0));
    auto ids = std::make_shared<std::vector<uint32_t>>(kGrid * kGrid, kNoId);
    for (uint32_t y = 20; y < 40; ++y) {
        for (uint32_t x = 10; x < 30; ++x) (*ids)[y * kGrid + x] = 7;
    }
    display->update(image, ids, kGrid, kGrid);
    DisplayOverlay overlay;
    overlay.selected_object = 7;
    const auto is_orange = [](const ImageBytes& shown, uint32_t x, uint32_t y) {
        return shown.bytes[3 * (y * kGrid + x)] > 200;
    };
    ImageBytes shown = draw({0, 0, kGrid, kGrid}, {0, ToneMap::linear}, overlay);
    EXPECT_TRUE(is_orange(shown, 20, 19));
    EXPECT_TRUE(is_orange(shown, 9, 30));
    EXPECT_TRUE(is_orange(shown, 20, 40));
    EXPECT_FALSE(is_orange(shown, 20, 30));
    EXPECT_FALSE(is_orange(shown, 20, 15));
    overlay.selected_object = 8;
    shown = draw({0, 0, kGrid, kGrid}, {0, ToneMap::linear}, overlay);
    EXPECT_FALSE(is_orange(shown, 20, 19));
    overlay.selected_object.reset();
    shown = draw({0, 0, kGrid, kGrid}, {0, ToneMap::linear}, overlay);
    EXPECT_FALSE(is_orange(shown, 20, 19));
}

TEST_P(DisplayTest, ImageStaysInItsRectangle) {
    auto image = std::make_shared<ImageRgba>();
    image->width = image->height = 4;
    image->rgb.assign(16, Rgb(1));
    display->update(image, nullptr, 0, 0);
    const ImageBytes shown = draw({8, 16, 20, 10}, {0, ToneMap::linear});
    for (int y = 0; y < static_cast<int>(kGrid); ++y) {
        for (int x = 0; x < static_cast<int>(kGrid); ++x) {
            const bool inside = x >= 8 && x < 28 && y >= 16 && y < 26;
            ASSERT_EQ(shown.bytes[static_cast<std::size_t>(3 * (y * static_cast<int>(kGrid) + x))],
                      inside ? 255 : 0)
                << x << ", " << y;
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Contexts, DisplayTest,
                         testing::Values(OffscreenKind::egl, OffscreenKind::osmesa),
                         [](const testing::TestParamInfo<OffscreenKind>& kind) {
                             return kind.param == OffscreenKind::egl ? "Egl" : "OsMesa";
                         });

TEST(FitImage, KeepsShapeAndCentres) {
    EXPECT_EQ(fit_image({100, 0, 400, 300}, 200, 100, false), (PixelRect{200, 100, 200, 100}));
    EXPECT_EQ(fit_image({100, 0, 400, 300}, 200, 100, true), (PixelRect{100, 50, 400, 200}));
    EXPECT_EQ(fit_image({0, 0, 100, 100}, 1000, 500, false), (PixelRect{0, 25, 100, 50}));
}

}  // namespace
}  // namespace talbot
