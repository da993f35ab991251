// E02: the spread of nearly equal numbers. The sum of squares minus the square of the sum cancels.
#include <vector>

#include "app/hardcases/worst.h"
#include "core/accuracy/octave_statistics.h"
#include "core/film/film.h"

namespace talbot::hardcases::e02 {
namespace {

constexpr uint32_t kSide = 32;
constexpr uint64_t kHalf = 16;  // samples of the first image; the second has twice as many

struct Spread {
    double naive = 0;  // mean over pixels of the variance by sums in float
    double own = 0;    // mean squared difference of the two images as the error estimate sees it
    double exact = 0;  // the same in long double
    double exact_variance = 0;
    bool negative = false;
};

// Samples of mean 2^power and a relative standard deviation, as floats.
Spread spread(Draw& draw, double mean, double deviation, double constant) {
    Film film(kSide, kSide);
    NonFiniteCount counts;
    OctaveMemory memory{std::vector<Vec3d>(film.pixels().size()), {}};
    Spread s;
    long double difference = 0;
    long double variance = 0;
    std::vector<std::vector<float>> samples(film.pixels().size());
    for (std::vector<float>& list : samples) {
        for (uint64_t i = 0; i < 2 * kHalf; ++i) {
            // Uniform with unit variance.
            const double u = std::sqrt(12.0) * (draw.unit() - 0.5);
            list.push_back(static_cast<float>(mean * (1 + deviation * u)));
        }
    }
    const auto add = [&](uint64_t begin, uint64_t end) {
        for (uint32_t y = 0; y < kSide; ++y) {
            for (uint32_t x = 0; x < kSide; ++x) {
                for (uint64_t i = begin; i < end; ++i)
                    film.add(x, y, Rgb(samples[y * kSide + x][i]), true, i, counts);
            }
        }
    };
    add(0, kHalf);
    compare_octave(film, memory, constant);
    add(kHalf, 2 * kHalf);
    const OctaveStatistics statistics = compare_octave(film, memory, constant);
    for (const std::vector<float>& list : samples) {
        long double half = 0, all = 0, square = 0;
        float sum = 0, squares = 0;
        for (uint64_t i = 0; i < list.size(); ++i) {
            all += static_cast<long double>(list[i]);
            if (i < kHalf) half = all;
            sum += list[i];
            squares += list[i] * list[i];
        }
        const auto n = static_cast<float>(list.size());
        for (const float x : list) {
            const long double d = static_cast<long double>(x) - all / (2 * kHalf);
            square += d * d;
        }
        const float naive = squares / n - (sum / n) * (sum / n);
        s.negative = s.negative || naive < 0;
        s.naive += static_cast<double>(naive);
        variance += square / (2 * kHalf);
        const long double d = all / (2 * kHalf) - half / kHalf;
        difference += d * d;
    }
    const auto pixels = static_cast<long double>(samples.size());
    // A metric constant far above the image weighs every pixel alike.
    s.own = statistics.difference * constant;
    s.exact = static_cast<double>(difference / pixels);
    s.exact_variance = static_cast<double>(variance);
    return s;
}

CaseResult run(Effort effort) {
    Draw draw(0xE02);
    const int repeats = effort == Effort::full ? 16 : 2;
    Worst naive, own;
    uint64_t naive_negative = 0;
    uint64_t own_negative = 0;
    Sweep sweep{"relative standard deviation", "relative error of the spread", true, 1e-6, {}};
    for (int exponent = -1; exponent >= -6; --exponent) {
        const double deviation = std::pow(10.0, exponent);
        SweepPoint point{deviation, 0, 0};
        for (int repeat = 0; repeat < repeats; ++repeat) {
            const double mean = draw.log_between(1, 1e6);
            const Spread s = spread(draw, mean, deviation, 1e12 * mean * mean);
            const double e_naive = std::abs(s.naive / s.exact_variance - 1);
            const double e_own = std::abs(s.own / s.exact - 1);
            const auto where = [&] {
                return "mean " + std::to_string(mean) + ", relative deviation " +
                       std::to_string(deviation);
            };
            naive.add(e_naive, where);
            own.add(e_own, where);
            naive_negative += s.negative ? 1 : 0;
            own_negative += s.own < 0 ? 1 : 0;
            point.naive = std::max(point.naive, e_naive);
            point.own = std::max(point.own, e_own);
        }
        sweep.points.push_back(point);
    }
    const Spread constant = spread(draw, 0.1, 0, 1);
    CaseResult result;
    result.measures.push_back({"relative error of the spread, deviations 1e-1 to 1e-6",
                               naive.figure, own.figure, 1e-6, Gate::at_most, own.where});
    result.measures.push_back({"inputs with a negative spread", static_cast<double>(naive_negative),
                               static_cast<double>(own_negative), 0, Gate::at_most, ""});
    result.measures.push_back(
        {"spread of constant input", std::abs(constant.naive), constant.own, 0, Gate::at_most, ""});
    result.sweeps.push_back(sweep);
    return result;
}

const bool kAdded =
    add_case({"E02", Priority::p0, "spread of nearly equal samples", "sums of squares in float",
              "differences between images of exact sums at powers of two", "", run});

}  // namespace
}  // namespace talbot::hardcases::e02
