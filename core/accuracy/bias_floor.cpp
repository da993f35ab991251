// The floor that a biased switch puts under the error: common random numbers on both sides, and the
// product of two independent halves, whose expectation is the squared bias without any noise.
#include "core/accuracy/bias_floor.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/accuracy/error_estimate.h"
#include "core/base/check.h"

namespace talbot {
namespace {

constexpr uint32_t kBlock = 16;  // pixels a side
constexpr double kSignificant = 3;

double mean_of(const FilmPixel& p, int c) {
    return p.samples == 0 ? 0 : p.sum[c].value() / static_cast<double>(p.samples);
}

// Mean of the samples that came after `half`.
double later_mean(const FilmPixel& now, const FilmPixel& half, int c) {
    const uint64_t n = now.samples - half.samples;
    return n == 0 ? 0 : (now.sum[c].value() - half.sum[c].value()) / static_cast<double>(n);
}

struct BlockSums {
    double product = 0;            // of the halves' differences, weighted
    double first = 0, second = 0;  // of the differences themselves
    double noise = 0;              // of their difference, squared
    double pixels = 0;
};

}  // namespace

BiasFloor measure_floor(const Film& half, const Film& now, const Film& base_half,
                        const Film& base_now, double exposure_ev) {
    BiasFloor floor;
    const double constant = metric_constant(exposure_ev);
    const uint32_t width = now.width(), height = now.height();
    const bool alike = half.width() == width && base_now.width() == width &&
                       base_half.width() == width && base_now.height() == height;
    TALBOT_CHECK(alike);
    if (half.min_samples() == 0) return floor;
    const uint32_t columns = (width + kBlock - 1) / kBlock, rows = (height + kBlock - 1) / kBlock;
    std::vector<BlockSums> blocks(static_cast<std::size_t>(columns) * rows);
    double change = 0, brightness = 0;
    for (uint32_t y = 0; y < height; ++y) {
        for (uint32_t x = 0; x < width; ++x) {
            BlockSums& block = blocks[static_cast<std::size_t>(y / kBlock) * columns + x / kBlock];
            block.pixels += 1;
            // Over the channels first, for they share their noise.
            double first = 0, second = 0;
            for (int c = 0; c < 3; ++c) {
                const double a = mean_of(half.pixel(x, y), c) - mean_of(base_half.pixel(x, y), c);
                const double b = later_mean(now.pixel(x, y), half.pixel(x, y), c) -
                                 later_mean(base_now.pixel(x, y), base_half.pixel(x, y), c);
                const double r = mean_of(base_now.pixel(x, y), c);
                block.product += a * b / (r * r + constant);
                first += a;
                second += b;
                change += mean_of(now.pixel(x, y), c) - r;
                brightness += r;
            }
            block.first += first;
            block.second += second;
            block.noise += (first - second) * (first - second);
        }
    }
    double sum = 0, square = 0, pixels = 0, largest = 0;
    std::size_t tests = 0;
    for (const BlockSums& b : blocks) {
        sum += b.product;
        square += b.product * b.product;
        pixels += b.pixels;
        // The block's mean difference over its standard deviation, which the halves show.
        if (b.noise > 0) {
            largest = std::max(largest, std::abs(b.first + b.second) / std::sqrt(b.noise));
            ++tests;
        } else if (b.first != 0 || b.second != 0) {
            largest = HUGE_VAL;
            ++tests;
        }
    }
    const double mean = sum / (3 * pixels);
    const double n = static_cast<double>(blocks.size());
    const double variance = std::max(0.0, square - sum * sum / n) * n / std::max(1.0, n - 1);
    const double sd = std::sqrt(variance) / (3 * pixels);
    floor.z = sd > 0 ? mean / sd : (mean > 0 ? HUGE_VAL : 0);
    floor.block_p_value =
        tests == 0
            ? 1.0
            : std::min(1.0, static_cast<double>(tests) * std::erfc(largest / std::sqrt(2.0)));
    floor.brightness_percent = brightness > 0 ? 100 * change / brightness : 0;
    constexpr double kLevel = 0.01;
    floor.significant = floor.z > kSignificant || (floor.block_p_value < kLevel && mean > 0);
    floor.relrmse_percent = floor.significant ? 100 * std::sqrt(mean) : 0;
    floor.lo95 = floor.significant ? 100 * std::sqrt(std::max(0.0, mean - 1.645 * sd)) : 0;
    floor.hi95 = 100 * std::sqrt(std::max(0.0, mean + 1.645 * sd));
    return floor;
}

}  // namespace talbot
