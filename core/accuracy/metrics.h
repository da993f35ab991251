// Errors of an image against a reference. The headline is relRMSE in per cent, 100 sqrt(relMSE),
// with relMSE the mean over pixels and channels of (x - r)^2 / (r^2 + 0.01) on scene-linear values
// after exposure; the others stand beside it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/film/image.h"

namespace talbot {

struct ImageErrors {
    double relmse = 0;
    double relrmse_percent = 0;
    double mse = 0;  // of exposed values
    double rmse = 0;
    double mae = 0;  // mean absolute difference
    double bias =
        0;  // mean of image minus mean of reference, over the latter's; 0 for a black reference
    double trimmed_percent = 0;      // relRMSE without the worst 0.1 % of pixels
    double worst_block_percent = 0;  // relRMSE of the worst 8x8 block
    uint32_t worst_block_x = 0;      // its top left pixel
    uint32_t worst_block_y = 0;
    uint64_t not_finite = 0;  // pixels of either image, which count as an infinite error
};

// Both images must have one size, at least 1x1. Not finite pixels make the figures infinite.
ImageErrors compare_images(const ImageRgba& image, const ImageRgba& reference, double exposure_ev);

// The metric of each pixel: sqrt of the mean over channels of (x - r)^2 / (r^2 + 0.01), as a share
// (1 = 100 %).
std::vector<float> pixel_errors(const ImageRgba& image, const ImageRgba& reference,
                                double exposure_ev);

// A picture of per-pixel or per-block errors: from black at 0.1 % over violet, orange and yellow to
// white at 100 %, in steps of equal ratio; magenta where not finite.
ImageBytes error_picture(const std::vector<float>& errors, uint32_t width, uint32_t height);

// An image with the variance of its pixels' means.
struct MeasuredImage {
    const ImageRgba* image = nullptr;
    std::vector<Rgb> variance;
};

struct BlockTest {
    double max_z = 0;  // the largest |difference| of block means, in its standard deviations
    uint32_t x = 0;    // that block's top left pixel
    uint32_t y = 0;
    double p_value =
        1;  // of the largest, corrected for the number of blocks and channels (Holm 1979)
    uint64_t tests = 0;
    uint64_t rejected = 0;  // at the given level
};

// Whether two images are renders of the same thing: a two-sided z-test of every block's mean in
// every channel. Blocks where neither image has variance count only when they differ (then z is
// infinite). Blocks need enough pixels for their means to be Gaussian.
BlockTest test_blocks(const MeasuredImage& a, const MeasuredImage& b, uint32_t block = 32,
                      double level = 0.01);

}  // namespace talbot
