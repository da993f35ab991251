// Portable float maps (.pfm): raw 32-bit floats, rows from the bottom up, byte order by the sign of
// the scale. Written little-endian.
#include <bit>
#include <cmath>
#include <cstdio>
#include <cstring>

#include "core/io/image_codecs.h"
#include "core/io/image_io.h"

namespace talbot {

namespace {

// Reads one blank-separated token and the single blank behind it.
bool read_token(std::span<const uint8_t> bytes, size_t& at, std::string& token) {
    const auto is_blank = [](uint8_t c) { return c == ' ' || c == '\n' || c == '\r' || c == '\t'; };
    token.clear();
    while (at < bytes.size() && is_blank(bytes[at])) ++at;
    while (at < bytes.size() && !is_blank(bytes[at]) && token.size() < 64)
        token += static_cast<char>(bytes[at++]);
    if (token.empty() || at >= bytes.size() || !is_blank(bytes[at])) return false;
    ++at;
    return true;
}

float read_float(const uint8_t* bytes, bool little) {
    uint32_t bits = 0;
    for (unsigned i = 0; i < 4; ++i) bits |= uint32_t{bytes[i]} << (8 * (little ? i : 3 - i));
    return std::bit_cast<float>(bits);
}

}  // namespace

Result<ImageRgba> decode_pfm(std::span<const uint8_t> bytes, const std::string& name) {
    const auto broken = [&](const char* why) {
        return image_error(name, std::string("is a broken PFM: ") + why);
    };
    size_t at = 0;
    std::string kind, width_text, height_text, scale_text;
    if (!read_token(bytes, at, kind) || !read_token(bytes, at, width_text) ||
        !read_token(bytes, at, height_text) || !read_token(bytes, at, scale_text)) {
        return broken("its header ends too early");
    }
    if (kind != "PF" && kind != "Pf") return broken("it begins with neither PF nor Pf");
    const uint64_t width = std::strtoull(width_text.c_str(), nullptr, 10);
    const uint64_t height = std::strtoull(height_text.c_str(), nullptr, 10);
    const double scale = std::strtod(scale_text.c_str(), nullptr);
    if (Status size = check_image_size(width, height, kMaxFloatTexels, bytes.size(), name); !size)
        return size.error();
    if (!(scale != 0) || !std::isfinite(scale))
        return broken("its scale is not a number other than 0");
    const size_t channels = kind == "PF" ? 3 : 1;
    if (bytes.size() - at < width * height * channels * 4) return broken("the file ends too early");

    ImageRgba image;
    image.width = static_cast<uint32_t>(width);
    image.height = static_cast<uint32_t>(height);
    image.rgb.resize(width * height);
    const uint8_t* in = bytes.data() + at;
    for (size_t row = 0; row < height; ++row) {
        for (size_t x = 0; x < width; ++x) {
            Rgb& rgb = image.rgb[(height - 1 - row) * width + x];
            for (size_t c = 0; c < 3; ++c)
                rgb[static_cast<int>(c)] = read_float(in + 4 * (channels == 3 ? c : 0), scale < 0);
            in += 4 * channels;
        }
    }
    return image;
}

Status save_pfm(const std::filesystem::path& file, const ImageRgba& image) {
    TALBOT_CHECK(image.rgb.size() == size_t{image.width} * image.height);
    const std::string head =
        "PF\n" + std::to_string(image.width) + " " + std::to_string(image.height) + "\n-1.0\n";
    std::vector<uint8_t> out(head.begin(), head.end());
    out.reserve(head.size() + image.rgb.size() * 12);
    for (uint32_t row = image.height; row-- > 0;) {
        for (uint32_t x = 0; x < image.width; ++x) {
            for (int c = 0; c < 3; ++c) {
                const auto bits =
                    std::bit_cast<uint32_t>(image.rgb[size_t{row} * image.width + x][c]);
                for (unsigned i = 0; i < 4; ++i)
                    out.push_back(static_cast<uint8_t>(bits >> (8 * i)));
            }
        }
    }
    return write_file_atomically(file, out);
}

}  // namespace talbot
