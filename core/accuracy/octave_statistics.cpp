// One streaming pass over film and half image. The image is cut into strips of whole blocks; inside
// a strip a ring of rows holds horizontal sums over 7 pixels, so that every 7x7 sum is seven
// additions of rows.
#include "core/accuracy/octave_statistics.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <functional>
#include <limits>

#include "core/accuracy/packed_difference.h"
#include "core/base/check.h"

namespace talbot {

namespace {

constexpr uint32_t kRadius = 3;  // of the 7x7 neighbourhood
constexpr uint32_t kWindow = 2 * kRadius + 1;
constexpr uint32_t kStripRows = 8 * kErrorBlock;
constexpr double kTopShare = 0.001;  // of the pixels

// Counts and sums by magnitude, eight classes to an octave: enough for the share of the largest.
struct MagnitudeHistogram {
    static constexpr uint32_t kShift = 20;  // keeps sign, exponent and three bits of a float
    std::array<uint64_t, 2048> count{};
    std::array<double, 2048> sum{};

    void add(float value) {
        const uint32_t i = std::bit_cast<uint32_t>(value) >> kShift;
        ++count[i];
        sum[i] += static_cast<double>(value);
    }
};

struct StripResult {
    double sum = 0;           // of the pixels' weighted squared differences
    double square_sum = 0;    // of their squares
    double previous_sum = 0;  // of the octave before, weighted with this one's r
    double active_sum = 0;    // of `sum`, in blocks that did not rest
    double luminance_change = 0;
    double active_luminance_square = 0;
    double luminance_square = 0;
    double luminance = 0;
    MagnitudeHistogram magnitudes;
};

// A row of the image, of its squares and of the squared differences to the half image, and their
// sums over 7 pixels.
struct WindowRow {
    std::vector<float> value[3], difference_square[3];
    std::vector<float> value_sum[3], square_sum[3], noise_sum[3];

    explicit WindowRow(uint32_t width) {
        for (int c = 0; c < 3; ++c) {
            for (auto* row :
                 {&value[c], &difference_square[c], &value_sum[c], &square_sum[c], &noise_sum[c]}) {
                row->assign(width, 0);
            }
        }
    }
};

// to[x] = sum of from[x - 3 .. x + 3] inside the row; `padded` is scratch of width + 6.
void sum_neighbours(const std::vector<float>& from, std::vector<float>& padded,
                    std::vector<float>& to) {
    const std::size_t width = from.size();
    std::copy(from.begin(), from.end(), padded.begin() + kRadius);
    const float* p = padded.data();
    for (std::size_t x = 0; x < width; ++x) {
        to[x] = ((p[x] + p[x + 6]) + (p[x + 1] + p[x + 5])) + ((p[x + 2] + p[x + 4]) + p[x + 3]);
    }
}

// Moments of the neighbours alone, without the pixel itself.
struct Neighbours {
    float mean = 0;
    float square = 0;
    float noise = 0;  // mean squared difference
};

// The square of what the pixel will converge to, for the denominator. Between the neighbours' mean
// and the own value, by how much of the spread is structure and not noise (Lee 1980). A pixel that
// stands out from its neighbours is structure as far as its own halves agree on it: so small lamps
// keep their brightness and a single bright sample does not. `earlier` is the squared difference
// of the octave before, which should be twice d2.
float value_square(float value, float d2, float earlier, const Neighbours& around) {
    const float spread = around.square - around.mean * around.mean;
    const float deviation = value - around.mean;
    const float own_noise = 0.5f * (d2 + 0.5f * earlier);
    // Twice, for a squared difference of one pixel is a variance with one degree of freedom.
    const float structure =
        std::max({0.0f, spread - around.noise, deviation * deviation - 2 * own_noise});
    const float sum = structure + std::max(around.noise, d2);
    const float weight = sum > 0 ? structure / sum : 0.0f;
    const float r = around.mean + weight * deviation;
    // The noise that comes with the own value makes its square too large by d2, of which half is
    // taken back: all of it would leave some pixels nothing.
    return std::max(r * r - 0.5f * weight * weight * d2, 0.25f * r * r);
}

// What a pass reads and writes. Without a film the last octave is seen again: `full` is its image,
// `packed` its differences, and nothing is written.
struct PassImages {
    uint32_t width = 0;
    uint32_t height = 0;
    const FilmPixel* film = nullptr;
    const Vec3d* half = nullptr;
    const uint32_t* previous = nullptr;  // null where there is none
    const SamplingPlan* plan = nullptr;  // null where no block rested
    Vec3d* full = nullptr;
    uint32_t* packed = nullptr;
};

Vec3d mean_of(const FilmPixel& pixel) {
    const double n = static_cast<double>(pixel.samples);
    return Vec3d(pixel.sum[0].value() / n, pixel.sum[1].value() / n, pixel.sum[2].value() / n);
}

class StripPass {
  public:
    StripPass(const PassImages& images, double constant)
        : images_(images),
          constant_(static_cast<float>(constant)),
          ring_(kWindow, WindowRow(images.width)),
          padded_(images.width + 2 * kRadius, 0.0f),
          square_(images.width) {
        for (int c = 0; c < 3; ++c) {
            value_[c].resize(images.width);
            variance_[c].resize(images.width);
            noise_[c].resize(images.width);
        }
        quotient_.resize(images.width);
        previous_quotient_.resize(images.width);
    }

