// The film: per pixel exact sums, 64-bit counts and coverage. Nothing is dropped silently:
// non-finite and negative samples enter as zero and are counted, with the first one's pixel and
// sample to replay.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "core/film/exact_sum.h"
#include "core/film/image.h"
#include "core/film/sample_log.h"
#include "core/math/vec.h"

namespace talbot {

struct NonFiniteCount {
    uint64_t nan = 0;
    uint64_t inf = 0;
    uint64_t negative = 0;
    uint64_t overflow = 0;  // finite, but too large for the film; clamped to its limit
    bool has_first = false;
    uint32_t first_x = 0;
    uint32_t first_y = 0;
    uint64_t first_sample = 0;

    uint64_t total() const { return nan + inf + negative + overflow; }
    // Adds other's counts; the first event is the one with the lower (sample, y, x), whatever the
    // order of merging.
    void merge(const NonFiniteCount& other);
};

struct FilmPixel {
    ExactSum sum[3];
    uint64_t samples = 0;
    uint64_t covered = 0;  // samples whose camera path met a surface before the environment

    // The largest of the three sums.
    double largest_sum() const {
        return std::max({sum[0].value(), sum[1].value(), sum[2].value()});
    }

    bool operator==(const FilmPixel&) const = default;
};

class Film {
  public:
    Film() = default;
    Film(uint32_t width, uint32_t height);

    uint32_t width() const { return width_; }
    uint32_t height() const { return height_; }
    FilmPixel& pixel(uint32_t x, uint32_t y) {
        return pixels_[static_cast<std::size_t>(y) * width_ + x];
    }
    const FilmPixel& pixel(uint32_t x, uint32_t y) const {
        return pixels_[static_cast<std::size_t>(y) * width_ + x];
    }
    const std::vector<FilmPixel>& pixels() const { return pixels_; }
    std::vector<FilmPixel>& pixels() { return pixels_; }

    // Adds one sample. Different pixels may be added to from different threads; counts go to the
    // caller's own record.
    void add(uint32_t x, uint32_t y, const Rgb& radiance, bool covered, uint64_t sample,
             NonFiniteCount& counts);
    // The same, and notes the sample in the log where it is not usable or stands out. A pixel's
    // samples come one by one.
    void add(uint32_t x, uint32_t y, const Rgb& radiance, bool covered, uint64_t sample,
             NonFiniteCount& counts, SampleLog& log);

    void clear();

    // Sums, counts and coverage of the other film, which must have the same size.
    void merge(const Film& other);

    uint64_t total_samples() const;
    // The smallest count of any pixel.
    uint64_t min_samples() const;

    // Means; pixels without a sample are black. With alpha, rgb is as accumulated (premultiplied).
    ImageRgba image(bool with_alpha) const;

    // SHA-256 in hex over size, sums, counts and coverage: equal for equal films on every machine
    // of one byte order.
    std::string hash() const;

  private:
    uint32_t width_ = 0;
    uint32_t height_ = 0;
    std::vector<FilmPixel> pixels_;
};

}  // namespace talbot
