// The worst figure over many inputs with the input that made it, and the random inputs themselves.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <string>

#include "app/hardcases/hard_case.h"

namespace talbot::hardcases {

// Largest figure seen; what is not a number counts as infinite.
struct Worst {
    double figure = 0;
    std::string where;

    // `where` is called only for a new worst.
    template <typename Where>
    void add(double x, Where&& describe) {
        if (std::isnan(x)) x = std::numeric_limits<double>::infinity();
        if (!(x > figure)) return;
        figure = x;
        where = describe();
    }
    void add(double x) {
        add(x, [] { return std::string(); });
    }
};

inline constexpr double kNoControl = std::numeric_limits<double>::quiet_NaN();

// Random numbers of one case: `stream` tells cases apart.
class Draw {
  public:
    explicit Draw(uint64_t stream)
        : engine_(run_settings().seed * 0x9E3779B97F4A7C15ull + stream) {}

    double unit() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }
    double between(double low, double high) { return low + (high - low) * unit(); }
    // Of a magnitude between low and high, both above 0, every decade as often.
    double log_between(double low, double high) { return low * std::pow(high / low, unit()); }
    uint64_t bits() { return engine_(); }

  private:
    std::mt19937_64 engine_;
};

}  // namespace talbot::hardcases
