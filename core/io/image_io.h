// Image files in and out; the only includer of image codecs. Everything written appears whole or
// not at all.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/base/result.h"
#include "core/film/image.h"
#include "core/scene/environment.h"
#include "core/scene/texture.h"

namespace talbot {

// Decodes PNG, JPEG, WebP or KTX2 (by content) to RGBA8; 16-bit PNG is rounded. `name` is only for
// messages. Refuses images whose header declares more than max_texels.
Result<Image8> decode_image8(std::span<const uint8_t> bytes, const std::string& name,
                             uint64_t max_texels = 1ull << 28);

// Reads .hdr or .exr as an environment; non-finite and negative texels become 0 and are counted.
Result<EnvironmentImage> load_environment(const std::filesystem::path& file);

// Reads .exr, .hdr, .pfm or .png (sRGB decoded to linear) as scene-linear RGB.
Result<ImageRgba> load_image(const std::filesystem::path& file);

using Metadata = std::vector<std::pair<std::string, std::string>>;

// Straight-alpha 8-bit sRGB.
Status save_png(const std::filesystem::path& file, const ImageBytes& image,
                const Metadata& metadata = {});
// 32-bit float premultiplied RGBA (RGB when alpha is empty), with further layers as NAME.R/G/B or
// NAME.V. Deterministic bytes.
Status save_exr(const std::filesystem::path& file, const ImageRgba& image,
                const std::vector<ImageLayer>& layers = {}, const Metadata& metadata = {});
Status save_hdr(const std::filesystem::path& file, const ImageRgba& image);
Status save_pfm(const std::filesystem::path& file, const ImageRgba& image);

// Refuses a file that could not be written: no such folder, no permission, or something there that
// is no regular file.
Status check_writable(const std::filesystem::path& file);

// Writes bytes to a temporary file beside `file`, then renames it.
Status write_file_atomically(const std::filesystem::path& file, std::span<const uint8_t> bytes);

// Reads a whole file; refuses files over max_bytes.
Result<std::vector<uint8_t>> read_file(const std::filesystem::path& file,
                                       uint64_t max_bytes = 1ull << 32);

// SHA-256 in lower-case hex.
std::string sha256_hex(std::span<const uint8_t> bytes);
std::string sha256_hex(std::string_view text);

}  // namespace talbot
