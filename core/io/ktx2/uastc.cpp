// UASTC blocks: a mode by prefix code, then hints for other formats (skipped), a partition pattern
// or a component for the second plane, endpoints (trits or quints first, then plain bits), weights.
#include "core/io/ktx2/uastc.h"

#include <bit>

namespace talbot::ktx2 {

namespace {

// How endpoints are quantised: a base-3 or base-5 digit beside the plain bits, or no digit.
enum class Digit : uint8_t { none, trit, quint };

struct Mode {
    uint8_t code;         // its prefix code, first bit lowest
    uint8_t code_length;  // bits of it
    uint8_t start;        // first bit behind code and hints
    uint8_t components;   // 2: luminance and alpha, 3: RGB, 4: RGBA
    uint8_t subsets;
    uint8_t planes;
    uint8_t weight_bits;
    Digit digit;
    uint8_t endpoint_bits;
};

constexpr size_t kSolidMode = 8;
constexpr size_t kOtherPatternsMode = 7;
constexpr size_t kLuminanceAlphaPlanesMode = 17;

constexpr auto kModes = std::to_array<Mode>({
    {0b0001, 4, 19, 3, 1, 1, 4, Digit::trit, 6},   {0b110101, 6, 21, 3, 1, 1, 2, Digit::none, 8},
    {0b11101, 5, 20, 3, 2, 1, 3, Digit::none, 4},  {0b00011, 5, 20, 3, 3, 1, 2, Digit::trit, 2},
    {0b10011, 5, 20, 3, 2, 1, 2, Digit::quint, 3}, {0b01011, 5, 20, 3, 1, 1, 3, Digit::none, 8},
    {0b11011, 5, 20, 3, 1, 2, 2, Digit::quint, 5}, {0b00111, 5, 20, 3, 2, 1, 2, Digit::quint, 3},
    {0b10111, 5, 5, 4, 0, 0, 0, Digit::none, 8},   {0b01111, 5, 28, 4, 2, 1, 2, Digit::none, 4},
    {0b010, 3, 20, 4, 1, 1, 4, Digit::trit, 4},    {0b00, 2, 19, 4, 1, 2, 2, Digit::trit, 4},
    {0b110, 3, 20, 4, 1, 1, 3, Digit::trit, 6},    {0b11111, 5, 28, 4, 1, 2, 1, Digit::none, 8},
    {0b01101, 5, 28, 4, 1, 1, 2, Digit::none, 8},  {0b0000101, 7, 30, 2, 1, 1, 4, Digit::none, 8},
    {0b010101, 6, 29, 2, 2, 1, 2, Digit::none, 8}, {0b100101, 6, 29, 2, 1, 2, 2, Digit::none, 8},
    {0b1001, 4, 19, 3, 1, 1, 5, Digit::none, 5},
});

constexpr auto kTwoSubsets = std::to_array<uint16_t>({
    0xCCCC, 0x8888, 0x1111, 0xECC8, 0x377F, 0xFEEC, 0x0137, 0x137F, 0xC800, 0x0013,
    0xFE80, 0x17FF, 0x0017, 0x00FF, 0xFFF0, 0x0FFF, 0xFF71, 0x8EFF, 0x08CE, 0x008C,
    0x7310, 0xCEFF, 0x7331, 0x088C, 0xCEEF, 0x6666, 0xF00F, 0x5555, 0x0F0F, 0x36C9,
});

constexpr auto kTwoSubsetsMode7 = std::to_array<uint16_t>({
    0x00F0, 0x4444, 0x0133, 0xCC80, 0xF0FF, 0x2222, 0xFFC8, 0xCCCE, 0x3C03, 0x00EE,
    0x7700, 0x3003, 0x00CE, 0xFF80, 0x6FFF, 0x1333, 0x11FF, 0x136C, 0x00EF,
});

constexpr auto kThreeSubsets = std::to_array<std::array<uint16_t, 2>>({
    {0x3300, 0xCC00},
    {0x00FF, 0xF000},
    {0x000F, 0xF000},
    {0x000F, 0x00F0},
    {0x3333, 0x4444},
    {0x6666, 0x8888},
    {0xCCCC, 0x2222},
    {0xEE00, 0x1111},
    {0x4444, 0x9999},
    {0xF00F, 0x0F00},
    {0x0CC0, 0xC00C},
});

// The mode of every value of the first seven bits; kModes.size() where there is none.
constexpr std::array<uint8_t, 128> make_mode_table() {
    std::array<uint8_t, 128> table{};
    for (uint32_t bits = 0; bits < table.size(); ++bits) {
        table[bits] = kModes.size();
        for (uint8_t m = 0; m < kModes.size(); ++m) {
            if ((bits & ((1u << kModes[m].code_length) - 1)) == kModes[m].code) table[bits] = m;
        }
    }
    return table;
}

constexpr std::array<uint8_t, 128> kModeTable = make_mode_table();

// A cursor over the 128 bits.
class BlockBits {
  public:
    explicit BlockBits(std::span<const uint8_t, 16> bytes) {
        for (size_t i = 0; i < 8; ++i) {
            low_ |= uint64_t{bytes[i]} << (8 * i);
            high_ |= uint64_t{bytes[8 + i]} << (8 * i);
        }
    }
    uint32_t first_seven() const { return low_ & 127; }
    void seek(uint32_t at) { at_ = at; }

