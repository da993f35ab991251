// KTX 2.0 container (Khronos KTX File Format Specification 2.0, sections 3 and 4).
#include "core/io/ktx2/container.h"

#include <algorithm>
#include <array>
#include <bit>

#include "core/io/image_codecs.h"

namespace talbot::ktx2 {

namespace {

constexpr std::array<uint8_t, 12> kIdentifier{0xAB, 'K',  'T',  'X',  ' ',  '2',
                                              '0',  0xBB, '\r', '\n', 0x1A, '\n'};
constexpr size_t kHeaderLength = 80;
constexpr size_t kLevelEntryLength = 24;

// Of the data format descriptor (Khronos Data Format Specification, basic descriptor block).
constexpr uint8_t kModelEtc1s = 163;
constexpr uint8_t kModelUastc = 166;
constexpr uint8_t kTransferSrgb = 2;
constexpr size_t kSamplesAt = 28;
constexpr size_t kSampleLength = 16;

uint64_t little_endian(std::span<const uint8_t> bytes, size_t at, size_t count) {
    uint64_t value = 0;
    for (size_t i = count; i-- > 0;) value = value << 8 | bytes[at + i];
    return value;
}

class ContainerReader {
  public:
    ContainerReader(std::span<const uint8_t> bytes, const std::string& name)
        : bytes_(bytes), name_(name) {}

    Result<Container> run() {
        if (bytes_.size() < kHeaderLength) return fail("is a broken KTX2: it ends in the header");
        for (const auto step : {&ContainerReader::read_header, &ContainerReader::read_levels,
                                &ContainerReader::read_descriptor}) {
            if (Status done = (this->*step)(); !done) return done.error();
        }
        return std::move(out_);
    }

  private:
    Error fail(const std::string& what) const { return image_error(name_, what); }
    uint32_t word(size_t at) const { return static_cast<uint32_t>(little_endian(bytes_, at, 4)); }

    Result<std::span<const uint8_t>> part(uint64_t offset, uint64_t length) const {
        if (offset > bytes_.size() || length > bytes_.size() - offset)
            return fail("is a broken KTX2: a part of it lies beyond the end of the file");
        return bytes_.subspan(offset, length);
    }

    Status read_header() {
        const uint32_t vk_format = word(12);
        const uint32_t depth = word(28);
        const uint32_t layers = word(32);
        const uint32_t faces = word(36);
        const uint32_t scheme = word(44);
        out_.width = word(20);
        out_.height = word(24);
        level_count_ = std::max(word(40), 1u);
        if (vk_format != 0)
            return fail("is a KTX2 of another format than ETC1S and UASTC; glTF knows only those");
        if (depth != 0 || layers != 0 || faces != 1 || out_.height == 0)
            return fail("is a KTX2, but not one plain 2D image");
        if (scheme > 2) {
            return fail("is a KTX2 with the supercompression scheme " + std::to_string(scheme) +
                        "; only none, BasisLZ and Zstandard are supported");
        }
        out_.supercompression = static_cast<Supercompression>(scheme);
        const Result<std::span<const uint8_t>> global =
            part(little_endian(bytes_, 64, 8), little_endian(bytes_, 72, 8));
        if (!global) return global.error();
        out_.global_data = *global;
        return Done{};
    }

    Status read_levels() {
        const uint32_t largest = std::max(out_.width, out_.height);
        if (level_count_ > static_cast<uint32_t>(std::bit_width(largest)))
            return fail("is a broken KTX2: it declares too many mip levels");
        if (kHeaderLength + level_count_ * kLevelEntryLength > bytes_.size())
            return fail("is a broken KTX2: it ends in the level index");
        for (size_t i = 0; i < level_count_; ++i) {
            const size_t at = kHeaderLength + i * kLevelEntryLength;
            const Result<std::span<const uint8_t>> bytes =
                part(little_endian(bytes_, at, 8), little_endian(bytes_, at + 8, 8));
            if (!bytes) return bytes.error();
            out_.levels.push_back({*bytes, little_endian(bytes_, at + 16, 8)});
        }
        return Done{};
    }

    Status read_descriptor() {
        const Result<std::span<const uint8_t>> descriptor = part(word(48), word(52));
        if (!descriptor) return descriptor.error();
        const size_t block_length = descriptor->size() < kSamplesAt + kSampleLength
                                        ? 0
                                        : little_endian(*descriptor, 10, 2) + size_t{4};
        if (block_length < kSamplesAt + kSampleLength || block_length > descriptor->size())
            return fail("is a broken KTX2: its data format descriptor is too short");
        const uint8_t model = (*descriptor)[12];
        if (model != kModelEtc1s && model != kModelUastc)
            return fail("is a KTX2 of another format than ETC1S and UASTC; glTF knows only those");
        out_.format = model == kModelEtc1s ? Format::etc1s : Format::uastc;
        out_.is_srgb = (*descriptor)[14] == kTransferSrgb;
        const bool is_basis_lz = out_.supercompression == Supercompression::basis_lz;
        if (is_basis_lz != (out_.format == Format::etc1s))
            return fail("is a broken KTX2: BasisLZ goes with ETC1S and with nothing else");
        for (size_t at = kSamplesAt; at + kSampleLength <= block_length; at += kSampleLength)
            out_.channels.push_back((*descriptor)[at + 3] & 15);
        if (out_.channels.size() > 2)
            return fail("is a broken KTX2: its data format descriptor has too many samples");
        return Done{};
    }

    std::span<const uint8_t> bytes_;
    const std::string& name_;
    uint32_t level_count_ = 1;
    Container out_;
};

}  // namespace

bool is_ktx2(std::span<const uint8_t> bytes) {
    return bytes.size() >= kIdentifier.size() &&
           std::equal(kIdentifier.begin(), kIdentifier.end(), bytes.begin());
}

Result<Container> read_container(std::span<const uint8_t> bytes, const std::string& name) {
    return ContainerReader(bytes, name).run();
}

}  // namespace talbot::ktx2
