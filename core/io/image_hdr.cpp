// Radiance pictures (.hdr, Ward 1991): RGBE texels, flat or run-length coded in the old or the new
// way, any orientation. A texel of mantissa m and exponent e means m 2^(e - 136); EXPOSURE lines
// are divided out.
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <cstring>

#include "core/io/image_codecs.h"
#include "core/io/image_io.h"
#include "core/math/robust.h"

namespace talbot {

namespace {

struct HdrHeader {
    uint32_t width = 0;
    uint32_t height = 0;
    bool columns_first = false;  // "+X w +Y h": scanlines are columns
    bool flip_x = false;
    bool flip_y = false;
    float scale = 1;
};

class ByteReader {
  public:
    explicit ByteReader(std::span<const uint8_t> bytes) : bytes_(bytes) {}

    size_t left() const { return bytes_.size() - at_; }
    const uint8_t* here() const { return bytes_.data() + at_; }
    void skip(size_t count) { at_ += count; }

    // The line up to '\n', without it; false when there is none.
    bool line(std::string& text) {
        const void* end = std::memchr(here(), '\n', left());
        if (!end) return false;
        const size_t length = static_cast<size_t>(static_cast<const uint8_t*>(end) - here());
        text.assign(reinterpret_cast<const char*>(here()), length);
        if (!text.empty() && text.back() == '\r') text.pop_back();
        at_ += length + 1;
        return true;
    }

