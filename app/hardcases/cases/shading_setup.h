// What the cases of shading, volumes and lights share: the worst input with a line that repeats it,
// significance over the suite, and small renders.
#pragma once

#include <cmath>
#include <cstdio>
#include <string>

#include "app/hardcases/hard_case.h"
#include "core/base/worker_pool.h"
#include "core/math/robust.h"
#include "oracles/scene_builder.h"
#include "oracles/stats/distribution_tails.h"

namespace talbot::hardcases {

// A float that reads back to the same bits.
inline std::string exact(double x) {
    char text[40];
    std::snprintf(text, sizeof text, "%a", x);
    return text;
}
inline std::string exact(const Vec3f& v) {
    return "(" + exact(v.x) + " " + exact(v.y) + " " + exact(v.z) + ")";
}

// The largest of many errors. Values that are not finite are counted apart.
struct WorstError {
    double value = 0;
    uint64_t nonfinite = 0;
    std::string where;

    template <typename Describe>
    void add(double error, const Describe& describe) {
        if (!is_finite(error)) {
            if (nonfinite++ == 0 && where.empty()) where = describe();
            return;
        }
        if (error > value) {
            value = error;
            where = describe();
        }
    }
    void add(double error) {
        add(error, [] { return std::string(); });
    }
    // The error, or infinity where anything was not finite.
    double or_infinite() const {
        return nonfinite > 0 ? std::numeric_limits<double>::infinity() : value;
    }
};

inline double relative(double x, double reference) {
    return std::abs(x - reference) / std::abs(reference);
}
inline double relative(double x, long double reference) {
    return static_cast<double>(std::abs(static_cast<long double>(x) - reference) /
                               std::abs(reference));
}

// Significance of one test of the whole suite (Sidak), for a false-alarm rate of 1e-4 over all.
inline double significance() {
    constexpr int kTestsOfTheSuite = 1000;
    return stats::sidak(stats::kFalseAlarm, kTestsOfTheSuite);
}

// p of test(seed); where it is too small, the smallest of three fresh seeds.
template <typename Test>
double confirmed_p(uint64_t seed, const Test& test) {
    double p = test(seed);
    if (p > significance()) return p;
    p = 1;
    for (uint64_t fresh = 1; fresh <= 3; ++fresh)
        p = std::min(p, test(seed + 0x9E3779B97F4A7C15u * fresh));
    return p;
}

// Of the random numbers of this run; `stream` tells those of one case apart.
inline uint64_t case_seed(uint64_t stream) {
    return stream + run_settings().seed * 0x9E3779B97F4A7C15u;
}

// Relative squared error of an image, as everywhere in Talbot.
inline double relmse(const ImageRgba& image, const ImageRgba& reference) {
    double sum = 0;
    for (std::size_t i = 0; i < image.rgb.size(); ++i) {
        for (int c = 0; c < 3; ++c) {
            const double r = static_cast<double>(reference.rgb[i][c]);
            const double e = static_cast<double>(image.rgb[i][c]) - r;
            sum += e * e / (r * r + 0.01);
        }
    }
    return sum / (3.0 * static_cast<double>(image.rgb.size()));
}

inline ImageRgba blank_image(uint32_t width, uint32_t height) {
    ImageRgba image;
    image.width = width;
    image.height = height;
    image.rgb.assign(static_cast<std::size_t>(width) * height, Rgb(0));
    return image;
}

// Points of an even sequence in the unit square (Kronecker's, with the root of x^3 = x + 1).
inline Vec2f even_point(uint32_t i) {
    constexpr double kRoot = 1.3247179572447460;
    const auto part = [i](double step) {
        const double x = 0.5 + step * i;
        return std::min(static_cast<float>(x - std::floor(x)), kOneMinusEpsilon);
    };
    return {part(1 / kRoot), part(1 / (kRoot * kRoot))};
}

}  // namespace talbot::hardcases
