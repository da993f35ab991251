// Progressive images with known means: per pixel an integrand over pairs of dimensions, sampled
// independently or by scrambled Sobol' points. An oracle for the error estimate that shares no code
// with the renderer.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <vector>

#include "core/film/film.h"
#include "core/math/sample_bits.h"

namespace talbot::synthetic {

inline uint32_t mix(uint32_t x) {
    x ^= x >> 15;
    x *= 0x2C1B3C6Du;
    x ^= x >> 12;
    x *= 0x297A2D39u;
    return x ^ (x >> 15);
}
inline uint32_t mix(uint32_t a, uint32_t b) {
    return mix(a ^ (mix(b) + 0x9E3779B9u + (a << 6) + (a >> 2)));
}

// Nested uniform scrambling of a bit-reversed number: every bit is changed by the bits below it
// only (Laine, Karras 2011).
inline uint32_t scramble_reversed(uint32_t x, uint32_t seed) {
    x ^= x * 0x3D20ADEAu;
    x += seed;
    x *= (seed >> 16) | 1u;
    x ^= x * 0x05526C56u;
    x ^= x * 0x53A22864u;
    return x;
}

// Second dimension of Sobol's sequence.
inline uint32_t sobol1(uint32_t index) {
    uint32_t result = 0;
    for (uint32_t v = 1u << 31; index != 0; index >>= 1, v ^= v >> 1) {
        if (index & 1) result ^= v;
    }
    return result;
}

inline double unit(uint32_t bits) {
    return static_cast<double>(bits >> 8) * 0x1p-24;
}

struct Point2 {
    double u, v;
};

// Pair `pair` of dimensions of sample `index` of a pixel with key `key`.
inline Point2 sample_pair(bool sobol, uint32_t key, uint32_t index, uint32_t pair) {
    const uint32_t seed = mix(key, pair + 1);
    if (!sobol) return {unit(mix(mix(seed, index), 1)), unit(mix(mix(seed, index), 2))};
    // The order is shuffled inside blocks of 2^k, so that pairs are independent of each other.
    const uint32_t shuffled = reverse_bits(scramble_reversed(reverse_bits(index), mix(seed, 3)));
    return {unit(reverse_bits(scramble_reversed(shuffled, mix(seed, 4)))),
            unit(reverse_bits(scramble_reversed(reverse_bits(sobol1(shuffled)), mix(seed, 5))))};
}

// Area of cx + sy < t in the unit square, for c, s > 0.
inline double half_plane_area(double c, double s, double t) {
    const auto square = [](double z) { return z > 0 ? z * z : 0.0; };
    const double area =
        (square(t) - square(t - c) - square(t - s) + square(t - c - s)) / (2 * c * s);
    return std::clamp(area, 0.0, 1.0);
}

// A picture: samples and exact means by pixel position in 0..1.
struct Scene {
    const char* name;
    std::function<Rgb(double x, double y, const std::function<Point2(uint32_t)>& pair)> sample;
    std::function<Rgb(double x, double y)> mean;
};

// Smooth light, edges, a soft shadow, many-bounce products, a log-normal tail, and rows of all of
// these.
inline const std::vector<Scene>& scenes() {
    constexpr double kPi2 = 3.14159265358979323846;
    const auto albedo = [](double x, double y) {
        const double b = 0.05 + 0.9 * x * x;
        return Rgb(static_cast<float>(b), static_cast<float>(b * (0.4 + 0.6 * y)),
                   static_cast<float>(b * (0.9 - 0.5 * y)));
    };
    const auto scaled = [](const Rgb& a, double f) { return a * static_cast<float>(f); };
    using Pairs = std::function<Point2(uint32_t)>;
    const auto smooth = [=](const Point2& p) {
        return kPi2 * kPi2 / 4 * std::sin(kPi2 * p.u) * std::sin(kPi2 * p.v);
    };
    struct Edge {
        double c, s, t;
        double area() const { return half_plane_area(c, s, t); }
        double hit(const Point2& p) const { return c * p.u + s * p.v < t ? 1 : 0; }
    };
    const auto edge = [](double x, double y) {
        const double angle = 0.3 + x, c = std::cos(angle), s = std::sin(angle);
        return Edge{c, s, (0.2 + 0.9 * y) * (c + s)};
    };
    const auto bounce = [](double y, const Point2& p) {
        const double width = 0.5 + 0.4 * y;
        return p.v < width ? (0.5 + p.u) / width : 0.0;
    };
    const auto gi = [=](double y, const Pairs& pair) {
        return 0.2 + smooth(pair(0)) * bounce(y, pair(1)) * smooth(pair(2)) * bounce(y, pair(3));
    };
    const auto tail = [=](const Pairs& pair) {
        const Point2 p = pair(0);
        const double z =
            std::sqrt(-2 * std::log(std::max(1 - p.u, 0x1p-25))) * std::cos(2 * kPi2 * p.v);
        return std::exp(0.8 * z - 0.32);
    };
    const auto shadow = [=](double x, double y, const Pairs& pair) {
        return 0.1 + (0.5 + pair(0).u) * edge(x, y).hit(pair(1));
    };
    static const std::vector<Scene> kScenes{
        {"smooth",
         [=](double x, double y, const Pairs& pair) {
             return scaled(albedo(x, y), smooth(pair(0)));
         },
         [=](double x, double y) { return albedo(x, y); }},
        {"edges",
         [=](double x, double y, const Pairs& pair) {
             return scaled(albedo(x, y), 0.3 + edge(x, y).hit(pair(0)));
         },
         [=](double x, double y) { return scaled(albedo(x, y), 0.3 + edge(x, y).area()); }},
        {"shadow",
         [=](double x, double y, const Pairs& pair) {
             return scaled(albedo(x, y), shadow(x, y, pair));
         },
         [=](double x, double y) { return scaled(albedo(x, y), 0.1 + edge(x, y).area()); }},
        {"gi",
         [=](double x, double y, const Pairs& pair) { return scaled(albedo(x, y), gi(y, pair)); },
         [=](double x, double y) { return scaled(albedo(x, y), 1.2); }},
        {"tail",
         [=](double x, double y, const Pairs& pair) { return scaled(albedo(x, y), tail(pair)); },
         [=](double x, double y) { return albedo(x, y); }},
        {"mixed",
         [=](double x, double y, const Pairs& pair) {
             const int part = static_cast<int>(5 * y);
             const double f = part == 0   ? smooth(pair(0))
                              : part == 1 ? 0.3 + edge(x, y).hit(pair(0))
                              : part == 2 ? shadow(x, y, pair)
                              : part == 3 ? gi(y, pair)
                                          : tail(pair);
             return scaled(albedo(x, y), f);
         },
         [=](double x, double y) {
             const int part = static_cast<int>(5 * y);
             const double f = part == 1   ? 0.3 + edge(x, y).area()
                              : part == 2 ? 0.1 + edge(x, y).area()
                              : part == 3 ? 1.2
                                          : 1.0;
             return scaled(albedo(x, y), f);
         }},
    };
    return kScenes;
}

struct Picture {
    const Scene* scene;
    uint32_t size;
    bool sobol;
    uint32_t seed;
    Film film;
    uint64_t samples = 0;

