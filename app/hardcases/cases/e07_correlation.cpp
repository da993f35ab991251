// E07: errors of neighbouring pixels, dimensions and seeds must not know of each other.
#include <algorithm>
#include <complex>
#include <numbers>
#include <vector>

#include "app/hardcases/worst.h"
#include "core/integrate/sampler.h"

namespace talbot::hardcases::e07 {
namespace {

constexpr uint32_t kSide = 32;

using Image = std::vector<double>;  // of errors, kSide x kSide

// One step of a linear congruential generator started at the pixel's number: what is wrong here is
// the start.
double naive_unit(uint64_t seed, uint32_t x, uint32_t y, uint64_t index) {
    const uint64_t start = seed + (uint64_t{y} * kSide + x) * 16 + index;
    const uint64_t state = start * 6364136223846793005ull + 1442695040888963407ull;
    return static_cast<double>(state >> 40) * 0x1p-24;
}

// Errors of estimating the mean of f(u, v) = u v (1/4) from a few samples.
Image errors(bool naive, uint64_t seed, uint32_t pair, uint64_t samples) {
    Image image(kSide * kSide);
    for (uint32_t y = 0; y < kSide; ++y) {
        for (uint32_t x = 0; x < kSide; ++x) {
            double sum = 0;
            for (uint64_t i = 0; i < samples; ++i) {
                if (naive) {
                    sum += naive_unit(seed, x, y, 2 * i) * naive_unit(seed, x, y, 2 * i + 1);
                } else {
                    const Vec2f p = Sampler(SamplerKind::sobol, seed, x, y, i).pair(pair);
                    sum += static_cast<double>(p.x) * static_cast<double>(p.y);
                }
            }
            image[y * kSide + x] = sum / static_cast<double>(samples) - 0.25;
        }
    }
    return image;
}

struct Moments {
    double sum_ab = 0, sum_a2 = 0, sum_b2 = 0, count = 0;

    void add(double a, double b) {
        sum_ab += a * b;
        sum_a2 += a * a;
        sum_b2 += b * b;
        ++count;
    }
    // Correlation in units of 1 / sqrt(n), its standard deviation for independent numbers.
    double deviation() const {
        return std::abs(sum_ab / std::sqrt(sum_a2 * sum_b2)) * std::sqrt(count);
    }
};

// Power of the wave with (fx, fy) periods.
double power(const Image& image, uint32_t fx, uint32_t fy) {
    std::complex<double> sum = 0;
    for (uint32_t y = 0; y < kSide; ++y) {
        for (uint32_t x = 0; x < kSide; ++x) {
            const double turn = static_cast<double>((fx * x + fy * y) % kSide) / kSide;
            sum += image[y * kSide + x] * std::polar(1.0, 2 * std::numbers::pi * turn);
        }
    }
    return std::norm(sum);
}

struct Figures {
    Worst correlation;     // in standard deviations
    double peak = 0;       // of the spectrum over its median
    double ratio_low = 1;  // variance of the image's mean over that of independent pixels
    double ratio_high = 1;
};

Figures look(bool naive, uint64_t repeats) {
    Figures f;
    Moments right, below, dimension, seed_change;
    std::vector<double> spectrum(kSide * (kSide / 2 + 1), 0.0);
    double mean_square = 0;
    double pixel_square = 0;
    const uint64_t base = run_settings().seed;
    constexpr uint64_t kSpectra = 24;
    for (uint64_t r = 0; r < repeats; ++r) {
        // Every second one counts down from the last seed that there is.
        const uint64_t seed = base + (r % 2 == 0 ? r : ~uint64_t{0} - r);
        const Image image = errors(naive, seed, 2, 2);
        const Image other_pair = errors(naive, seed, 3, 2);
        const Image other_seed = errors(naive, seed + 1, 2, 2);
        double mean = 0;
        for (uint32_t y = 0; y < kSide; ++y) {
            for (uint32_t x = 0; x < kSide; ++x) {
                const double e = image[y * kSide + x];
                if (x + 1 < kSide) right.add(e, image[y * kSide + x + 1]);
                if (y + 1 < kSide) below.add(e, image[(y + 1) * kSide + x]);
                if (!naive) dimension.add(e, other_pair[y * kSide + x]);
                seed_change.add(e, other_seed[y * kSide + x]);
                mean += e / (kSide * kSide);
                pixel_square += e * e;
            }
        }
        mean_square += mean * mean;
        if (r >= kSpectra) continue;
        for (uint32_t fy = 0; fy < kSide; ++fy) {
            for (uint32_t fx = 0; fx <= kSide / 2; ++fx)
                spectrum[fy * (kSide / 2 + 1) + fx] += power(image, fx, fy);
        }
    }
    const auto count = static_cast<double>(repeats);
    f.ratio_high = mean_square / count * (kSide * kSide) / (pixel_square / (count * kSide * kSide));
    f.ratio_low = f.ratio_high;
    f.correlation.add(right.deviation(), [] { return std::string("right neighbours"); });
    f.correlation.add(below.deviation(), [] { return std::string("lower neighbours"); });
    f.correlation.add(seed_change.deviation(), [] { return std::string("successive seeds"); });
    if (!naive)
        f.correlation.add(dimension.deviation(),
                          [] { return std::string("two pairs of one sample"); });
    const double largest = *std::max_element(spectrum.begin(), spectrum.end());
    const auto middle = spectrum.begin() + static_cast<std::ptrdiff_t>(spectrum.size() / 2);
    std::nth_element(spectrum.begin(), middle, spectrum.end());
    f.peak = largest / *middle;
    return f;
}

CaseResult run(Effort effort) {
    const uint64_t repeats = effort == Effort::full ? 8192 : 512;
    const Figures naive = look(true, repeats);
    const Figures own = look(false, repeats);
    CaseResult result;
    result.measures.push_back(
        {"correlation of errors of neighbours, pairs and seeds, in standard deviations",
         naive.correlation.figure, own.correlation.figure, 4, Gate::at_most,
         own.correlation.where});
    result.measures.push_back({"largest wave of the error image over the median", naive.peak,
                               own.peak, 6, Gate::at_most, ""});
    // Four standard deviations of a variance from so many seeds, where that is more than 0.1.
    const double slack = std::max(0.1, 4 * std::sqrt(2.0 / static_cast<double>(repeats)));
    result.measures.push_back({"variance of the image's mean over that of independent pixels",
                               naive.ratio_high, own.ratio_high, 1 + slack, Gate::at_most, ""});
    result.measures.push_back(
        {"the same from below", kNoControl, own.ratio_low, 1 - slack, Gate::at_least, ""});
    return result;
}

const bool kAdded = add_case({"E07", Priority::p1, "errors of neighbours do not know of each other",
                              "generator started at the pixel's number",
                              "scramble keyed by seed, pixel and dimension pair",
                              "three-gpu-pathtracer#530, mmp/pbrt-v3#236, imneme/pcg-cpp#90", run});

}  // namespace
}  // namespace talbot::hardcases::e07
