// KTX 2.0 textures in the Basis Universal formats to RGBA8.
#include <zstd.h>

#include <algorithm>

#include "core/io/image_codecs.h"
#include "core/io/ktx2/container.h"
#include "core/io/ktx2/etc1s.h"
#include "core/io/ktx2/uastc.h"

namespace talbot {

namespace {

using namespace ktx2;

// Channel ids of the data format descriptor's samples (Khronos Data Format Specification, ETC1S and
// UASTC colour models).
constexpr uint8_t kEtc1sGreen = 4;
constexpr uint8_t kUastcRgb = 0;
constexpr uint8_t kUastcRed = 4;

Error broken(const std::string& name, const std::string& what) {
    return image_error(name, "is a broken KTX2: " + what);
}

Image8 empty_image(const Container& file, size_t level, const std::string& name) {
    Image8 image{std::max(file.width >> level, 1u), std::max(file.height >> level, 1u), {}, name};
    image.rgba.resize(size_t{4} * image.width * image.height);
    return image;
}

// The bytes of a level of UASTC blocks, decompressed when they are under Zstandard.
Result<std::vector<uint8_t>> uastc_bytes(const Container& file, size_t level, size_t size,
                                         const std::string& name) {
    const Level& in = file.levels[level];
    if (file.supercompression == Supercompression::none) {
        if (in.bytes.size() < size) return broken(name, "a level has too few bytes");
        return std::vector<uint8_t>(in.bytes.begin(),
                                    in.bytes.begin() + static_cast<ptrdiff_t>(size));
    }
    std::vector<uint8_t> bytes(size);
    if (in.uncompressed_length != size ||
        ZSTD_decompress(bytes.data(), size, in.bytes.data(), in.bytes.size()) != size)
        return broken(name, "a level's Zstandard stream is damaged or of the wrong length");
    return bytes;
}

Result<Image8> decode_uastc(const Container& file, size_t level, const std::string& name) {
    Image8 image = empty_image(file, level, name);
    const uint32_t blocks_x = (image.width + 3) / 4;
    const uint32_t blocks_y = (image.height + 3) / 4;
    const Result<std::vector<uint8_t>> bytes =
        uastc_bytes(file, level, size_t{16} * blocks_x * blocks_y, name);
    if (!bytes) return bytes.error();
    const uint8_t channels = file.channels.front();
    const bool is_opaque = channels == kUastcRgb || channels == kUastcRed;
    Block block;
    for (uint32_t by = 0; by < blocks_y; ++by) {
        for (uint32_t bx = 0; bx < blocks_x; ++bx) {
            const size_t at = (size_t{by} * blocks_x + bx) * 16;
            const std::span<const uint8_t, 16> in(bytes->data() + at, 16);
            if (!decode_uastc_block(in, file.is_srgb, block))
                return broken(name, "block " + std::to_string(at / 16) + " is no UASTC block");
            for (uint32_t y = 0; y < 4 && 4 * by + y < image.height; ++y) {
                for (uint32_t x = 0; x < 4 && 4 * bx + x < image.width; ++x) {
                    uint8_t* out = &image.rgba[(size_t{4 * by + y} * image.width + 4 * bx + x) * 4];
                    std::copy_n(block[4 * y + x].begin(), 4, out);
                    if (is_opaque) out[3] = 255;
                }
            }
        }
    }
    return image;
}

Result<std::vector<uint8_t>> decode_slice(const Etc1sDecoder& decoder,
                                          std::span<const uint8_t> level, uint32_t offset,
                                          uint32_t length, const Image8& image) {
    if (offset > level.size() || length > level.size() - offset)
        return broken(image.name, "a slice lies beyond its level");
    std::optional<std::vector<uint8_t>> rgb =
        decoder.decode(level.subspan(offset, length), image.width, image.height);
    if (!rgb) return broken(image.name, "its ETC1S stream is damaged");
    return std::move(*rgb);
}

// A second slice holds alpha, or green beside red in the first.
Result<Image8> decode_etc1s(const Container& file, size_t level, const std::string& name) {
    const std::optional<Etc1sDecoder> decoder =
        Etc1sDecoder::read(file.global_data, file.levels.size());
    if (!decoder) return broken(name, "its BasisLZ codebooks are damaged");
    Image8 image = empty_image(file, level, name);
    const std::span<const uint8_t> bytes = file.levels[level].bytes;
    const Etc1sSlices& slices = decoder->slices(level);
    const Result<std::vector<uint8_t>> rgb =
        decode_slice(*decoder, bytes, slices.rgb_offset, slices.rgb_length, image);
    if (!rgb) return rgb.error();
    const size_t texels = size_t{image.width} * image.height;
    for (size_t i = 0; i < texels; ++i) {
        std::copy_n(&(*rgb)[3 * i], 3, &image.rgba[4 * i]);
        image.rgba[4 * i + 3] = 255;
    }
    if (file.channels.size() < 2) return image;
    const Result<std::vector<uint8_t>> second =
        decode_slice(*decoder, bytes, slices.alpha_offset, slices.alpha_length, image);
    if (!second) return second.error();
    const bool is_green = file.channels[1] == kEtc1sGreen;
    for (size_t i = 0; i < texels; ++i) {
        image.rgba[4 * i + (is_green ? 1 : 3)] = (*second)[3 * i];
        if (is_green) image.rgba[4 * i + 2] = 0;
    }
    return image;
}

}  // namespace

Result<ImageSize> ktx2_size(std::span<const uint8_t> bytes, const std::string& name) {
    const Result<Container> file = read_container(bytes, name);
    if (!file) return file.error();
    return ImageSize{file->width, file->height};
}

Result<Image8> decode_ktx2(std::span<const uint8_t> bytes, const std::string& name,
                           uint64_t max_texels, uint32_t level) {
    const Result<Container> file = read_container(bytes, name);
    if (!file) return file.error();
    if (Status sane = check_image_size(file->width, file->height, max_texels, bytes.size(), name);
        !sane)
        return sane.error();
    if (level >= file->levels.size())
        return image_error(name, "has no mip level " + std::to_string(level));
    return file->format == Format::uastc ? decode_uastc(*file, level, name)
                                         : decode_etc1s(*file, level, name);
}

}  // namespace talbot