    Picture(const Scene& s, uint32_t n, bool with_sobol, uint32_t key)
        : scene(&s), size(n), sobol(with_sobol), seed(key), film(n, n) {}

    void render_until(uint64_t end) {
        NonFiniteCount counts;
        for (uint32_t y = 0; y < size; ++y) {
            for (uint32_t x = 0; x < size; ++x) {
                const uint32_t key = mix(mix(seed, x), y);
                for (uint64_t s = samples; s < end; ++s) {
                    const auto pair = [&](uint32_t p) {
                        return sample_pair(sobol, key, static_cast<uint32_t>(s), p);
                    };
                    film.add(x, y, scene->sample((x + 0.5) / size, (y + 0.5) / size, pair), true, s,
                             counts);
                }
            }
        }
        samples = end;
    }

    // The metric of the whole program, against the exact means.
    double true_relmse(double constant = 0.01) const {
        const ImageRgba image = film.image(false);
        double sum = 0;
        for (uint32_t y = 0; y < size; ++y) {
            for (uint32_t x = 0; x < size; ++x) {
                const Rgb mean = scene->mean((x + 0.5) / size, (y + 0.5) / size);
                for (int c = 0; c < 3; ++c) {
                    const double r = static_cast<double>(mean[c]);
                    const double e = static_cast<double>(image.rgb[y * size + x][c]) - r;
                    sum += e * e / (r * r + constant);
                }
            }
        }
        return sum / (3.0 * size * size);
    }
};

}  // namespace talbot::synthetic