    // Rows [begin, end); block sums go to `blocks`.
    StripResult run(uint32_t begin, uint32_t end, std::vector<float>& blocks) {
        StripResult result;
        const uint32_t height = images_.height;
        const uint32_t first = begin > kRadius ? begin - kRadius : 0;
        uint32_t loaded = first;
        for (uint32_t y = begin; y < end; ++y) {
            const uint32_t last = std::min(y + kRadius, height - 1);
            for (; loaded <= last; ++loaded) load(loaded, loaded >= begin && loaded < end);
            weigh(y, std::max(first, y > kRadius ? y - kRadius : 0), last);
            gather(y, result, blocks);
        }
        return result;
    }

  private:
    struct Change {
        Vec3d mean{0};
        Rgb difference{0};
    };
    bool rests(std::size_t i) const {
        if (images_.plan == nullptr) return false;
        const std::size_t x = i % images_.width, y = i / images_.width;
        const std::size_t columns = (images_.width + kErrorBlock - 1) / kErrorBlock;
        return images_.plan->rests(y / kErrorBlock * columns + x / kErrorBlock);
    }

    Change change_of(std::size_t i) const {
        if (images_.film == nullptr) return {images_.full[i], unpack_difference(images_.packed[i])};
        if (rests(i)) return {images_.half[i], unpack_difference(images_.previous[i])};
        const FilmPixel& p = images_.film[i];
        if (p.samples == 0) return {};
        const Vec3d mean = mean_of(p);
        return {mean, Rgb(mean - images_.half[i])};
    }

    void load(uint32_t y, bool keep) {
        WindowRow& row = ring_[y % kWindow];
        const uint32_t width = images_.width;
        const std::size_t start = static_cast<std::size_t>(y) * width;
        for (uint32_t x = 0; x < width; ++x) {
            const Change change = change_of(start + x);
            const Rgb mean(change.mean);
            const Rgb& difference = change.difference;
            if (keep && images_.film != nullptr) {
                images_.full[start + x] = change.mean;
                images_.packed[start + x] = pack_difference(difference);
            }
            for (int c = 0; c < 3; ++c) {
                row.value[c][x] = mean[c];
                row.difference_square[c][x] = difference[c] * difference[c];
            }
        }
        for (int c = 0; c < 3; ++c) {
            for (uint32_t x = 0; x < width; ++x) square_[x] = row.value[c][x] * row.value[c][x];
            sum_neighbours(row.value[c], padded_, row.value_sum[c]);
            sum_neighbours(square_, padded_, row.square_sum[c]);
            sum_neighbours(row.difference_square[c], padded_, row.noise_sum[c]);
        }
    }

