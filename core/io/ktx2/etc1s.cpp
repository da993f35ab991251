// ETC1S: a codebook of end points (colour and intensity), one of selectors, and per block an index
// into each, predicted from neighbours.
#include "core/io/ktx2/etc1s.h"

#include <algorithm>

namespace talbot::ktx2 {

namespace {

constexpr size_t kHeaderLength = 20;
constexpr size_t kImageLength = 20;

// ETC1's modifiers a < b of each intensity (Khronos Data Format Specification, ETC1).
constexpr std::array<std::array<int, 2>, 8> kModifiers{
    {{2, 8}, {5, 17}, {9, 29}, {13, 42}, {18, 60}, {24, 80}, {33, 106}, {47, 183}}};

uint32_t word(std::span<const uint8_t> bytes, size_t at, size_t count) {
    uint32_t value = 0;
    for (size_t i = count; i-- > 0;) value = value << 8 | bytes[at + i];
    return value;
}

// A number in groups of `width` bits, each with a flag above them that says whether more follow.
uint32_t read_groups(BitReader& in, int width) {
    uint32_t value = 0;
    for (int shift = 0; shift < 32; shift += width) {
        value |= in.bits(width) << shift;
        if (in.bit() == 0) break;
    }
    return value;
}

// Selector indices that were used lately: new ones enter in the upper half, used ones move halfway
// to the front.
class SelectorHistory {
  public:
    explicit SelectorHistory(size_t size) : values_(size, 0), next_(size / 2) {}

    size_t size() const { return values_.size(); }

    void add(uint32_t value) {
        if (values_.empty()) return;
        values_[next_++] = value;
        if (next_ == values_.size()) next_ = values_.size() / 2;
    }

    uint32_t use(size_t index) {
        const uint32_t value = values_[index];
        std::swap(values_[index / 2], values_[index]);
        return value;
    }

  private:
    std::vector<uint32_t> values_;
    size_t next_;
};

}  // namespace

// One slice, block by block. A method that returns nothing has met a broken stream.
class SliceDecoder {
  public:
    SliceDecoder(const Etc1sDecoder& tables, std::span<const uint8_t> bytes, uint32_t width,
                 uint32_t height)
        : tables_(tables),
          in_(bytes),
          width_(width),
          height_(height),
          blocks_x_((width + 3) / 4),
          blocks_y_((height + 3) / 4),
          above_(blocks_x_, 0),
          predictions_((blocks_x_ + 1) / 2, 0),
          history_(tables.history_size_) {}

    std::optional<std::vector<uint8_t>> run() {
        rgb_.resize(size_t{width_} * height_ * 3);
        for (uint32_t y = 0; y < blocks_y_; ++y) {
            above_left_ = 0;
            for (uint32_t x = 0; x < blocks_x_; ++x) {
                const std::optional<uint32_t> endpoint = next_endpoint(x, y);
                const std::optional<uint32_t> selector = endpoint ? next_selector() : std::nullopt;
                if (!selector || *endpoint >= tables_.endpoints_.size() ||
                    *selector >= tables_.selectors_.size())
                    return std::nullopt;
                write_block(x, y, tables_.endpoints_[*endpoint], tables_.selectors_[*selector]);
            }
        }
        return std::move(rgb_);
    }

  private:
    // Two bits a block, for two by two blocks at once, with runs of the same.
    std::optional<uint32_t> next_prediction(uint32_t x, uint32_t y) {
        constexpr uint32_t kRepeat = 256;
        constexpr uint32_t kShortestRun = 3;
        if (x % 2 != 0) return prediction_ >> 2 & 3;
        if (y % 2 != 0) {
            prediction_ = predictions_[x / 2];
            return prediction_ & 3;
        }
        if (repeats_ > 0) {
            --repeats_;
        } else {
            const std::optional<uint32_t> symbol = tables_.endpoint_prediction_.decode(in_);
            if (!symbol) return std::nullopt;
            if (*symbol == kRepeat) {
                repeats_ = read_groups(in_, 4) + kShortestRun - 1;
            } else {
                last_prediction_ = *symbol;
            }
        }
        prediction_ = last_prediction_;
        predictions_[x / 2] = static_cast<uint8_t>(last_prediction_ >> 4);
        return prediction_ & 3;
    }

