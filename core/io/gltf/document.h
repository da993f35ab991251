// A glTF file taken apart: the JSON as tinygltf's model, the buffers as bytes, the images as the
// place where their bytes are. tinygltf gets neither buffers nor images: files, data URIs and sizes
// are handled here, with the folder guarded.
#pragma once

#include <filesystem>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/io/gltf/model.h"

namespace talbot::gltf {

// `bytes` points into `owned`, or into Document::bytes for the buffer of a .glb. Exactly byteLength
// bytes.
struct BufferBytes {
    std::vector<uint8_t> owned;
    std::span<const uint8_t> bytes;
};

// Either a URI (a data URI is decoded late, by whoever needs the image) or a buffer view.
struct ImageSource {
    std::string name;
    std::string uri;
    std::optional<uint32_t> buffer_view;
    std::optional<double> glossiness;  // decoded as roughness: see RoughnessImage
};

struct Document {
    std::filesystem::path file;
    std::vector<uint8_t> bytes;  // the main file
    tinygltf::Model model;       // indices are within their arrays; buffers and images are empty
    std::vector<BufferBytes> buffers;  // those of decoded views come after the file's
    uint64_t decoded_bytes = 0;        // in those, at most the limit of the caller
    std::vector<ImageSource> images;
    std::vector<std::filesystem::path> other_files;  // that its buffers and images name
    std::vector<std::string> warnings;
    size_t lasting_warnings = 0;  // so many of them do not come from the animations
    std::shared_ptr<const nlohmann::json> source;  // of the model, where it has animations
    std::optional<double> animation_time;          // that the model is at

    Error error(const std::string& element, const std::string& what) const {
        return {ErrorKind::bad_input, file.string(), element, what};
    }
};

// "accessors[3]"
std::string element_name(const char* array, size_t index);

// Reads and checks the file and its buffers; images stay unread. The model has the values of the
// file.
Result<Document> read_document(const std::filesystem::path& file, uint64_t max_bytes);

// Gives the model the values that its animations have at that time, or those of the file. After an
// error the document must not be used.
Status set_animation_time(Document& document, std::optional<double> seconds);

// The bytes of a buffer view, within its buffer.
Result<std::span<const uint8_t>> view_bytes(const Document& document, size_t buffer_view);

}  // namespace talbot::gltf