    // quotient_[x] = sum over channels of d^2 / (r^2 + constant) for row y, and the same of the
    // octave before.
    void weigh(uint32_t y, uint32_t first, uint32_t last) {
        const uint32_t width = images_.width;
        std::fill(quotient_.begin(), quotient_.end(), 0.0f);
        std::fill(previous_quotient_.begin(), previous_quotient_.end(), 0.0f);
        const uint32_t* previous = images_.previous == nullptr
                                       ? nullptr
                                       : images_.previous + static_cast<std::size_t>(y) * width;
        for (int c = 0; c < 3; ++c) {
            std::fill(value_[c].begin(), value_[c].end(), 0.0f);
            std::fill(variance_[c].begin(), variance_[c].end(), 0.0f);
            std::fill(noise_[c].begin(), noise_[c].end(), 0.0f);
            for (uint32_t i = first; i <= last; ++i) {
                const WindowRow& row = ring_[i % kWindow];
                for (uint32_t x = 0; x < width; ++x) {
                    value_[c][x] += row.value_sum[c][x];
                    variance_[c][x] += row.square_sum[c][x];
                    noise_[c][x] += row.noise_sum[c][x];
                }
            }
            const WindowRow& own = ring_[y % kWindow];
            const float rows = static_cast<float>(last - first + 1);
            for (uint32_t x = 0; x < width; ++x) {
                const uint32_t columns =
                    std::min(x, kRadius) + std::min(width - 1 - x, kRadius) + 1;
                const float others = rows * static_cast<float>(columns) - 1;
                const float d2 = own.difference_square[c][x];
                const float p = previous != nullptr ? unpack_difference(previous[x])[c] : 0;
                Neighbours around;
                if (others > 0) {
                    around.mean = (value_[c][x] - own.value[c][x]) / others;
                    around.square = (variance_[c][x] - own.value[c][x] * own.value[c][x]) / others;
                    around.noise = std::max((noise_[c][x] - d2) / others, 0.0f);
                }
                const float earlier = previous != nullptr ? p * p : 2 * d2;
                const float r2 = others > 0 ? value_square(own.value[c][x], d2, earlier, around)
                                            : own.value[c][x] * own.value[c][x];
                const float weight = 1 / (r2 + constant_);
                quotient_[x] += d2 * weight;
                previous_quotient_[x] += p * p * weight;
            }
        }
    }

    void gather(uint32_t y, StripResult& result, std::vector<float>& blocks) {
        const uint32_t width = images_.width;
        const std::size_t columns = (width + kErrorBlock - 1) / kErrorBlock;
        const std::size_t start = static_cast<std::size_t>(y) * width;
        for (uint32_t x = 0; x < width; ++x) {
            // What is next to nothing beside a bright difference may overflow.
            const float q = std::min(quotient_[x], std::numeric_limits<float>::max());
            const double wide = static_cast<double>(q);
            result.sum += wide;
            result.previous_sum += static_cast<double>(previous_quotient_[x]);
            result.square_sum += wide * wide;
            result.magnitudes.add(q);
            blocks[y / kErrorBlock * columns + x / kErrorBlock] += q;
            if (images_.film == nullptr) continue;
            const bool resting = rests(start + x);
            const double change = static_cast<double>(
                luminance(resting ? unpack_difference(images_.packed[start + x])
                                  : Rgb(images_.full[start + x] - images_.half[start + x])));
            result.luminance_square += change * change;
            if (!resting) {
                result.active_sum += wide;
                result.luminance_change += change;
                result.active_luminance_square += change * change;
            }
            result.luminance += static_cast<double>(luminance(Rgb(images_.full[start + x])));
        }
    }

