// All sums run in double and in the order of pixels.
#include "core/accuracy/metrics.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "core/accuracy/error_estimate.h"
#include "core/accuracy/octave_statistics.h"
#include "core/base/check.h"
#include "core/math/robust.h"

namespace talbot {

namespace {

constexpr double kTrimmedShare = 0.001;
constexpr double kInfiniteError = std::numeric_limits<double>::infinity();

struct PixelError {
    double weighted = 0;  // sum over channels of (x - r)^2 / (r^2 + constant)
    double square = 0;
    double absolute = 0;
    bool finite = true;
};

PixelError pixel_error(const Rgb& image, const Rgb& reference, double constant) {
    PixelError error;
    if (!is_finite(image) || !is_finite(reference)) {
        return {kInfiniteError, kInfiniteError, kInfiniteError, false};
    }
    for (int c = 0; c < 3; ++c) {
        const double r = static_cast<double>(reference[c]);
        const double d = static_cast<double>(image[c]) - r;
        error.weighted += d * d / (r * r + constant);
        error.square += d * d;
        error.absolute += std::abs(d);
    }
    return error;
}

void check_sizes(const ImageRgba& image, const ImageRgba& reference) {
    TALBOT_CHECK(image.width == reference.width && image.height == reference.height);
    TALBOT_CHECK(!image.rgb.empty() && image.rgb.size() == reference.rgb.size());
}

double sum_of(const Rgb& c) {
    return static_cast<double>(c.x) + static_cast<double>(c.y) + static_cast<double>(c.z);
}

// Two-sided tail of the standard normal distribution.
double normal_tail(double z) {
    return std::erfc(std::abs(z) / std::sqrt(2.0));
}

}  // namespace

ImageErrors compare_images(const ImageRgba& image, const ImageRgba& reference, double exposure_ev) {
    check_sizes(image, reference);
    ImageErrors errors;
    const double constant = metric_constant(exposure_ev);
    const double exposure = std::exp2(exposure_ev);
    const std::size_t pixels = image.rgb.size();
    const uint32_t columns = (image.width + kErrorBlock - 1) / kErrorBlock;
    const uint32_t rows = (image.height + kErrorBlock - 1) / kErrorBlock;
    std::vector<double> weighted(pixels), blocks(std::size_t{columns} * rows);
    std::vector<uint32_t> block_pixels(blocks.size());
    double image_sum = 0, reference_sum = 0;
    for (std::size_t i = 0; i < pixels; ++i) {
        const PixelError e = pixel_error(image.rgb[i], reference.rgb[i], constant);
        weighted[i] = e.weighted;
        errors.relmse += e.weighted;
        errors.mse += e.square;
        errors.mae += e.absolute;
        errors.not_finite += e.finite ? 0 : 1;
        image_sum += sum_of(image.rgb[i]);
        reference_sum += sum_of(reference.rgb[i]);
        const std::size_t x = i % image.width, y = i / image.width;
        const std::size_t block = y / kErrorBlock * columns + x / kErrorBlock;
        blocks[block] += e.weighted;
        ++block_pixels[block];
    }
    const double n = 3 * static_cast<double>(pixels);
    errors.relmse /= n;
    errors.relrmse_percent = 100 * std::sqrt(errors.relmse);
    errors.mse *= exposure * exposure / n;
    errors.rmse = std::sqrt(errors.mse);
    errors.mae *= exposure / n;
    if (reference_sum != 0) errors.bias = (image_sum - reference_sum) / reference_sum;

    for (std::size_t b = 0; b < blocks.size(); ++b) {
        const double percent = 100 * std::sqrt(blocks[b] / (3.0 * block_pixels[b]));
        if (b != 0 && !(percent > errors.worst_block_percent)) continue;
        errors.worst_block_percent = percent;
        errors.worst_block_x = static_cast<uint32_t>(b % columns) * kErrorBlock;
        errors.worst_block_y = static_cast<uint32_t>(b / columns) * kErrorBlock;
    }
    const auto kept =
        pixels - static_cast<std::size_t>(kTrimmedShare * static_cast<double>(pixels));
    std::nth_element(weighted.begin(), weighted.begin() + static_cast<std::ptrdiff_t>(kept) - 1,
                     weighted.end());
    double trimmed = 0;
    for (std::size_t i = 0; i < kept; ++i) trimmed += weighted[i];
    errors.trimmed_percent = 100 * std::sqrt(trimmed / (3 * static_cast<double>(kept)));
    return errors;
}

std::vector<float> pixel_errors(const ImageRgba& image, const ImageRgba& reference,
                                double exposure_ev) {
    check_sizes(image, reference);
    const double constant = metric_constant(exposure_ev);
    std::vector<float> errors(image.rgb.size());
    for (std::size_t i = 0; i < errors.size(); ++i) {
        const double sum = pixel_error(image.rgb[i], reference.rgb[i], constant).weighted;
        errors[i] = static_cast<float>(std::sqrt(sum / 3));
    }
    return errors;
}

ImageBytes error_picture(const std::vector<float>& errors, uint32_t width, uint32_t height) {
    TALBOT_CHECK(errors.size() == std::size_t{width} * height);
    // One stop per half decade from 0.1 % to 100 %.
    constexpr uint8_t kStops[][3] = {{0, 0, 0},      {40, 12, 84},   {110, 25, 110}, {180, 50, 80},
                                     {230, 100, 30}, {250, 180, 40}, {255, 255, 255}};
    constexpr int kSpans = static_cast<int>(std::size(kStops)) - 1;
    constexpr float kDecades = 3;
    ImageBytes picture;
    picture.width = width;
    picture.height = height;
    picture.channels = 3;
    picture.bytes.reserve(errors.size() * 3);
    for (const float error : errors) {
        if (!is_finite(error)) {
            for (const int c : {255, 0, 255}) picture.bytes.push_back(static_cast<uint8_t>(c));
            continue;
        }
        const float place = error > 0 ? clamp01(1 + std::log10(error) / kDecades) : 0.0f;
        const int span = std::min(static_cast<int>(place * kSpans), kSpans - 1);
        const float t = place * kSpans - static_cast<float>(span);
        for (int c = 0; c < 3; ++c) {
            const float from = kStops[span][c], to = kStops[span + 1][c];
            picture.bytes.push_back(static_cast<uint8_t>(from + t * (to - from) + 0.5f));
        }
    }
    return picture;
}

namespace {

struct BlockSum {
    double value = 0;
    double variance = 0;
};

// Variance of the difference of two sums if both have one expectation. Where light is found by rare
// events, a sum that has met few of them is small and its measured variance too, in the same ratio;
// so the variance is brought to the expectation that both have in common.
double variance_if_equal(const BlockSum& a, const BlockSum& b) {
    const double both = a.variance + b.variance;
    if (!(both > 0)) return 0;
    const double common = (a.value * b.variance + b.value * a.variance) / both;
    const auto own = [&](const BlockSum& s) {
        return s.value > 0 ? s.variance * std::max(1.0, common / s.value) : s.variance;
    };
    return own(a) + own(b);
}

}  // namespace

BlockTest test_blocks(const MeasuredImage& a, const MeasuredImage& b, uint32_t block,
                      double level) {
    check_sizes(*a.image, *b.image);
    TALBOT_CHECK(block > 0 && a.variance.size() == a.image->rgb.size());
    TALBOT_CHECK(b.variance.size() == b.image->rgb.size());
    const uint32_t width = a.image->width, height = a.image->height;
    BlockTest result;
    std::vector<double> p_values;
    for (uint32_t y0 = 0; y0 < height; y0 += block) {
        for (uint32_t x0 = 0; x0 < width; x0 += block) {
            for (int c = 0; c < 3; ++c) {
                BlockSum sum_a, sum_b;
                for (uint32_t y = y0; y < std::min(y0 + block, height); ++y) {
                    for (uint32_t x = x0; x < std::min(x0 + block, width); ++x) {
                        const std::size_t i = std::size_t{y} * width + x;
                        sum_a.value += static_cast<double>(a.image->rgb[i][c]);
                        sum_a.variance += static_cast<double>(a.variance[i][c]);
                        sum_b.value += static_cast<double>(b.image->rgb[i][c]);
                        sum_b.variance += static_cast<double>(b.variance[i][c]);
                    }
                }
                const double difference = sum_a.value - sum_b.value;
                const double variance = variance_if_equal(sum_a, sum_b);
                if (difference == 0) {
                    p_values.push_back(1);
                    continue;
                }
                const double z = variance > 0 ? std::abs(difference) / std::sqrt(variance)
                                              : std::numeric_limits<double>::infinity();
                p_values.push_back(normal_tail(z));
                if (z > result.max_z) {
                    result.max_z = z;
                    result.x = x0;
                    result.y = y0;
                }
            }
        }
    }
    // Holm: the i-th smallest of n is held against level / (n - i).
    std::sort(p_values.begin(), p_values.end());
    result.tests = p_values.size();
    const double n = static_cast<double>(p_values.size());
    result.p_value = std::min(1.0, p_values.front() * n);
    while (result.rejected < result.tests &&
           p_values[result.rejected] * (n - static_cast<double>(result.rejected)) < level) {
        ++result.rejected;
    }
    return result;
}

}  // namespace talbot
