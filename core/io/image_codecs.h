// What the image codecs share: one function per file format, over bytes in memory. Private to
// core/io.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/film/image.h"
#include "core/scene/texture.h"

namespace talbot {

// Texel dimensions from an image's header alone.
struct ImageSize {
    uint64_t width = 0;
    uint64_t height = 0;
};

enum class ImageFormat { unknown, png, jpeg, webp, ktx2, hdr, exr, pfm };

// By the first bytes, never by the file's name.
ImageFormat image_format(std::span<const uint8_t> bytes);

// The 8-bit formats only; the numbers are what the header says, unchecked.
Result<ImageSize> image8_size(std::span<const uint8_t> bytes, const std::string& name);

Result<Image8> decode_png(std::span<const uint8_t> bytes, const std::string& name,
                          uint64_t max_texels);
Result<Image8> decode_jpeg(std::span<const uint8_t> bytes, const std::string& name,
                           uint64_t max_texels);
Result<Image8> decode_webp(std::span<const uint8_t> bytes, const std::string& name,
                           uint64_t max_texels);
Result<ImageSize> webp_size(std::span<const uint8_t> bytes, const std::string& name);
// Mip level `level` of a texture in ETC1S or UASTC; the size is that of level 0.
Result<Image8> decode_ktx2(std::span<const uint8_t> bytes, const std::string& name,
                           uint64_t max_texels, uint32_t level = 0);
Result<ImageSize> ktx2_size(std::span<const uint8_t> bytes, const std::string& name);
Result<ImageRgba> decode_hdr(std::span<const uint8_t> bytes, const std::string& name);
Result<ImageRgba> decode_pfm(std::span<const uint8_t> bytes, const std::string& name);
Result<ImageRgba> decode_exr(std::span<const uint8_t> bytes, const std::string& name);

// Limit of 8-bit images.
inline constexpr uint64_t kMaxImageTexels = 1ull << 28;

// Float images larger than this are refused before anything is allocated.
inline constexpr uint64_t kMaxFloatTexels = 1ull << 28;

inline Error image_error(const std::string& name, const std::string& what) {
    return {ErrorKind::bad_input, name, "", what};
}

// Whether width x height can be decoded: not empty, within max_texels, and not more than file_bytes
// can hold at the best compression of any format (a lying header).
Status check_image_size(uint64_t width, uint64_t height, uint64_t max_texels, uint64_t file_bytes,
                        const std::string& name);

}  // namespace talbot