  private:
    std::span<const uint8_t> bytes_;
    size_t at_ = 0;
};

// "-Y 512 +X 1024" and its seven sisters.
bool parse_resolution(const std::string& line, HdrHeader& header) {
    char sign[2], axis[2];
    unsigned long long size[2];
    if (std::sscanf(line.c_str(), "%c%c %llu %c%c %llu", &sign[0], &axis[0], &size[0], &sign[1],
                    &axis[1], &size[1]) != 6) {
        return false;
    }
    if (!((axis[0] == 'Y' && axis[1] == 'X') || (axis[0] == 'X' && axis[1] == 'Y'))) return false;
    header.columns_first = axis[0] == 'X';
    const size_t x = header.columns_first ? 0 : 1;
    const size_t y = 1 - x;
    if (size[0] > 0x7FFFFFFF || size[1] > 0x7FFFFFFF) return false;
    header.width = static_cast<uint32_t>(size[x]);
    header.height = static_cast<uint32_t>(size[y]);
    header.flip_x = sign[x] == '-';
    header.flip_y = sign[y] == '+';
    return true;
}

// Empty text means success.
std::string parse_header(ByteReader& in, HdrHeader& header) {
    std::string line;
    if (!in.line(line)) return "its header ends too early";
    double exposure = 1;
    while (true) {
        if (!in.line(line)) return "its header ends too early";
        if (line.empty()) break;
        if (line.starts_with("FORMAT=") && line != "FORMAT=32-bit_rle_rgbe")
            return "only FORMAT=32-bit_rle_rgbe is supported";
        if (line.starts_with("EXPOSURE=")) exposure *= std::strtod(line.c_str() + 9, nullptr);
    }
    if (!in.line(line) || !parse_resolution(line, header)) return "it has no valid resolution line";
    const double scale = 1 / exposure;
    if (!(scale > 0) || !is_finite(static_cast<float>(scale)))
        return "its EXPOSURE is not a positive number";
    header.scale = static_cast<float>(scale);
    return {};
}

// One scanline of four separately coded channels (the new way); the 4-byte marker has been read.
bool read_new_scanline(ByteReader& in, uint8_t* rgbe, uint32_t length) {
    for (size_t channel = 0; channel < 4; ++channel) {
        for (uint32_t x = 0; x < length;) {
            if (in.left() < 2) return false;
            uint32_t count = in.here()[0];
            const bool run = count > 128;
            if (run) count -= 128;
            if (count == 0 || count > length - x) return false;
            in.skip(1);
            if (in.left() < (run ? 1u : count)) return false;
            for (uint32_t i = 0; i < count; ++i, ++x)
                rgbe[size_t{4} * x + channel] = in.here()[run ? 0 : i];
            in.skip(run ? 1 : count);
        }
    }
    return true;
}

// Flat texels, and the old way: 1 1 1 n repeats the last texel n times, successive ones count in
// higher bytes.
bool read_old_scanline(ByteReader& in, uint8_t* rgbe, uint32_t length) {
    unsigned shift = 0;
    for (uint32_t x = 0; x < length;) {
        if (in.left() < 4) return false;
        const uint8_t* t = in.here();
        if (t[0] == 1 && t[1] == 1 && t[2] == 1) {
            if (x == 0 || shift > 24) return false;
            const uint64_t count = uint64_t{t[3]} << shift;
            if (count > length - x) return false;
            for (uint64_t i = 0; i < count; ++i, ++x)
                std::memcpy(rgbe + size_t{4} * x, rgbe + size_t{4} * (x - 1), 4);
            shift += 8;
        } else {
            std::memcpy(rgbe + size_t{4} * x, t, 4);
            ++x;
            shift = 0;
        }
        in.skip(4);
    }
    return true;
}

bool read_scanline(ByteReader& in, uint8_t* rgbe, uint32_t length) {
    if (in.left() < 4) return false;
    const uint8_t* t = in.here();
    const bool new_way = length >= 8 && length <= 0x7FFF && t[0] == 2 && t[1] == 2 && t[2] < 128;
    if (!new_way) return read_old_scanline(in, rgbe, length);
    if ((uint32_t{t[2]} << 8 | t[3]) != length) return false;
    in.skip(4);
    return read_new_scanline(in, rgbe, length);
}

inline Rgb decode_rgbe(const uint8_t* t, float scale) {
    if (t[3] == 0) return Rgb(0);
    const float unit = std::ldexp(scale, static_cast<int>(t[3]) - 136);
    return Rgb(static_cast<float>(t[0]), static_cast<float>(t[1]), static_cast<float>(t[2])) * unit;
}

// Rounded to the nearest mantissa; non-finite and negative channels become 0, too large ones the
// largest number.
void encode_rgbe(const Rgb& color, uint8_t* t) {
    Rgb c(0);
    for (int i = 0; i < 3; ++i) {
        if (color[i] > 0) c[i] = std::min(color[i], 0x1.FEp126f);
    }
    const float largest = max_component(c);
    int exponent = 0;
    std::frexp(largest, &exponent);
    if (largest > 0 && std::lrint(std::ldexp(largest, 8 - exponent)) > 255) ++exponent;
    if (!(largest > 0) || exponent < -127) {
        std::memset(t, 0, 4);
        return;
    }
    for (int i = 0; i < 3; ++i)
        t[i] = static_cast<uint8_t>(std::lrint(std::ldexp(c[i], 8 - exponent)));
    t[3] = static_cast<uint8_t>(exponent + 128);
}

// One channel of a scanline: runs of 4 and more, else literal stretches of at most 128.
void write_channel(const std::vector<uint8_t>& values, std::vector<uint8_t>& out) {
    constexpr size_t kMinRun = 4;
    const size_t n = values.size();
    const auto run_length = [&](size_t i) {
        size_t length = 1;
        while (i + length < n && length < 127 && values[i + length] == values[i]) ++length;
        return length;
    };
    for (size_t i = 0; i < n;) {
        const size_t run = run_length(i);
        if (run >= kMinRun) {
            out.push_back(static_cast<uint8_t>(128 + run));
            out.push_back(values[i]);
            i += run;
            continue;
        }
        const size_t start = i;
        while (i < n && i - start < 128 && run_length(i) < kMinRun) ++i;
        out.push_back(static_cast<uint8_t>(i - start));
        out.insert(out.end(), values.begin() + static_cast<ptrdiff_t>(start),
                   values.begin() + static_cast<ptrdiff_t>(i));
    }
}

}  // namespace

Result<ImageRgba> decode_hdr(std::span<const uint8_t> bytes, const std::string& name) {
    ByteReader in(bytes);
    HdrHeader header;
    if (const std::string problem = parse_header(in, header); !problem.empty()) {
        return image_error(name, "is not a readable Radiance file: " + problem);
    }
    const Status size =
        check_image_size(header.width, header.height, kMaxFloatTexels, bytes.size(), name);
    if (!size) return size.error();

    ImageRgba image;
    image.width = header.width;
    image.height = header.height;
    image.rgb.resize(size_t{header.width} * header.height);
    const uint32_t lines = header.columns_first ? header.width : header.height;
    const uint32_t length = header.columns_first ? header.height : header.width;
    std::vector<uint8_t> rgbe(size_t{4} * length);
    for (uint32_t line = 0; line < lines; ++line) {
        if (!read_scanline(in, rgbe.data(), length)) {
            return image_error(name, "is truncated or damaged at scanline " + std::to_string(line));
        }
        for (uint32_t i = 0; i < length; ++i) {
            uint32_t x = header.columns_first ? line : i;
            uint32_t y = header.columns_first ? i : line;
            if (header.flip_x) x = header.width - 1 - x;
            if (header.flip_y) y = header.height - 1 - y;
            image.rgb[size_t{y} * header.width + x] =
                decode_rgbe(&rgbe[size_t{4} * i], header.scale);
        }
    }
    return image;
}

Status save_hdr(const std::filesystem::path& file, const ImageRgba& image) {
    TALBOT_CHECK(image.rgb.size() == size_t{image.width} * image.height);
    const std::string head = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y " +
                             std::to_string(image.height) + " +X " + std::to_string(image.width) +
                             "\n";
    std::vector<uint8_t> out(head.begin(), head.end());
    const bool coded = image.width >= 8 && image.width <= 0x7FFF;
    std::vector<uint8_t> rgbe(size_t{4} * image.width);
    std::vector<uint8_t> channel(image.width);
    for (uint32_t y = 0; y < image.height; ++y) {
        for (uint32_t x = 0; x < image.width; ++x)
            encode_rgbe(image.rgb[size_t{y} * image.width + x], &rgbe[size_t{4} * x]);
        if (!coded) {
            out.insert(out.end(), rgbe.begin(), rgbe.end());
            continue;
        }
        out.insert(out.end(), {2, 2, static_cast<uint8_t>(image.width >> 8),
                               static_cast<uint8_t>(image.width & 255)});
        for (size_t c = 0; c < 4; ++c) {
            for (uint32_t x = 0; x < image.width; ++x) channel[x] = rgbe[size_t{4} * x + c];
            write_channel(channel, out);
        }
    }
    return write_file_atomically(file, out);
}

}  // namespace talbot
