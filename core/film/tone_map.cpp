// Tone curves, each with its published constants. shaders/display.frag repeats this file line by
// line; tests compare the two.
//   ACES    Hill 2017, fit of RRT and ODT, as in "BakingLab"
//   AgX     Sobotka 2022, base look; curve fitted by Wrensch 2023
//   Neutral Khronos PBR Neutral tone mapper, specification of 2024
#include "core/film/tone_map.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "core/math/robust.h"

namespace talbot {
namespace {

// Exposed values are cut here: far above every curve's white, far below where their squares
// overflow.
constexpr float kLargestExposed = 1048576.0f;

Rgb tone_map_aces(const Rgb& c) {
    const Rgb v(0.59719f * c.x + 0.35458f * c.y + 0.04823f * c.z,
                0.07600f * c.x + 0.90834f * c.y + 0.01566f * c.z,
                0.02840f * c.x + 0.13383f * c.y + 0.83777f * c.z);
    const Rgb a = v * (v + 0.0245786f) - 0.000090537f;
    const Rgb b = v * (0.983729f * v + 0.4329510f) + 0.238081f;
    const Rgb f = a / b;
    return Rgb(1.60475f * f.x - 0.53108f * f.y - 0.07367f * f.z,
               -0.10208f * f.x + 1.10813f * f.y - 0.00605f * f.z,
               -0.00327f * f.x - 0.07276f * f.y + 1.07602f * f.z);
}

// Input in 0..1 of the log2 range, output display-encoded.
float agx_contrast(float x) {
    const float x2 = x * x;
    const float x4 = x2 * x2;
    return 15.5f * x4 * x2 - 40.14f * x4 * x + 31.96f * x4 - 6.868f * x2 * x + 0.4298f * x2 +
           0.1191f * x - 0.00232f;
}

Rgb tone_map_agx(const Rgb& c) {
    constexpr float kMinEv = -12.47393f;
    constexpr float kMaxEv = 4.026069f;
    const Rgb inset(0.842479062f * c.x + 0.0784336f * c.y + 0.0792237451f * c.z,
                    0.0423282423f * c.x + 0.878468636f * c.y + 0.0791661275f * c.z,
                    0.0423756549f * c.x + 0.0784336f * c.y + 0.879142974f * c.z);
    Rgb v;
    for (int i = 0; i < 3; ++i) {
        // The lower end of the range in linear light is 2^kMinEv.
        const float ev = std::log2(std::max(inset[i], std::exp2(kMinEv)));
        v[i] = agx_contrast(clamp01((ev - kMinEv) / (kMaxEv - kMinEv)));
    }
    const Rgb outset(1.196879005f * v.x - 0.0980208811f * v.y - 0.0990297441f * v.z,
                     -0.0528968518f * v.x + 1.15190313f * v.y - 0.0989611768f * v.z,
                     -0.0529716355f * v.x - 0.0980434501f * v.y + 1.151073673f * v.z);
    // The curve's output is meant for a 2.2 display; back to linear light, which the caller encodes
    // as sRGB.
    return Rgb(std::pow(clamp01(outset.x), 2.2f), std::pow(clamp01(outset.y), 2.2f),
               std::pow(clamp01(outset.z), 2.2f));
}

Rgb tone_map_neutral(const Rgb& c) {
    constexpr float kStartCompression = 0.8f - 0.04f;
    constexpr float kDesaturation = 0.15f;
    const float x = min_component(c);
    const float offset = x < 0.08f ? x - 6.25f * x * x : 0.04f;
    const Rgb v = c - offset;
    const float peak = max_component(v);
    if (peak < kStartCompression) return v;
    const float d = 1 - kStartCompression;
    const float new_peak = 1 - d * d / (peak + d - kStartCompression);
    const Rgb compressed = v * (new_peak / peak);
    const float g = 1 - 1 / (kDesaturation * (peak - new_peak) + 1);
    return compressed + g * (Rgb(new_peak) - compressed);
}

uint8_t to_byte(float value) {
    return static_cast<uint8_t>(std::lround(255.0f * clamp01(value)));
}

// to_byte(srgb_from_linear(x)) for x in [0, 1] without a power: by the values at which it steps,
// found by bisection over all floats, and a table over the leading bits of x that says how many
// steps lie below. Between two entries there is one step at most: entries are 2^-8 apart in
// relation to x, steps 2.2 / 255.
class SrgbSteps {
  public:
    SrgbSteps() {
        for (uint32_t byte = 1; byte < 256; ++byte) {
            uint32_t below = 0;
            uint32_t above = std::bit_cast<uint32_t>(1.0f);
            while (above - below > 1) {
                const uint32_t middle = below + (above - below) / 2;
                const bool reached =
                    to_byte(srgb_from_linear(std::bit_cast<float>(middle))) >= byte;
                (reached ? above : below) = middle;
            }
            next_[byte - 1] = std::bit_cast<float>(above);
        }
        next_[255] = kInfinity;
        for (uint32_t i = 0; i < kEntries; ++i) {
            const float lowest = std::bit_cast<float>(kFirstBits + (i << kShift));
            byte_[i] = static_cast<uint8_t>(std::upper_bound(next_.begin(), next_.end(), lowest) -
                                            next_.begin());
        }
    }
    uint8_t operator()(float linear) const {
        if (linear < kFirst) return 0;
        const uint8_t byte = byte_[(std::bit_cast<uint32_t>(linear) - kFirstBits) >> kShift];
        return static_cast<uint8_t>(byte + (linear >= next_[byte] ? 1 : 0));
    }

