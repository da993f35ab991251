// JPEG through libjpeg: baseline and progressive, grey and YCbCr, to RGBA8. CMYK is refused, since
// it needs a colour profile.

// clang-format off
#include <cstdio>   // before jpeglib.h, which uses FILE and size_t
#include <jpeglib.h>
#include <jerror.h>
// clang-format on

#include <csetjmp>

#include "core/io/image_codecs.h"

namespace talbot {

namespace {

struct JpegErrors {
    jpeg_error_mgr base;  // first, so that libjpeg's pointer is also ours
    std::jmp_buf back;
    char message[JMSG_LENGTH_MAX];
};

// Missing or damaged picture data is only a warning to libjpeg; here it is an error. Stray bytes
// between segments are not.
void on_jpeg_message(j_common_ptr info, int level) {
    if (level >= 0) return;
    const int code = info->err->msg_code;
    if (code != JWRN_JPEG_EOF && code != JWRN_HIT_MARKER && code != JWRN_HUFF_BAD_CODE) return;
    auto* errors = reinterpret_cast<JpegErrors*>(info->err);
    errors->base.format_message(info, errors->message);
    std::longjmp(errors->back, 1);
}

[[noreturn]] void on_jpeg_error(j_common_ptr info) {
    auto* errors = reinterpret_cast<JpegErrors*>(info->err);
    errors->base.format_message(info, errors->message);
    std::longjmp(errors->back, 1);
}

class JpegReader {
  public:
    JpegReader() {
        info_.err = jpeg_std_error(&errors_.base);
        errors_.base.error_exit = on_jpeg_error;
        errors_.base.emit_message = on_jpeg_message;
        errors_.message[0] = 0;
    }
    ~JpegReader() { jpeg_destroy_decompress(&info_); }
    JpegReader(const JpegReader&) = delete;
    JpegReader& operator=(const JpegReader&) = delete;

    std::string message() const { return errors_.message; }
    uint32_t width() const { return info_.image_width; }
    uint32_t height() const { return info_.image_height; }
    bool is_cmyk() const {
        return info_.jpeg_color_space == JCS_CMYK || info_.jpeg_color_space == JCS_YCCK;
    }

    // No object with a destructor lives in these two functions: libjpeg leaves them through
    // longjmp.
    bool read_header(std::span<const uint8_t> bytes) {
        if (setjmp(errors_.back)) return false;
        jpeg_create_decompress(&info_);
        jpeg_mem_src(&info_, bytes.data(), static_cast<unsigned long>(bytes.size()));
        jpeg_read_header(&info_, TRUE);
        return true;
    }

    bool read_rgba(uint8_t* rgba) {
        if (setjmp(errors_.back)) return false;
        info_.out_color_space = JCS_EXT_RGBA;
        info_.dct_method = JDCT_ISLOW;
        jpeg_start_decompress(&info_);
        while (info_.output_scanline < info_.output_height) {
            JSAMPROW row = rgba + size_t{4} * info_.output_width * info_.output_scanline;
            jpeg_read_scanlines(&info_, &row, 1);
        }
        jpeg_finish_decompress(&info_);
        return true;
    }

  private:
    jpeg_decompress_struct info_{};
    JpegErrors errors_{};
};

}  // namespace

Result<Image8> decode_jpeg(std::span<const uint8_t> bytes, const std::string& name,
                           uint64_t max_texels) {
    JpegReader reader;
    if (!reader.read_header(bytes))
        return image_error(name, "is a broken JPEG: " + reader.message());
    const Status size =
        check_image_size(reader.width(), reader.height(), max_texels, bytes.size(), name);
    if (!size) return size.error();
    if (reader.is_cmyk())
        return image_error(name, "is a CMYK JPEG, which is not supported; convert it to RGB");
    Image8 image;
    image.name = name;
    image.width = reader.width();
    image.height = reader.height();
    image.rgba.resize(size_t{4} * image.width * image.height);
    if (!reader.read_rgba(image.rgba.data()))
        return image_error(name, "is a broken JPEG: " + reader.message());
    return image;
}

}  // namespace talbot
