// PNG through libpng: everything that PNG can hold is read to RGBA8; 8-bit RGB(A) is written with
// fixed settings and no time.
#include <png.h>
#include <zlib.h>

#include <csetjmp>
#include <cstring>

#include "core/io/image_codecs.h"
#include "core/io/image_io.h"

namespace talbot {

namespace {

struct PngFailure {
    std::string message;
};

struct PngSource {
    std::span<const uint8_t> bytes;
    size_t position = 0;
};

// libpng leaves through longjmp; the message is kept for the Result.
[[noreturn]] void on_png_error(png_structp png, png_const_charp message) {
    static_cast<PngFailure*>(png_get_error_ptr(png))->message = message;
    png_longjmp(png, 1);
}

void on_png_warning(png_structp, png_const_charp) {}

void read_png_bytes(png_structp png, png_bytep out, size_t count) {
    auto* source = static_cast<PngSource*>(png_get_io_ptr(png));
    if (source->bytes.size() - source->position < count) png_error(png, "the file ends too early");
    std::memcpy(out, source->bytes.data() + source->position, count);
    source->position += count;
}

void write_png_bytes(png_structp png, png_bytep bytes, size_t count) {
    auto* out = static_cast<std::vector<uint8_t>*>(png_get_io_ptr(png));
    out->insert(out->end(), bytes, bytes + count);
}

void flush_png(png_structp) {}

class PngReader {
  public:
    explicit PngReader(std::span<const uint8_t> bytes) : source_{bytes} {
        png_ =
            png_create_read_struct(PNG_LIBPNG_VER_STRING, &failure_, on_png_error, on_png_warning);
        if (png_) info_ = png_create_info_struct(png_);
    }
    ~PngReader() {
        png_destroy_read_struct(png_ ? &png_ : nullptr, info_ ? &info_ : nullptr, nullptr);
    }
    PngReader(const PngReader&) = delete;
    PngReader& operator=(const PngReader&) = delete;

    bool ready() const { return png_ && info_; }
    const std::string& message() const { return failure_.message; }
    uint32_t width() const { return png_get_image_width(png_, info_); }
    uint32_t height() const { return png_get_image_height(png_, info_); }

    // Reads up to the pixels; false after a failure. No object with a destructor lives in these two
    // functions.
    bool read_header() {
        if (setjmp(png_jmpbuf(png_))) return false;
        png_set_user_limits(png_, 0x7FFFFFFF, 0x7FFFFFFF);
        png_set_chunk_cache_max(png_, 256);
        png_set_chunk_malloc_max(png_, 1u << 24);
        png_set_crc_action(png_, PNG_CRC_DEFAULT, PNG_CRC_WARN_DISCARD);
        png_set_read_fn(png_, &source_, read_png_bytes);
        png_read_info(png_, info_);
        return true;
    }

    bool read_rgba(uint8_t* rgba, png_bytep* rows) {
        if (setjmp(png_jmpbuf(png_))) return false;
        const size_t row_bytes = size_t{4} * width();
        for (uint32_t y = 0; y < height(); ++y) rows[y] = rgba + y * row_bytes;
        png_set_scale_16(png_);
        png_set_expand(png_);
        png_set_gray_to_rgb(png_);
        png_set_add_alpha(png_, 255, PNG_FILLER_AFTER);
        png_set_interlace_handling(png_);
        png_read_update_info(png_, info_);
        if (png_get_rowbytes(png_, info_) != row_bytes)
            png_error(png_, "has an unexpected row size");
        png_read_image(png_, rows);
        return true;
    }

  private:
    PngFailure failure_;
    PngSource source_;
    png_structp png_ = nullptr;
    png_infop info_ = nullptr;
};

class PngWriter {
  public:
    PngWriter() {
        png_ =
            png_create_write_struct(PNG_LIBPNG_VER_STRING, &failure_, on_png_error, on_png_warning);
        if (png_) info_ = png_create_info_struct(png_);
    }
    ~PngWriter() { png_destroy_write_struct(png_ ? &png_ : nullptr, info_ ? &info_ : nullptr); }
    PngWriter(const PngWriter&) = delete;
    PngWriter& operator=(const PngWriter&) = delete;