    std::optional<uint32_t> next_endpoint(uint32_t x, uint32_t y) {
        constexpr uint32_t kLeft = 0;
        constexpr uint32_t kAbove = 1;
        constexpr uint32_t kAboveLeft = 2;
        const std::optional<uint32_t> prediction = next_prediction(x, y);
        if (!prediction) return std::nullopt;
        const bool needs_left = *prediction == kLeft || *prediction == kAboveLeft;
        const bool needs_above = *prediction == kAbove || *prediction == kAboveLeft;
        if ((needs_left && x == 0) || (needs_above && y == 0)) return std::nullopt;
        uint32_t endpoint = last_endpoint_;
        if (*prediction == kAbove) endpoint = above_[x];
        if (*prediction == kAboveLeft) endpoint = above_left_;
        if (!needs_left && !needs_above) {
            const std::optional<uint32_t> delta = tables_.endpoint_delta_.decode(in_);
            if (!delta) return std::nullopt;
            endpoint += *delta;
            const auto count = static_cast<uint32_t>(tables_.endpoints_.size());
            if (endpoint >= count) endpoint -= count;
        }
        above_left_ = above_[x];
        above_[x] = endpoint;
        last_endpoint_ = endpoint;
        return endpoint;
    }

    std::optional<uint32_t> next_selector() {
        constexpr uint32_t kShortestRun = 3;
        constexpr uint32_t kLongRun = 63;
        const auto count = static_cast<uint32_t>(tables_.selectors_.size());
        uint32_t symbol = count;
        if (selector_repeats_ > 0) {
            --selector_repeats_;
        } else {
            const std::optional<uint32_t> read = tables_.selector_.decode(in_);
            if (!read) return std::nullopt;
            symbol = *read;
            if (symbol == count + history_.size()) {
                const std::optional<uint32_t> run = tables_.selector_run_.decode(in_);
                if (!run) return std::nullopt;
                selector_repeats_ =
                    (*run == kLongRun ? read_groups(in_, 7) : *run) + kShortestRun - 1;
                symbol = count;
            }
        }
        if (symbol < count) {
            history_.add(symbol);
            return symbol;
        }
        if (symbol - count >= history_.size()) return std::nullopt;
        return history_.use(symbol - count);
    }

    void write_block(uint32_t block_x, uint32_t block_y, const Etc1sDecoder::Endpoint& endpoint,
                     const Etc1sDecoder::Selectors& selectors) {
        const auto& [a, b] = kModifiers[endpoint.intensity];
        const std::array<int, 4> offsets{-b, -a, a, b};
        const uint32_t columns = std::min(4u, width_ - 4 * block_x);
        const uint32_t rows = std::min(4u, height_ - 4 * block_y);
        for (uint32_t y = 0; y < rows; ++y) {
            uint8_t* out = &rgb_[(size_t{4 * block_y + y} * width_ + 4 * block_x) * 3];
            for (uint32_t x = 0; x < columns; ++x) {
                const int offset = offsets[selectors[y] >> (2 * x) & 3];
                for (const uint8_t c : endpoint.color)
                    *out++ = static_cast<uint8_t>(std::clamp((c << 3 | c >> 2) + offset, 0, 255));
            }
        }
    }