    // count <= 8; zeros past the end.
    uint32_t take(uint32_t count) {
        uint64_t value = 0;
        if (at_ < 64) value = low_ >> at_ | (at_ > 0 ? high_ << (64 - at_) : 0);
        if (at_ >= 64 && at_ < 128) value = high_ >> (at_ - 64);
        at_ += count;
        return static_cast<uint32_t>(value & ((1u << count) - 1));
    }

  private:
    uint64_t low_ = 0;
    uint64_t high_ = 0;
    uint32_t at_ = 0;
};

// ASTC's unquantisation of endpoints to 0..255 (Khronos Data Format Specification, ASTC "Endpoint
// unquantization").
uint8_t unquantize_endpoint(uint32_t bits, uint32_t digit, const Mode& mode) {
    const uint32_t upper = bits >> 1;
    uint32_t b = 0;
    uint32_t c = 0;
    switch (mode.endpoint_bits) {
        case 2:
            b = upper * 0x116;
            c = 93;
            break;
        case 3:
            b = upper << 7 | upper << 1 | upper >> 1;
            c = 26;
            break;
        case 4:
            b = upper << 6 | upper;
            c = 22;
            break;
        case 5:
            b = upper << 5 | upper >> 3;
            c = 6;
            break;
        default:
            b = upper << 4 | upper >> 4;
            c = 5;
            break;
    }
    const uint32_t a = (bits & 1) != 0 ? 0x1FFu : 0u;
    return static_cast<uint8_t>((a & 0x80u) | ((digit * c + b) ^ a) >> 2);
}

uint8_t unquantize_plain(uint32_t bits, uint32_t width) {
    if (width == 4) return static_cast<uint8_t>(bits * 17);
    if (width == 5) return static_cast<uint8_t>(bits << 3 | bits >> 2);
    return static_cast<uint8_t>(bits);
}

// Weights to 0..64.
uint32_t unquantize_weight(uint32_t bits, uint32_t width) {
    uint32_t weight = 0;
    switch (width) {
        case 1:
            weight = bits * 63;
            break;
        case 2:
            weight = bits * 21;
            break;
        case 3:
            weight = bits * 9;
            break;
        case 4:
            weight = bits << 2 | bits >> 2;
            break;
        default:
            weight = bits << 1 | bits >> 4;
            break;
    }
    return weight > 32 ? weight + 1 : weight;
}

constexpr size_t kMaxEndpoints = 18;
using Endpoints = std::array<uint8_t, kMaxEndpoints>;

// Groups of digits are packed as one number in base 3 (five in 8 bits) or 5 (three in 7 bits); a
// last group of fewer takes just the bits it needs.
void read_digits(BlockBits& in, Digit kind, size_t count,
                 std::array<uint32_t, kMaxEndpoints>& out) {
    const uint32_t base = kind == Digit::trit ? 3 : 5;
    const size_t group = kind == Digit::trit ? 5 : 3;
    for (size_t i = 0; i < count; i += group) {
        const size_t digits = std::min(group, count - i);
        uint32_t values = 1;
        for (size_t k = 0; k < digits; ++k) values *= base;
        uint32_t packed = in.take(static_cast<uint32_t>(std::bit_width(values - 1)));
        for (size_t k = 0; k < digits; ++k) {
            out[i + k] = packed % base;
            packed /= base;
        }
    }
}

Endpoints read_endpoints(BlockBits& in, const Mode& mode) {
    const size_t count = size_t{2} * mode.components * mode.subsets;
    std::array<uint32_t, kMaxEndpoints> digits{};
    if (mode.digit != Digit::none) read_digits(in, mode.digit, count, digits);
    Endpoints endpoints{};
    for (size_t i = 0; i < count; ++i) {
        const uint32_t bits = in.take(mode.endpoint_bits);
        endpoints[i] = mode.digit == Digit::none ? unquantize_plain(bits, mode.endpoint_bits)
                                                 : unquantize_endpoint(bits, digits[i], mode);
    }
    return endpoints;
}

struct Partition {
    std::array<uint8_t, 16> subset{};
    uint16_t anchors = 1;  // the first texel of every subset
};

// False for a pattern that is not there.
bool read_partition(BlockBits& in, size_t mode, Partition& out) {
    std::array<uint16_t, 2> masks{};
    if (kModes[mode].subsets == 1) return true;
    const uint32_t pattern = in.take(kModes[mode].subsets == 2 ? 5 : 4);
    if (kModes[mode].subsets == 3) {
        if (pattern >= kThreeSubsets.size()) return false;
        masks = kThreeSubsets[pattern];
    } else {
        const std::span<const uint16_t> patterns =
            mode == kOtherPatternsMode ? two_subset_patterns_mode7() : two_subset_patterns();
        if (pattern >= patterns.size()) return false;
        masks[0] = patterns[pattern];
    }
    const uint16_t rest = static_cast<uint16_t>(~(masks[0] | masks[1]));
    out.anchors = 0;
    for (const uint16_t mask : {rest, masks[0], masks[1]})
        out.anchors |= static_cast<uint16_t>(mask & -mask);
    for (size_t i = 0; i < 16; ++i)
        out.subset[i] = static_cast<uint8_t>((masks[0] >> i & 1) + 2 * (masks[1] >> i & 1));
    return true;
}

// ASTC's interpolation in 16 bits.
uint8_t interpolate(uint32_t e0, uint32_t e1, uint32_t weight, bool is_srgb) {
    const uint32_t c0 = e0 << 8 | (is_srgb ? 0x80u : e0);
    const uint32_t c1 = e1 << 8 | (is_srgb ? 0x80u : e1);
    return static_cast<uint8_t>((c0 * (64 - weight) + c1 * weight + 32) >> 14);
}

void fill_solid(BlockBits& in, Block& out) {
    std::array<uint8_t, 4> color{};
    for (uint8_t& channel : color) channel = static_cast<uint8_t>(in.take(8));
    out.fill(color);
}

}  // namespace

std::span<const uint16_t> two_subset_patterns() {
    return kTwoSubsets;
}

std::span<const uint16_t> two_subset_patterns_mode7() {
    return kTwoSubsetsMode7;
}

std::span<const std::array<uint16_t, 2>> three_subset_patterns() {
    return kThreeSubsets;
}

bool decode_uastc_block(std::span<const uint8_t, 16> bytes, bool is_srgb, Block& out) {
    BlockBits in(bytes);
    const size_t index = kModeTable[in.first_seven()];
    if (index == kModes.size()) return false;
    const Mode& mode = kModes[index];
    in.seek(mode.start);
    if (index == kSolidMode) {
        fill_solid(in, out);
        return true;
    }
    Partition partition;
    if (!read_partition(in, index, partition)) return false;
    uint32_t second_plane = 3;
    if (mode.planes == 2 && index != kLuminanceAlphaPlanesMode) second_plane = in.take(2);
    const Endpoints endpoints = read_endpoints(in, mode);
    for (size_t texel = 0; texel < 16; ++texel) {
        // An anchor's highest bit is 0 and left out.
        const uint32_t width = mode.weight_bits - (partition.anchors >> texel & 1u);
        std::array<uint32_t, 2> weights{};
        for (size_t plane = 0; plane < mode.planes; ++plane)
            weights[plane] = unquantize_weight(in.take(width), mode.weight_bits);
        const uint8_t* e = &endpoints[size_t{2} * mode.components * partition.subset[texel]];
        for (uint32_t channel = 0; channel < 4; ++channel) {
            const bool in_second = mode.planes == 2 && channel == second_plane;
            const uint32_t weight = weights[in_second ? 1 : 0];
            uint32_t component = channel;
            if (mode.components == 2) component = channel == 3 ? 1 : 0;
            out[texel][channel] = component < mode.components
                                      ? interpolate(e[2 * component], e[2 * component + 1], weight,
                                                    is_srgb && channel < 3)
                                      : uint8_t{255};
        }
    }
    return true;
}

}  // namespace talbot::ktx2
