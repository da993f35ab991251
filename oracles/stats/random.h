// Reproducible uniform numbers for tests, independent of the renderer's samplers.
#pragma once

#include <cstdint>
#include <random>

#include "core/math/sample_bits.h"
#include "core/math/vec.h"

namespace talbot::stats {

class Random {
  public:
    explicit Random(uint64_t seed) : engine_(seed) {}

    float operator()() { return unit_float(static_cast<uint32_t>(engine_() >> 32)); }
    Vec2f pair() {
        const float x = (*this)();
        return Vec2f(x, (*this)());
    }
    double between(double low, double high) { return low + (high - low) * (*this)(); }

  private:
    std::mt19937_64 engine_;
};

}  // namespace talbot::stats
