// The image formats behind one door: which decoder reads a file, and what an environment demands of
// it.
#include "core/io/image_io.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "core/io/image_codecs.h"
#include "core/io/ktx2/container.h"
#include "core/math/robust.h"

namespace talbot {

namespace {

bool starts_with(std::span<const uint8_t> bytes, std::string_view text) {
    return bytes.size() >= text.size() && std::memcmp(bytes.data(), text.data(), text.size()) == 0;
}

uint32_t big_endian(std::span<const uint8_t> bytes, size_t at, int count) {
    uint32_t value = 0;
    for (int i = 0; i < count; ++i) value = value << 8 | bytes[at + static_cast<size_t>(i)];
    return value;
}

// Above deflate's best ratio (1032) at one bit a texel, and above JPEG's and EXR's.
constexpr uint64_t kMaxTexelsPerByte = 16384;

// The frame header of a JPEG, found by walking its segments.
Result<ImageSize> jpeg_size(std::span<const uint8_t> bytes, const std::string& name) {
    size_t at = 2;
    while (at + 9 <= bytes.size()) {
        if (bytes[at] != 0xFF) break;
        const uint8_t marker = bytes[at + 1];
        if (marker == 0xFF) {
            ++at;
            continue;
        }
        const bool frame =
            marker >= 0xC0 && marker <= 0xCF && marker != 0xC4 && marker != 0xC8 && marker != 0xCC;
        if (frame) return ImageSize{big_endian(bytes, at + 7, 2), big_endian(bytes, at + 5, 2)};
        at += 2 + (marker == 0x01 || (marker >= 0xD0 && marker <= 0xD7)
                       ? 0u
                       : big_endian(bytes, at + 2, 2));
    }
    return image_error(name, "is a broken JPEG: it has no frame header");
}

}  // namespace

ImageFormat image_format(std::span<const uint8_t> bytes) {
    if (starts_with(bytes, "\x89PNG\r\n\x1A\n")) return ImageFormat::png;
    if (starts_with(bytes, "\xFF\xD8\xFF")) return ImageFormat::jpeg;
    if (starts_with(bytes, "RIFF") &&
        starts_with(bytes.subspan(std::min<size_t>(8, bytes.size())), "WEBP"))
        return ImageFormat::webp;
    if (ktx2::is_ktx2(bytes)) return ImageFormat::ktx2;
    if (starts_with(bytes, "#?")) return ImageFormat::hdr;
    if (starts_with(bytes, "\x76\x2F\x31\x01")) return ImageFormat::exr;
    if (starts_with(bytes, "PF") || starts_with(bytes, "Pf")) return ImageFormat::pfm;
    return ImageFormat::unknown;
}

Status check_image_size(uint64_t width, uint64_t height, uint64_t max_texels, uint64_t file_bytes,
                        const std::string& name) {
    const std::string size = std::to_string(width) + "x" + std::to_string(height);
    if (width == 0 || height == 0) return image_error(name, "is an empty image (" + size + ")");
    if (width > 0x7FFFFFFF || height > 0x7FFFFFFF || width > max_texels / height) {
        return image_error(name, "is declared as " + size + " texels, more than the limit of " +
                                     std::to_string(max_texels));
    }
    if (width * height / kMaxTexelsPerByte > file_bytes) {
        return image_error(name, "is declared as " + size + " texels, more than its " +
                                     std::to_string(file_bytes) + " bytes can hold");
    }
    return Done{};
}

Result<ImageSize> image8_size(std::span<const uint8_t> bytes, const std::string& name) {
    switch (image_format(bytes)) {
        case ImageFormat::png:
            if (bytes.size() < 24)
                return image_error(name, "is a broken PNG: the file ends too early");
            return ImageSize{big_endian(bytes, 16, 4), big_endian(bytes, 20, 4)};
        case ImageFormat::jpeg:
            return jpeg_size(bytes, name);
        case ImageFormat::webp:
            return webp_size(bytes, name);
        case ImageFormat::ktx2:
            return ktx2_size(bytes, name);
        default:
            return image_error(name, "is none of PNG, JPEG, WebP and KTX2");
    }
}

Result<Image8> decode_image8(std::span<const uint8_t> bytes, const std::string& name,
                             uint64_t max_texels) {
    switch (image_format(bytes)) {
        case ImageFormat::png:
            return decode_png(bytes, name, max_texels);
        case ImageFormat::jpeg:
            return decode_jpeg(bytes, name, max_texels);
        case ImageFormat::webp:
            return decode_webp(bytes, name, max_texels);
        case ImageFormat::ktx2:
            return decode_ktx2(bytes, name, max_texels);
        default:
            return image_error(name,
                               bytes.empty() ? "is empty" : "is none of PNG, JPEG, WebP and KTX2");
    }
}

namespace {

Result<ImageRgba> png_to_linear(std::span<const uint8_t> bytes, const std::string& name) {
    Result<Image8> decoded = decode_png(bytes, name, kMaxFloatTexels);
    if (!decoded) return decoded.error();
    Texture texture;
    texture.filter = TextureFilter::nearest;
    const auto source = std::make_shared<const Image8>(std::move(decoded.value()));
    texture.image = source;
    ImageRgba image;
    image.width = source->width;
    image.height = source->height;
    const size_t count = size_t{image.width} * image.height;
    image.rgb.resize(count);
    image.alpha.resize(count);
    bool opaque = true;
    for (uint32_t y = 0; y < image.height; ++y) {
        for (uint32_t x = 0; x < image.width; ++x) {
            const Vec2f uv((static_cast<float>(x) + 0.5f) / static_cast<float>(image.width),
                           (static_cast<float>(y) + 0.5f) / static_cast<float>(image.height));
            const Vec4f texel = eval_texture(texture, uv, TextureEncoding::srgb);
            const size_t i = size_t{y} * image.width + x;
            image.rgb[i] = Rgb(texel) * texel.w;
            image.alpha[i] = texel.w;
            opaque = opaque && texel.w == 1;
        }
    }
    if (opaque) image.alpha.clear();
    return image;
}

Result<ImageRgba> decode_float_image(std::span<const uint8_t> bytes, const std::string& name) {
    switch (image_format(bytes)) {
        case ImageFormat::hdr:
            return decode_hdr(bytes, name);
        case ImageFormat::exr:
            return decode_exr(bytes, name);
        case ImageFormat::pfm:
            return decode_pfm(bytes, name);
        case ImageFormat::png:
            return png_to_linear(bytes, name);
        default:
            break;
    }
    return image_error(name, bytes.empty() ? "is empty" : "is none of .exr, .hdr, .pfm and .png");
}

}  // namespace

Result<ImageRgba> load_image(const std::filesystem::path& file) {
    const Result<std::vector<uint8_t>> bytes = read_file(file);
    if (!bytes) return bytes.error();
    return decode_float_image(*bytes, file.string());
}

Result<EnvironmentImage> load_environment(const std::filesystem::path& file) {
    const Result<std::vector<uint8_t>> bytes = read_file(file);
    if (!bytes) return bytes.error();
    const ImageFormat format = image_format(*bytes);
    if (format != ImageFormat::hdr && format != ImageFormat::exr) {
        return image_error(file.string(), bytes->empty() ? "is empty" : "is neither .hdr nor .exr");
    }
    Result<ImageRgba> image = decode_float_image(*bytes, file.string());
    if (!image) return image.error();
    EnvironmentImage environment;
    environment.width = image->width;
    environment.height = image->height;
    environment.texels = std::move(image->rgb);
    environment.file = file.string();
    environment.sha256 = sha256_hex(*bytes);
    for (Rgb& texel : environment.texels) {
        if (is_finite(texel) && min_component(texel) >= 0) continue;
        texel = Rgb(0);
        ++environment.repaired_texels;
    }
    return environment;
}

}  // namespace talbot
