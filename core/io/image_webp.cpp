// WebP images (still ones, lossy or lossless) to RGBA8, through libwebp.
#include <webp/decode.h>

#include "core/io/image_codecs.h"

namespace talbot {

namespace {

Result<WebPBitstreamFeatures> webp_features(std::span<const uint8_t> bytes,
                                            const std::string& name) {
    WebPBitstreamFeatures features;
    if (WebPGetFeatures(bytes.data(), bytes.size(), &features) != VP8_STATUS_OK)
        return image_error(name, "is a broken WebP: its header cannot be read");
    if (features.has_animation) return image_error(name, "is an animated WebP; use a still image");
    return features;
}

}  // namespace

Result<ImageSize> webp_size(std::span<const uint8_t> bytes, const std::string& name) {
    const Result<WebPBitstreamFeatures> features = webp_features(bytes, name);
    if (!features) return features.error();
    return ImageSize{static_cast<uint64_t>(features->width),
                     static_cast<uint64_t>(features->height)};
}

Result<Image8> decode_webp(std::span<const uint8_t> bytes, const std::string& name,
                           uint64_t max_texels) {
    const Result<ImageSize> size = webp_size(bytes, name);
    if (!size) return size.error();
    if (Status sane = check_image_size(size->width, size->height, max_texels, bytes.size(), name);
        !sane)
        return sane.error();
    Image8 image{static_cast<uint32_t>(size->width), static_cast<uint32_t>(size->height), {}, name};
    const size_t stride = size_t{image.width} * 4;
    image.rgba.resize(stride * image.height);
    if (!WebPDecodeRGBAInto(bytes.data(), bytes.size(), image.rgba.data(), image.rgba.size(),
                            static_cast<int>(stride)))
        return image_error(name, "is a broken WebP: the file ends too early or is damaged");
    return image;
}

}  // namespace talbot
