// OpenEXR: 32-bit float scanline files with ZIP compression and no time or host in the header; read
// with any channel type.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wshadow"
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <ImfStringAttribute.h>
#include <ImfThreading.h>
#pragma GCC diagnostic pop

#include <algorithm>
#include <cstring>
#include <stdexcept>
#include <thread>

#include "core/io/image_codecs.h"
#include "core/io/image_io.h"

namespace talbot {

namespace {

class MemoryIn : public Imf::IStream {
  public:
    MemoryIn(std::span<const uint8_t> bytes, const std::string& name)
        : Imf::IStream(name.c_str()), bytes_(bytes) {}

    bool read(char c[], int n) override {
        const auto count = static_cast<size_t>(n);
        if (n < 0 || bytes_.size() - at_ < count)
            throw std::runtime_error("the file ends too early");
        std::memcpy(c, bytes_.data() + at_, count);
        at_ += count;
        return at_ < bytes_.size();
    }
    uint64_t tellg() override { return at_; }
    void seekg(uint64_t at) override {
        if (at > bytes_.size()) throw std::runtime_error("the file ends too early");
        at_ = at;
    }

  private:
    std::span<const uint8_t> bytes_;
    size_t at_ = 0;
};

class MemoryOut : public Imf::OStream {
  public:
    MemoryOut() : Imf::OStream("memory") {}

    void write(const char c[], int n) override {
        const auto count = static_cast<size_t>(n);
        if (at_ + count > bytes.size()) bytes.resize(at_ + count);
        std::memcpy(bytes.data() + at_, c, count);
        at_ += count;
    }
    uint64_t tellp() override { return at_; }
    void seekp(uint64_t at) override { at_ = at; }

    std::vector<uint8_t> bytes;

  private:
    size_t at_ = 0;
};

// OpenEXR reads through the pointer for writing too, hence the cast.
Imf::Slice float_slice(const float* values, size_t stride_floats, size_t width) {
    return Imf::Slice(Imf::FLOAT, const_cast<char*>(reinterpret_cast<const char*>(values)),
                      stride_floats * sizeof(float), stride_floats * sizeof(float) * width);
}

class ExrPlanner {
  public:
    ExrPlanner(uint32_t width, uint32_t height, const Metadata& metadata)
        : header_(static_cast<int>(width), static_cast<int>(height)), width_(width) {
        header_.compression() = Imf::ZIP_COMPRESSION;
        // Renders are noisy: more effort costs several times the time for a few per cent of size.
        header_.zipCompressionLevel() = 1;
        for (const auto& [key, value] : metadata) header_.insert(key, Imf::StringAttribute(value));
    }

    void add(const std::string& channel, const float* values, size_t stride_floats) {
        header_.channels().insert(channel, Imf::Channel(Imf::FLOAT));
        buffer_.insert(channel, float_slice(values, stride_floats, width_));
    }

    const Imf::Header& header() const { return header_; }
    const Imf::FrameBuffer& buffer() const { return buffer_; }