  private:
    static constexpr float kFirst = 0x1p-13f;  // below it all is 0
    static constexpr uint32_t kFirstBits = std::bit_cast<uint32_t>(kFirst);
    static constexpr uint32_t kShift = 15;
    static constexpr uint32_t kEntries =
        ((std::bit_cast<uint32_t>(1.0f) - kFirstBits) >> kShift) + 1;
    std::array<float, 256> next_{};  // where each byte ends
    std::array<uint8_t, kEntries> byte_{};
};

// The exposed value that the chosen channel shows, before the tone curve.
Rgb select_channel(DisplayChannel channel, const Rgb& exposed) {
    switch (channel) {
        case DisplayChannel::red:
            return Rgb(exposed.x);
        case DisplayChannel::green:
            return Rgb(exposed.y);
        case DisplayChannel::blue:
            return Rgb(exposed.z);
        case DisplayChannel::luminance:
            return Rgb(luminance(exposed));
        case DisplayChannel::color:
        case DisplayChannel::alpha:
            break;
    }
    return exposed;
}

}  // namespace

std::optional<ToneMap> tone_map_from_name(std::string_view name) {
    for (const ToneMapInfo& info : kToneMaps) {
        if (info.name == name) return info.tone_map;
    }
    return std::nullopt;
}

Rgb apply_tone_map(ToneMap tone_map, const Rgb& exposed) {
    if (!is_finite(exposed)) return Rgb(1, 0, 1);
    const Rgb c = glm::min(glm::max(exposed, Rgb(0)), Rgb(kLargestExposed));
    Rgb mapped = c;
    switch (tone_map) {
        case ToneMap::linear:
            break;
        case ToneMap::aces:
            mapped = tone_map_aces(c);
            break;
        case ToneMap::agx:
            mapped = tone_map_agx(c);
            break;
        case ToneMap::neutral:
            mapped = tone_map_neutral(c);
            break;
    }
    return Rgb(clamp01(mapped.x), clamp01(mapped.y), clamp01(mapped.z));
}

float srgb_from_linear(float linear) {
    if (linear <= 0.0031308f) return 12.92f * linear;
    return 1.055f * std::pow(linear, 1.0f / 2.4f) - 0.055f;
}

float linear_from_srgb(float encoded) {
    if (encoded <= 0.04045f) return encoded / 12.92f;
    return std::pow((encoded + 0.055f) / 1.055f, 2.4f);
}

ImageBytes develop(const ImageRgba& image, const DisplaySettings& display) {
    const bool straight_alpha = !image.alpha.empty() && display.channel == DisplayChannel::color;
    const float scale = std::exp2(display.exposure_ev);
    static const SrgbSteps encode;
    ImageBytes out;
    out.width = image.width;
    out.height = image.height;
    out.channels = straight_alpha ? 4 : 3;
    out.bytes.resize(image.rgb.size() * out.channels);
    for (std::size_t i = 0; i < image.rgb.size(); ++i) {
        uint8_t* pixel = &out.bytes[i * out.channels];
        const float alpha = image.alpha.empty() ? 1.0f : image.alpha[i];
        if (display.channel == DisplayChannel::alpha) {
            std::fill(pixel, pixel + 3, to_byte(alpha));
            continue;
        }
        Rgb exposed = image.rgb[i] * scale;
        if (straight_alpha) exposed = alpha > 0 ? exposed / alpha : Rgb(0);
        const Rgb mapped =
            apply_tone_map(display.tone_map, select_channel(display.channel, exposed));
        for (int c = 0; c < 3; ++c) pixel[c] = encode(mapped[c]);
        if (straight_alpha) pixel[3] = to_byte(alpha);
    }
    return out;
}

}  // namespace talbot