    bool ready() const { return png_ && info_; }
    const std::string& message() const { return failure_.message; }

    bool write(const ImageBytes& image, std::vector<png_text>& texts, std::vector<uint8_t>& out) {
        if (setjmp(png_jmpbuf(png_))) return false;
        png_set_write_fn(png_, &out, write_png_bytes, flush_png);
        png_set_IHDR(png_, info_, image.width, image.height, 8,
                     image.channels == 4 ? PNG_COLOR_TYPE_RGBA : PNG_COLOR_TYPE_RGB,
                     PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_BASE, PNG_FILTER_TYPE_BASE);
        png_set_sRGB(png_, info_, PNG_sRGB_INTENT_PERCEPTUAL);
        // Renders are noisy: more effort costs several times the time for a few per cent of size.
        png_set_compression_level(png_, 1);
        png_set_compression_strategy(png_, Z_RLE);
        png_set_filter(png_, PNG_FILTER_TYPE_BASE, PNG_FILTER_SUB);
        if (!texts.empty()) png_set_text(png_, info_, texts.data(), static_cast<int>(texts.size()));
        png_write_info(png_, info_);
        const size_t row_bytes = size_t{image.channels} * image.width;
        for (uint32_t y = 0; y < image.height; ++y)
            png_write_row(png_, image.bytes.data() + y * row_bytes);
        png_write_end(png_, info_);
        return true;
    }

  private:
    PngFailure failure_;
    png_structp png_ = nullptr;
    png_infop info_ = nullptr;
};

}  // namespace

Result<Image8> decode_png(std::span<const uint8_t> bytes, const std::string& name,
                          uint64_t max_texels) {
    PngReader reader(bytes);
    if (!reader.ready()) return image_error(name, "no memory to decode this PNG");
    if (!reader.read_header()) return image_error(name, "is a broken PNG: " + reader.message());
    const Status size =
        check_image_size(reader.width(), reader.height(), max_texels, bytes.size(), name);
    if (!size) return size.error();
    Image8 image;
    image.name = name;
    image.width = reader.width();
    image.height = reader.height();
    image.rgba.resize(size_t{4} * image.width * image.height);
    std::vector<png_bytep> rows(image.height);
    if (!reader.read_rgba(image.rgba.data(), rows.data())) {
        return image_error(name, "is a broken PNG: " + reader.message());
    }
    return image;
}

Status save_png(const std::filesystem::path& file, const ImageBytes& image,
                const Metadata& metadata) {
    TALBOT_CHECK(image.channels == 3 || image.channels == 4);
    TALBOT_CHECK(image.bytes.size() == size_t{image.channels} * image.width * image.height);
    // A PNG keyword is 1 to 79 Latin-1 characters.
    Metadata kept;
    for (const auto& [key, value] : metadata) {
        if (!key.empty()) kept.emplace_back(key.substr(0, 79), value);
    }
    std::vector<png_text> texts;
    for (auto& [key, value] : kept) {
        png_text text{};
        text.compression = PNG_TEXT_COMPRESSION_NONE;
        text.key = key.data();
        text.text = value.data();
        text.text_length = value.size();
        texts.push_back(text);
    }
    std::vector<uint8_t> out;
    PngWriter writer;
    if (!writer.ready())
        return Error{ErrorKind::cannot_write, file.string(), "", "no memory to write a PNG"};
    if (!writer.write(image, texts, out)) {
        return Error{ErrorKind::cannot_write, file.string(), "",
                     "cannot make a PNG: " + writer.message()};
    }
    return write_file_atomically(file, out);
}

}  // namespace talbot