  private:
    Imf::Header header_;
    Imf::FrameBuffer buffer_;
    size_t width_;
};

// Largest side that is believed, before the library allocates by the header.
constexpr int kMaxSide = 1 << 17;

Result<ImageRgba> read_exr(std::span<const uint8_t> bytes, const std::string& name) {
    MemoryIn stream(bytes, name);
    Imf::Header::setMaxImageSize(kMaxSide, kMaxSide);
    Imf::InputFile file(stream, 0);
    const Imath::Box2i window = file.header().dataWindow();
    const auto width = static_cast<uint64_t>(window.max.x - window.min.x + 1);
    const auto height = static_cast<uint64_t>(window.max.y - window.min.y + 1);
    if (Status size = check_image_size(width, height, kMaxFloatTexels, bytes.size(), name); !size)
        return size.error();
    const Imf::ChannelList& channels = file.header().channels();
    const bool color =
        channels.findChannel("R") && channels.findChannel("G") && channels.findChannel("B");
    if (!color && (!channels.findChannel("Y") || channels.findChannel("RY"))) {
        return image_error(name, "has neither the channels R, G and B nor Y alone");
    }

    ImageRgba image;
    image.width = static_cast<uint32_t>(width);
    image.height = static_cast<uint32_t>(height);
    image.rgb.resize(width * height);
    Imf::FrameBuffer buffer;
    // Slices are addressed by absolute pixel coordinates, which may be negative.
    const auto insert = [&](const char* channel, float* values, int64_t stride_floats) {
        const auto stride = stride_floats * static_cast<int64_t>(sizeof(float));
        char* base = reinterpret_cast<char*>(values) - stride * window.min.x -
                     stride * static_cast<int64_t>(width) * window.min.y;
        buffer.insert(channel, Imf::Slice(Imf::FLOAT, base, static_cast<size_t>(stride),
                                          static_cast<size_t>(stride) * width));
    };
    insert(color ? "R" : "Y", &image.rgb[0].x, 3);
    if (color) insert("G", &image.rgb[0].y, 3);
    if (color) insert("B", &image.rgb[0].z, 3);
    if (channels.findChannel("A")) {
        image.alpha.resize(width * height);
        insert("A", image.alpha.data(), 1);
    }
    file.setFrameBuffer(buffer);
    file.readPixels(window.min.y, window.max.y);
    if (!color) {
        for (Rgb& rgb : image.rgb) rgb = Rgb(rgb.x);
    }
    return image;
}

// Blocks of lines are compressed side by side; the file is the same for any number.
int write_threads() {
    static const int count = [] {
        const int cores = static_cast<int>(std::clamp(std::thread::hardware_concurrency(), 1u, 8u));
        Imf::setGlobalThreadCount(cores);
        return cores;
    }();
    return count;
}

}  // namespace

Result<ImageRgba> decode_exr(std::span<const uint8_t> bytes, const std::string& name) {
    try {
        return read_exr(bytes, name);
    } catch (const std::exception& problem) {
        return image_error(name, std::string("is a broken EXR: ") + problem.what());
    }
}

Status save_exr(const std::filesystem::path& file, const ImageRgba& image,
                const std::vector<ImageLayer>& layers, const Metadata& metadata) {
    const size_t count = size_t{image.width} * image.height;
    TALBOT_CHECK(count > 0 && image.rgb.size() == count &&
                 (image.alpha.empty() || image.alpha.size() == count));
    ExrPlanner planner(image.width, image.height, metadata);
    planner.add("R", &image.rgb[0].x, 3);
    planner.add("G", &image.rgb[0].y, 3);
    planner.add("B", &image.rgb[0].z, 3);
    if (!image.alpha.empty()) planner.add("A", image.alpha.data(), 1);
    for (const ImageLayer& layer : layers) {
        TALBOT_CHECK((layer.channels == 1 || layer.channels == 3) &&
                     layer.values.size() == count * layer.channels);
        if (layer.channels == 1) planner.add(layer.name + ".V", layer.values.data(), 1);
        if (layer.channels == 3) {
            planner.add(layer.name + ".R", layer.values.data(), 3);
            planner.add(layer.name + ".G", layer.values.data() + 1, 3);
            planner.add(layer.name + ".B", layer.values.data() + 2, 3);
        }
    }
    MemoryOut stream;
    try {
        const int threads = write_threads();
        Imf::OutputFile out(stream, planner.header(), threads);
        out.setFrameBuffer(planner.buffer());
        out.writePixels(static_cast<int>(image.height));
    } catch (const std::exception& problem) {
        return Error{ErrorKind::cannot_write, file.string(), "",
                     std::string("cannot make an EXR: ") + problem.what()};
    }
    return write_file_atomically(file, stream.bytes);
}

}  // namespace talbot
