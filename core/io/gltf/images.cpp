// Where an image's bytes come from, and the check of its declared size before it is decoded.
#include "core/io/gltf/images.h"

#include <algorithm>
#include <cmath>

#include "core/io/gltf/uri.h"
#include "core/io/gltf/values.h"
#include "core/io/image_codecs.h"
#include "core/io/image_io.h"

namespace talbot::gltf {

namespace {

struct EncodedImage {
    std::vector<uint8_t> owned;
    std::span<const uint8_t> bytes;
    std::string label;  // for the user: the name or the file of the image
};

Result<EncodedImage> encoded_image(const Document& document, size_t index, uint64_t max_bytes) {
    const ImageSource& source = document.images[index];
    const std::string element = element_name("images", index);
    EncodedImage image;
    image.label = source.name;
    if (source.buffer_view) {
        const Result<std::span<const uint8_t>> bytes = view_bytes(document, *source.buffer_view);
        if (!bytes) return bytes.error();
        image.bytes = *bytes;
    } else if (is_data_uri(source.uri)) {
        std::optional<std::vector<uint8_t>> bytes = decode_data_uri(source.uri);
        if (!bytes) return document.error(element, "its data URI is malformed");
        image.owned = std::move(*bytes);
        image.bytes = image.owned;
    } else {
        const Result<std::filesystem::path> path =
            resolve_uri(document.file.parent_path(), source.uri);
        if (!path) return document.error(element, path.error().what);
        Result<std::vector<uint8_t>> bytes = read_file(*path, max_bytes);
        if (!bytes) return document.error(element, bytes.error().line());
        image.owned = std::move(bytes.value());
        image.bytes = image.owned;
        if (image.label.empty()) image.label = path->filename().string();
    }
    if (image.label.empty()) image.label = "image " + std::to_string(index);
    return image;
}

// Green becomes 1 - factor * alpha; red and blue are not used.
void make_roughness(double factor, Image8& image) {
    for (size_t i = 0; i < image.rgba.size(); i += 4) {
        const double roughness = 255 - factor * image.rgba[i + 3];
        image.rgba[i] = image.rgba[i + 2] = image.rgba[i + 3] = 255;
        image.rgba[i + 1] = static_cast<uint8_t>(std::lround(std::clamp(roughness, 0.0, 255.0)));
    }
}

}  // namespace

std::optional<uint32_t> image_of_texture(const tinygltf::Texture& texture) {
    for (const char* name : {"KHR_texture_basisu", "EXT_texture_webp"}) {
        const tinygltf::Value* extension = find_extension_value(texture.extensions, name);
        if (!extension) continue;
        if (const std::optional<uint32_t> source = index_member(*extension, "source"))
            return source;
    }
    if (texture.source < 0) return std::nullopt;
    return static_cast<uint32_t>(texture.source);
}

Result<std::shared_ptr<const Image8>> load_image8(const Document& document, size_t index,
                                                  MemoryBudget& budget, uint64_t max_bytes) {
    const Result<EncodedImage> encoded = encoded_image(document, index, max_bytes);
    if (!encoded) return encoded.error();
    const std::string element = element_name("images", index);
    const auto fail = [&](const Error& error) { return document.error(element, error.line()); };
    const Result<ImageSize> size = image8_size(encoded->bytes, encoded->label);
    if (!size) return fail(size.error());
    const Status sane = check_image_size(size->width, size->height, kMaxImageTexels,
                                         encoded->bytes.size(), encoded->label);
    if (!sane) return fail(sane.error());
    if (!budget.reserve(size->width * size->height * 4)) return over_budget(document, max_bytes);
    Result<Image8> image = decode_image8(encoded->bytes, encoded->label, kMaxImageTexels);
    if (!image) return fail(image.error());
    if (const std::optional<double> factor = document.images[index].glossiness)
        make_roughness(*factor, image.value());
    return std::make_shared<const Image8>(std::move(image.value()));
}

}  // namespace talbot::gltf
