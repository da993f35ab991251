// K02: tone curves and transfer functions over every half-precision value.
#include <vector>

#include "app/hardcases/worst.h"
#include "core/film/tone_map.h"
#include "core/math/robust.h"

namespace talbot::hardcases::k02 {
namespace {

// The value of a half's 16 bits.
float half_value(uint32_t bits) {
    const float sign = (bits & 0x8000u) != 0 ? -1.0f : 1.0f;
    const uint32_t exponent = (bits >> 10) & 31;
    const auto mantissa = static_cast<float>(bits & 1023);
    if (exponent == 31)
        return mantissa != 0 ? std::numeric_limits<float>::quiet_NaN() : sign * kInfinity;
    if (exponent == 0) return sign * mantissa * 0x1p-24f;
    return sign * std::ldexp(1024 + mantissa, static_cast<int>(exponent) - 25);
}

// All finite halves in order.
std::vector<float> ascending() {
    std::vector<float> list;
    for (uint32_t bits = 0x7BFF; bits > 0; --bits) list.push_back(half_value(0x8000u | bits));
    for (uint32_t bits = 0; bits <= 0x7BFF; ++bits) list.push_back(half_value(bits));
    return list;
}

// The curve of Reinhard 2002 with a power for the display, unguarded.
float naive_curve(float x) {
    return std::pow(x / (1 + x), 1 / 2.2f);
}

struct Curve {
    double drops = 0;    // values that come out below the one before
    double outside = 0;  // values not in [0, 1]
};

template <typename F>
Curve examine(const std::vector<float>& list, F&& curve, const std::string& name, Worst& worst) {
    Curve c;
    float before = 0;
    for (const float x : list) {
        const float y = curve(x);
        const bool in_range = y >= 0 && y <= 1;
        c.outside += in_range ? 0 : 1;
        if (y < before) {
            ++c.drops;
            worst.add(static_cast<double>(before - y),
                      [&] { return name + " at " + std::to_string(x); });
        }
        before = in_range ? y : before;
    }
    return c;
}

// Codes of so many steps that decoding and encoding do not give back.
template <typename Decode>
double broken_codes(uint32_t most, Decode&& decode) {
    double broken = 0;
    for (uint32_t code = 0; code <= most; ++code) {
        const float encoded = static_cast<float>(code) / static_cast<float>(most);
        const float back = srgb_from_linear(decode(encoded)) * static_cast<float>(most);
        broken += std::lround(back) == static_cast<long>(code) ? 0 : 1;
    }
    return broken;
}

CaseResult run(Effort) {
    const std::vector<float> list = ascending();
    Worst naive_drop, drop;
    const Curve naive = examine(list, naive_curve, "naive", naive_drop);
    double outside = 0;
    double unpainted = 0;
    for (const ToneMapInfo& info : kToneMaps) {
        for (int channel = 0; channel < 3; ++channel) {
            const auto grey = [&](float x) {
                return apply_tone_map(info.tone_map, Rgb(x))[channel];
            };
            outside += examine(list, grey, std::string(info.name), drop).outside;
        }
        for (const float bad : {std::numeric_limits<float>::quiet_NaN(), kInfinity, -kInfinity}) {
            for (int channel = 0; channel < 3; ++channel) {
                Rgb c(0.5f);
                c[channel] = bad;
                unpainted += apply_tone_map(info.tone_map, c) == Rgb(1, 0, 1) ? 0 : 1;
            }
        }
    }
    CaseResult result;
    result.measures.push_back({"values outside [0, 1] of 63488 halves through 4 tone curves",
                               naive.outside, outside, 0, Gate::at_most, ""});
    result.measures.push_back({"largest drop of a curve between neighbouring halves", kNoControl,
                               drop.figure, 0, Gate::at_most, drop.where});
    result.measures.push_back({"values that are not finite and not painted", kNoControl, unpainted,
                               0, Gate::at_most, ""});
    const auto power = [](float x) { return std::pow(x, 2.2f); };
    const double naive_codes = broken_codes(255, power) + broken_codes(65535, power);
    const double own_codes =
        broken_codes(255, linear_from_srgb) + broken_codes(65535, linear_from_srgb);
    result.measures.push_back({"sRGB codes of 8 and 16 bits that do not come back", naive_codes,
                               own_codes, 0, Gate::at_most, ""});
    return result;
}

const bool kAdded = add_case(
    {"K02", Priority::p1, "tone curves and transfer functions", "x / (1 + x) and a power of 2.2",
     "curves cut at both ends, sRGB by its two pieces", "Tom94/tev#166", run});

}  // namespace
}  // namespace talbot::hardcases::k02