    const PassImages images_;
    float constant_;
    std::vector<WindowRow> ring_;
    std::vector<float> padded_, square_, quotient_, previous_quotient_;
    std::vector<float> value_[3], variance_[3], noise_[3];
};

// Share of the total that the largest kTopShare of `pixels` hold (at least one pixel).
double top_share(const MagnitudeHistogram& magnitudes, double total, std::size_t pixels) {
    if (!(total > 0)) return 0;
    double wanted = std::max(1.0, kTopShare * static_cast<double>(pixels));
    double sum = 0;
    for (std::size_t i = magnitudes.count.size(); i-- > 0 && wanted > 0;) {
        const double count = static_cast<double>(magnitudes.count[i]);
        if (count == 0) continue;
        const double taken = std::min(count, wanted);
        sum += magnitudes.sum[i] * taken / count;
        wanted -= taken;
    }
    return sum / total;
}

OctaveStatistics run_passes(const PassImages& images, double metric_constant, WorkerPool* pool) {
    OctaveStatistics statistics;
    const uint32_t width = images.width, height = images.height;
    const std::size_t pixels = static_cast<std::size_t>(width) * height;
    const std::size_t columns = (width + kErrorBlock - 1) / kErrorBlock;
    const std::size_t rows = (height + kErrorBlock - 1) / kErrorBlock;
    const uint32_t strips = (height + kStripRows - 1) / kStripRows;
    statistics.blocks.assign(columns * rows, 0);
    std::vector<StripResult> results(strips);
    const auto run = [&](uint64_t strip, unsigned) {
        const uint32_t begin = static_cast<uint32_t>(strip) * kStripRows;
        StripPass pass(images, metric_constant);
        results[strip] = pass.run(begin, std::min(begin + kStripRows, height), statistics.blocks);
    };
    if (pool != nullptr) {
        pool->parallel_for(strips, run);
    } else {
        for (uint32_t strip = 0; strip < strips; ++strip) run(strip, 0);
    }
    StripResult total;
    for (const StripResult& r : results) {
        total.sum += r.sum;
        total.previous_sum += r.previous_sum;
        total.square_sum += r.square_sum;
        total.active_sum += r.active_sum;
        total.luminance_change += r.luminance_change;
        total.active_luminance_square += r.active_luminance_square;
        total.luminance_square += r.luminance_square;
        total.luminance += r.luminance;
        for (std::size_t i = 0; i < r.magnitudes.count.size(); ++i) {
            total.magnitudes.count[i] += r.magnitudes.count[i];
            total.magnitudes.sum[i] += r.magnitudes.sum[i];
        }
    }

    const double n = 3 * static_cast<double>(pixels);
    statistics.difference = total.sum / n;
    statistics.previous_difference = total.previous_sum / n;
    // var q = E q^2 - (E q)^2 of each pixel; a Gaussian difference has E q^2 = 3 (E q)^2.
    constexpr double kVarianceOfSquare = 2.0 / 3;
    statistics.standard_error = std::sqrt(kVarianceOfSquare * total.square_sum) / n;
    statistics.top_share = top_share(total.magnitudes, total.sum, pixels);
    if (total.luminance_square > 0) {
        const double spread = std::sqrt(total.luminance_square);
        if (total.active_luminance_square > 0)
            statistics.energy_drift =
                total.luminance_change / std::sqrt(total.active_luminance_square);
        // A half differs from the whole by as much as the whole errs, or by more.
        if (total.luminance > 0) statistics.brightness_sd = spread / total.luminance;
    }
    if (images.plan != nullptr && total.sum > 0)
        statistics.active_share = total.active_sum / total.sum;
    statistics.tail_index = pareto_tail_index(statistics.blocks);
    for (std::size_t by = 0; by < rows; ++by) {
        for (std::size_t bx = 0; bx < columns; ++bx) {
            const std::size_t w = std::min<std::size_t>(kErrorBlock, width - bx * kErrorBlock);
            const std::size_t h = std::min<std::size_t>(kErrorBlock, height - by * kErrorBlock);
            statistics.blocks[by * columns + bx] /= static_cast<float>(3 * w * h);
        }
    }
    return statistics;
}

}  // namespace

std::vector<Vec3d> exact_image(const Film& film) {
    std::vector<Vec3d> image;
    image.reserve(film.pixels().size());
    for (const FilmPixel& pixel : film.pixels())
        image.push_back(pixel.samples == 0 ? Vec3d(0) : mean_of(pixel));
    return image;
}

OctaveStatistics compare_octave(const Film& film, OctaveMemory& memory, double metric_constant,
                                WorkerPool* pool, const SamplingPlan& plan) {
    const std::size_t pixels = film.pixels().size();
    TALBOT_CHECK(memory.image.size() == pixels);
    TALBOT_CHECK(memory.difference.empty() || memory.difference.size() == pixels);
    if (pixels == 0) return {};
    OctaveMemory now{std::vector<Vec3d>(pixels), std::vector<uint32_t>(pixels)};
    PassImages images;
    images.width = film.width();
    images.height = film.height();
    images.film = film.pixels().data();
    images.half = memory.image.data();
    images.previous = memory.difference.empty() ? nullptr : memory.difference.data();
    images.plan = plan.empty() || memory.difference.empty() ? nullptr : &plan;
    images.full = now.image.data();
    images.packed = now.difference.data();
    const OctaveStatistics statistics = run_passes(images, metric_constant, pool);
    memory = std::move(now);
    return statistics;
}

OctaveStatistics weigh_memory(OctaveMemory& memory, uint32_t width, double metric_constant,
                              WorkerPool* pool) {
    const std::size_t pixels = memory.image.size();
    if (pixels == 0 || memory.difference.empty()) return {};
    TALBOT_CHECK(width > 0 && pixels % width == 0 && memory.difference.size() == pixels);
    PassImages images;
    images.width = width;
    images.height = static_cast<uint32_t>(pixels / width);
    images.full = memory.image.data();
    images.packed = memory.difference.data();
    return run_passes(images, metric_constant, pool);
}

double pareto_tail_index(std::vector<float> values) {
    const double count = static_cast<double>(values.size());
    const std::size_t tail = static_cast<std::size_t>(std::min(0.2 * count, 3 * std::sqrt(count)));
    if (tail < 5) return 0;
    std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(tail),
                     values.end(), std::greater<>());
    const double threshold = static_cast<double>(values[tail]);
    std::vector<double> excess;
    for (std::size_t i = 0; i < tail; ++i) {
        const double e = static_cast<double>(values[i]) - threshold;
        if (e > 0) excess.push_back(e);
    }
    std::sort(excess.begin(), excess.end());
    const std::size_t n = excess.size();
    if (n < 5) return 0;