    const Etc1sDecoder& tables_;
    BitReader in_;
    uint32_t width_;
    uint32_t height_;
    uint32_t blocks_x_;
    uint32_t blocks_y_;
    std::vector<uint32_t> above_;       // end points of the last block of every column
    std::vector<uint8_t> predictions_;  // of the odd rows
    SelectorHistory history_;
    std::vector<uint8_t> rgb_;
    uint32_t above_left_ = 0;
    uint32_t last_endpoint_ = 0;
    uint32_t prediction_ = 0;
    uint32_t last_prediction_ = 0;
    uint32_t repeats_ = 0;
    uint32_t selector_repeats_ = 0;
};

std::optional<Etc1sDecoder> Etc1sDecoder::read(std::span<const uint8_t> global_data,
                                               size_t image_count) {
    if (global_data.size() < kHeaderLength + image_count * kImageLength) return std::nullopt;
    Etc1sDecoder out;
    for (size_t i = 0; i < image_count; ++i) {
        const size_t at = kHeaderLength + i * kImageLength;
        out.images_.push_back({word(global_data, at + 4, 4), word(global_data, at + 8, 4),
                               word(global_data, at + 12, 4), word(global_data, at + 16, 4)});
    }
    std::span<const uint8_t> rest = global_data.subspan(kHeaderLength + image_count * kImageLength);
    std::array<std::span<const uint8_t>, 3> parts;
    for (size_t i = 0; i < parts.size(); ++i) {
        const uint32_t length = word(global_data, 4 + 4 * i, 4);
        if (length > rest.size()) return std::nullopt;
        parts[i] = rest.first(length);
        rest = rest.subspan(length);
    }
    if (!out.read_endpoints(parts[0], word(global_data, 0, 2)) ||
        !out.read_selectors(parts[1], word(global_data, 2, 2)) || !out.read_codes(parts[2]))
        return std::nullopt;
    return out;
}

bool Etc1sDecoder::read_endpoints(std::span<const uint8_t> bytes, size_t count) {
    BitReader in(bytes);
    std::array<HuffmanCode, 4> codes;  // of colours that come after low, middle and high ones
    for (HuffmanCode& code : codes) {
        std::optional<HuffmanCode> read = HuffmanCode::read(in);
        if (!read) return false;
        code = std::move(*read);
    }
    const bool is_grey = in.bit() != 0;
    Endpoint last{{16, 16, 16}, 0};
    for (size_t i = 0; i < count; ++i) {
        const std::optional<uint32_t> intensity = codes[3].decode(in);
        if (!intensity) return false;
        last.intensity = static_cast<uint8_t>((last.intensity + *intensity) & 7);
        for (size_t c = 0; c < (is_grey ? 1u : 3u); ++c) {
            const uint8_t before = last.color[c];
            const std::optional<uint32_t> delta =
                codes[before < 10 ? 0 : (before < 22 ? 1 : 2)].decode(in);
            if (!delta) return false;
            last.color[c] = static_cast<uint8_t>((before + *delta) & 31);
        }
        if (is_grey) last.color[1] = last.color[2] = last.color[0];
        endpoints_.push_back(last);
    }
    return !in.is_past_end();
}

bool Etc1sDecoder::read_selectors(std::span<const uint8_t> bytes, size_t count) {
    BitReader in(bytes);
    if (in.bits(2) != 0) return false;
    const bool is_plain = in.bit() != 0;
    std::optional<HuffmanCode> code;
    if (!is_plain) {
        code = HuffmanCode::read(in);
        if (!code) return false;
    }
    for (size_t i = 0; i < count && !in.is_past_end(); ++i) {
        Selectors selectors{};
        for (size_t row = 0; row < 4; ++row) {
            if (is_plain || i == 0) {
                selectors[row] = static_cast<uint8_t>(in.bits(8));
                continue;
            }
            const std::optional<uint32_t> change = code->decode(in);
            if (!change) return false;
            selectors[row] = static_cast<uint8_t>(*change ^ selectors_.back()[row]);
        }
        selectors_.push_back(selectors);
    }
    return !in.is_past_end();
}

bool Etc1sDecoder::read_codes(std::span<const uint8_t> bytes) {
    BitReader in(bytes);
    for (HuffmanCode* code :
         {&endpoint_prediction_, &endpoint_delta_, &selector_, &selector_run_}) {
        std::optional<HuffmanCode> read = HuffmanCode::read(in);
        if (!read) return false;
        *code = std::move(*read);
    }
    history_size_ = in.bits(13);
    return !in.is_past_end();
}

std::optional<std::vector<uint8_t>> Etc1sDecoder::decode(std::span<const uint8_t> slice,
                                                         uint32_t width, uint32_t height) const {
    return SliceDecoder(*this, slice, width, height).run();
}

}  // namespace talbot::ktx2
