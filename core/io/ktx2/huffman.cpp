// Canonical Huffman codes, decoded a bit at a time: a first code and a count per length suffice.
#include "core/io/ktx2/huffman.h"

namespace talbot::ktx2 {

namespace {

// The order in which the lengths of the 21 codes for lengths are sent.
constexpr std::array<uint8_t, 21> kLengthOrder{17, 18, 19, 20, 0,  8, 7,  9, 6,  10, 5,
                                               11, 4,  12, 3,  13, 2, 14, 1, 15, 16};

// Symbols of the lengths' code above the lengths themselves: runs of zeros and repeats.
constexpr uint32_t kShortZeros = 17;
constexpr uint32_t kLongZeros = 18;
constexpr uint32_t kShortRepeat = 19;
constexpr uint32_t kLongRepeat = 20;

uint32_t run_length(uint32_t symbol, BitReader& in) {
    switch (symbol) {
        case kShortZeros:
            return 3 + in.bits(3);
        case kLongZeros:
            return 11 + in.bits(7);
        case kShortRepeat:
            return 3 + in.bits(2);
        case kLongRepeat:
            return 7 + in.bits(7);
        default:
            return 1;
    }
}

}  // namespace

std::optional<HuffmanCode> HuffmanCode::from_lengths(const std::vector<uint8_t>& lengths) {
    HuffmanCode code;
    for (const uint8_t length : lengths) ++code.count_[length];
    code.count_[0] = 0;
    uint32_t left = 1;  // codes not yet taken at this length
    std::array<uint32_t, kMaxLength + 2> first{};
    for (size_t length = 1; length <= kMaxLength; ++length) {
        left <<= 1;
        if (code.count_[length] > left) return std::nullopt;
        left -= code.count_[length];
        first[length + 1] = first[length] + code.count_[length];
    }
    code.symbols_.resize(first[kMaxLength + 1]);
    for (size_t symbol = 0; symbol < lengths.size(); ++symbol) {
        if (lengths[symbol] != 0)
            code.symbols_[first[lengths[symbol]]++] = static_cast<uint16_t>(symbol);
    }
    return code;
}

std::optional<HuffmanCode> HuffmanCode::read(BitReader& in) {
    const uint32_t symbol_count = in.bits(14);
    const uint32_t length_count = in.bits(5);
    if (length_count > kLengthOrder.size()) return std::nullopt;
    std::vector<uint8_t> length_lengths(kLengthOrder.size(), 0);
    for (uint32_t i = 0; i < length_count; ++i)
        length_lengths[kLengthOrder[i]] = static_cast<uint8_t>(in.bits(3));
    const std::optional<HuffmanCode> length_code = from_lengths(length_lengths);
    if (!length_code) return std::nullopt;
    std::vector<uint8_t> lengths;
    lengths.reserve(symbol_count);
    while (lengths.size() < symbol_count) {
        const std::optional<uint32_t> symbol = length_code->decode(in);
        if (!symbol) return std::nullopt;
        uint8_t length = static_cast<uint8_t>(*symbol <= kMaxLength ? *symbol : 0);
        if (*symbol >= kShortRepeat) {
            if (lengths.empty() || lengths.back() == 0) return std::nullopt;
            length = lengths.back();
        }
        const uint32_t run = run_length(*symbol, in);
        if (run > symbol_count - lengths.size()) return std::nullopt;
        lengths.insert(lengths.end(), run, length);
    }
    if (in.is_past_end()) return std::nullopt;
    return from_lengths(lengths);
}

std::optional<uint32_t> HuffmanCode::decode(BitReader& in) const {
    uint32_t code = 0;
    uint32_t first = 0;  // code of this length
    uint32_t index = 0;  // its symbol
    for (size_t length = 1; length <= kMaxLength; ++length) {
        code |= in.bit();
        if (in.is_past_end()) return std::nullopt;
        if (code - first < count_[length]) return symbols_[index + (code - first)];
        index += count_[length];
        first = (first + count_[length]) << 1;
        code <<= 1;
    }
    return std::nullopt;
}

}  // namespace talbot::ktx2