    // Posterior mean of b over a grid of profile likelihoods.
    const double quartile = excess[static_cast<std::size_t>(static_cast<double>(n) / 4 + 0.5) - 1];
    const std::size_t grid = 30 + static_cast<std::size_t>(std::sqrt(static_cast<double>(n)));
    const auto shape = [&](double b) {
        double sum = 0;
        for (double e : excess) sum += std::log1p(-b * e);
        return sum / static_cast<double>(n);
    };
    std::vector<double> b(grid), likelihood(grid);
    for (std::size_t j = 0; j < grid; ++j) {
        const double ratio = static_cast<double>(grid) / (static_cast<double>(j) + 0.5);
        b[j] = 1 / excess[n - 1] + (1 - std::sqrt(ratio)) / (3 * quartile);
        const double k = shape(b[j]);
        likelihood[j] = static_cast<double>(n) * (std::log(-b[j] / k) - k - 1);
    }
    double mean = 0, weights = 0;
    const double best = *std::max_element(likelihood.begin(), likelihood.end());
    for (std::size_t j = 0; j < grid; ++j) {
        const double weight = std::exp(likelihood[j] - best);
        mean += weight * b[j];
        weights += weight;
    }
    const double k = shape(mean / weights);
    constexpr double kPriorCount = 10, kPriorShape = 0.5;
    return (static_cast<double>(n) * k + kPriorCount * kPriorShape) /
           (static_cast<double>(n) + kPriorCount);
}

}  // namespace talbot
