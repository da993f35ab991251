#include "ui/inspector.h"

#include <algorithm>
#include <cmath>

namespace talbot {
namespace {

constexpr uint32_t kBlock = 8;  // pixels a side, as the error estimate has them

uint32_t index_at(double t, uint32_t size) {
    return std::min(static_cast<uint32_t>(t * size), size - 1);
}

std::optional<Rgb> value_at(const ImageRgba& image, double u, double v) {
    if (image.width == 0 || image.height == 0) return std::nullopt;
    const std::size_t row = index_at(v, image.height);
    return image.rgb[row * image.width + index_at(u, image.width)];
}

// The block's error as of the last octave, carried on to the samples of now.
std::optional<double> block_percent(const Snapshot& s, uint32_t x, uint32_t y) {
    if (!s.error.valid || s.error.samples == 0 || s.preview || !s.notes) return std::nullopt;
    const std::size_t columns = (s.full_width + kBlock - 1) / kBlock;
    const std::size_t block = (y / kBlock) * columns + x / kBlock;
    if (block >= s.notes->block_errors.size()) return std::nullopt;
    const uint64_t octave = std::bit_floor(std::max<uint64_t>(s.passes, 1));
    const double growth = static_cast<double>(s.passes) / static_cast<double>(octave);
    return static_cast<double>(s.notes->block_errors[block]) *
           std::pow(growth, -0.5 * s.error.exponent);
}

}  // namespace

std::optional<PixelReading> read_pixel(const Snapshot& snapshot, double u, double v) {
    if (!snapshot.image || !(u >= 0 && u < 1 && v >= 0 && v < 1)) return std::nullopt;
    const std::optional<Rgb> mean = value_at(*snapshot.image, u, v);
    if (!mean) return std::nullopt;
    PixelReading reading;
    reading.x = index_at(u, snapshot.full_width);
    reading.y = index_at(v, snapshot.full_height);
    reading.mean = *mean;
    reading.error_percent = block_percent(snapshot, reading.x, reading.y);
    if (reading.error_percent) {
        const double share = *reading.error_percent / 100;
        const double constant = metric_constant(0);
        Rgb error(0);
        for (int c = 0; c < 3; ++c) {
            const double value = static_cast<double>((*mean)[c]);
            error[c] = static_cast<float>(share * std::sqrt(value * value + constant));
        }
        reading.standard_error = error;
    }
    if (snapshot.aov) reading.value = value_at(snapshot.aov->image, u, v);
    return reading;
}

}  // namespace talbot
