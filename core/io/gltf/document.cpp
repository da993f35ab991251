// Reading .gltf and .glb files (glTF 2.0 specification, sections 3.6 and 4).
#include "core/io/gltf/document.h"

#include <cstring>
#include <nlohmann/json.hpp>

#include "core/io/gltf/animation.h"
#include "core/io/gltf/extensions.h"
#include "core/io/gltf/meshopt.h"
#include "core/io/gltf/specular_glossiness.h"
#include "core/io/gltf/structure.h"
#include "core/io/gltf/uri.h"
#include "core/io/gltf/value_check.h"
#include "core/io/image_io.h"

namespace talbot::gltf {

namespace {

using Json = nlohmann::json;

struct Chunks {
    std::string_view json;
    std::span<const uint8_t> binary;
    bool has_binary = false;
};

uint32_t little_endian(std::span<const uint8_t> bytes, size_t at) {
    return uint32_t{bytes[at]} | uint32_t{bytes[at + 1]} << 8 | uint32_t{bytes[at + 2]} << 16 |
           uint32_t{bytes[at + 3]} << 24;
}

constexpr uint32_t kJsonChunk = 0x4E4F534A;
constexpr uint32_t kBinaryChunk = 0x004E4942;

// The JSON chunk and the binary chunk, if any, of a .glb; chunks of other kinds are skipped.
Result<Chunks> split_glb(const Document& document) {
    const std::span<const uint8_t> bytes = document.bytes;
    if (bytes.size() < 20)
        return document.error("", "is a truncated .glb: it ends within the header");
    const uint32_t version = little_endian(bytes, 4);
    const uint32_t length = little_endian(bytes, 8);
    if (version != 2)
        return document.error(
            "", "is a .glb of version " + std::to_string(version) + "; only 2 is supported");
    if (length > bytes.size()) {
        return document.error("", "is a truncated .glb: its header declares " +
                                      std::to_string(length) + " bytes, the file has " +
                                      std::to_string(bytes.size()));
    }
    Chunks chunks;
    bool has_json = false;
    for (size_t at = 12; at + 8 <= length;) {
        const size_t size = little_endian(bytes, at);
        const uint32_t kind = little_endian(bytes, at + 4);
        if (size > length - at - 8)
            return document.error("", "is a broken .glb: a chunk runs over the end of the file");
        const std::span<const uint8_t> body = bytes.subspan(at + 8, size);
        if (kind == kJsonChunk && !has_json) {
            chunks.json = {reinterpret_cast<const char*>(body.data()), body.size()};
            has_json = true;
        } else if (kind == kBinaryChunk && !chunks.has_binary) {
            chunks.binary = body;
            chunks.has_binary = true;
        }
        at += 8 + size;
    }
    if (!has_json) return document.error("", "is a broken .glb: it has no JSON chunk");
    return chunks;
}

std::string one_line(std::string text) {
    while (!text.empty() && (text.back() == '\n' || text.back() == ' ')) text.pop_back();
    for (char& c : text) {
        if (c == '\n' || c == '\r') c = ' ';
    }
    return text.substr(0, 300);
}

Result<Json> parse_json(const Document& document, std::string_view text) {
    if (!json_depth_ok(text)) {
        return document.error(
            "", "its JSON is nested more than " + std::to_string(kMaxJsonDepth) + " levels deep");
    }
    try {
        return Json::parse(text);
    } catch (const Json::exception& problem) {
        return document.error("", "is not valid JSON: " + one_line(problem.what()));
    }
}

std::string string_member(const Json& object, const char* key) {
    const auto found = object.find(key);
    return found != object.end() && found->is_string() ? found->get<std::string>() : std::string();
}

void note_file(Document& document, const std::string& uri) {
    if (uri.empty() || is_data_uri(uri)) return;
    const Result<std::filesystem::path> path = resolve_uri(document.file.parent_path(), uri);
    if (path) document.other_files.push_back(*path);
}

// The bytes that a URI stands for, at least `length` of them.
Status read_uri(const Document& document, const std::string& element, const std::string& uri,
                uint64_t length, uint64_t max_bytes, BufferBytes& buffer) {
    if (is_data_uri(uri)) {
        std::optional<std::vector<uint8_t>> data = decode_data_uri(uri);
        if (!data) return document.error(element, "its data URI is malformed");
        buffer.owned = std::move(*data);
    } else {
        const Result<std::filesystem::path> path = resolve_uri(document.file.parent_path(), uri);
        if (!path) return document.error(element, path.error().what);
        Result<std::vector<uint8_t>> data = read_file(*path, max_bytes);
        if (!data) return document.error(element, data.error().line());
        buffer.owned = std::move(data.value());
    }
    if (buffer.owned.size() < length) {
        return document.error(element, "declares " + std::to_string(length) +
                                           " bytes, its data has " +
                                           std::to_string(buffer.owned.size()));
    }
    buffer.bytes = std::span<const uint8_t>(buffer.owned).first(length);
    return Done{};
}

// Buffers that are not needed stay empty.
Status read_buffers(Document& document, const Json& buffers, const std::vector<bool>& needed,
                    const Chunks& chunks, uint64_t max_bytes) {
    for (size_t i = 0; i < buffers.size(); ++i) {
        const std::string element = element_name("buffers", i);
        const auto length = buffers[i]["byteLength"].get<uint64_t>();
        const std::string uri = string_member(buffers[i], "uri");
        note_file(document, uri);
        BufferBytes buffer;
        if (!needed[i]) {
            document.buffers.push_back(std::move(buffer));
            continue;
        }
        if (uri.empty()) {
            if (i != 0 || !chunks.has_binary)
                return document.error(element, "has no uri and there is no binary chunk");
            if (length > chunks.binary.size()) {
                return document.error(element, "declares " + std::to_string(length) +
                                                   " bytes, the binary chunk has " +
                                                   std::to_string(chunks.binary.size()));
            }
            buffer.bytes = chunks.binary.first(length);
        } else if (Status read = read_uri(document, element, uri, length, max_bytes, buffer);
                   !read) {
            return read.error();
        }
        document.buffers.push_back(std::move(buffer));
    }
    return Done{};
}

Status note_images(Document& document, Json& images) {
    for (size_t i = 0; i < images.size(); ++i) {
        ImageSource source;
        source.name = string_member(images[i], "name");
        if (images[i].contains("uri") && images[i]["uri"].is_string()) {
            source.uri = std::move(images[i]["uri"].get_ref<std::string&>());
            note_file(document, source.uri);
        }
        if (images[i].contains("bufferView"))
            source.buffer_view = images[i]["bufferView"].get<uint32_t>();
        if (source.buffer_view.has_value() != source.uri.empty()) {
            return document.error(element_name("images", i), "needs either a uri or a bufferView");
        }
        document.images.push_back(std::move(source));
    }
    return Done{};
}

// Index accessors without a buffer view (sparse or compressed ones) are legal, but tinygltf refuses
// them: they are taken out before and put back after.
struct HiddenIndices {
    size_t mesh;
    size_t primitive;
    int accessor;
};

std::vector<HiddenIndices> hide_bare_indices(Json& root) {
    std::vector<HiddenIndices> hidden;
    if (!root.contains("meshes")) return hidden;
    for (size_t m = 0; m < root["meshes"].size(); ++m) {
        Json& primitives = root["meshes"][m]["primitives"];
        for (size_t p = 0; p < primitives.size(); ++p) {
            const auto indices = primitives[p].find("indices");
            if (indices == primitives[p].end()) continue;
            const auto accessor = indices->get<size_t>();
            if (root["accessors"][accessor].contains("bufferView")) continue;
            hidden.push_back({m, p, static_cast<int>(accessor)});
            primitives[p].erase(indices);
        }
    }
    return hidden;
}

Json take(Json& root, const char* key) {
    const auto found = root.find(key);
    if (found == root.end()) return Json::array();
    Json value = std::move(*found);
    root.erase(found);
    return value;
}

// Images that come from others, behind those of the file.
void add_roughness_images(Document& document, const std::vector<RoughnessImage>& images) {
    for (const RoughnessImage& image : images) {
        ImageSource source = document.images[image.source];
        source.glossiness = image.factor;
        document.images.push_back(std::move(source));
    }
}

Status parse_model(Document& document, Json& root) {
    const std::vector<HiddenIndices> hidden = hide_bare_indices(root);
    const std::string text = root.dump();
    if (text.size() > 0xFFFFFFFFull) return document.error("", "its JSON is longer than 4 GiB");
    tinygltf::TinyGLTF parser;
    std::string errors, warnings;
    bool parsed = false;
    try {
        parsed = parser.LoadASCIIFromString(&document.model, &errors, &warnings, text.data(),
                                            static_cast<unsigned>(text.size()), "");
    } catch (const std::exception& problem) {
        errors = problem.what();
    }
    if (!parsed) return document.error("", "is not valid glTF: " + one_line(errors));
    for (const HiddenIndices& entry : hidden) {
        document.model.meshes[entry.mesh].primitives[entry.primitive].indices = entry.accessor;
        root["meshes"][entry.mesh]["primitives"][entry.primitive]["indices"] =
            static_cast<uint64_t>(entry.accessor);
    }
    return Done{};
}

}  // namespace

std::string element_name(const char* array, size_t index) {
    return std::string(array) + "[" + std::to_string(index) + "]";
}

Status set_animation_time(Document& document, std::optional<double> seconds) {
    if (seconds == document.animation_time || !document.source) return Done{};
    Json root = *document.source;
    document.warnings.resize(document.lasting_warnings);
    if (seconds) {
        const Status applied = apply_animations(document, *seconds, root, document.warnings);
        if (!applied) return applied;
        if (Status shape = check_structure(root); !shape)
            return document.error(shape.error().element, shape.error().what);
    }
    root.erase("buffers");
    root.erase("images");
    std::vector<tinygltf::BufferView> views = std::move(document.model.bufferViews);
    document.model = {};
    if (Status parsed = parse_model(document, root); !parsed) return parsed;
    document.model.bufferViews = std::move(views);
    document.animation_time = seconds;
    return Done{};
}

Result<Document> read_document(const std::filesystem::path& file, uint64_t max_bytes) {
    Document document;
    document.file = file;
    Result<std::vector<uint8_t>> bytes = read_file(file, max_bytes);
    if (!bytes) return bytes.error();
    document.bytes = std::move(bytes.value());
    if (document.bytes.empty()) return document.error("", "is empty");

    Chunks chunks;
    if (document.bytes.size() >= 4 && std::memcmp(document.bytes.data(), "glTF", 4) == 0) {
        const Result<Chunks> split = split_glb(document);
        if (!split) return split.error();
        chunks = *split;
    } else {
        chunks.json = {reinterpret_cast<const char*>(document.bytes.data()), document.bytes.size()};
    }
    Result<Json> root = parse_json(document, chunks.json);
    if (!root) return root.error();
    if (Status shape = check_structure(*root); !shape)
        return document.error(shape.error().element, shape.error().what);
    note_wrong_values(*root, document.warnings);
    Result<std::vector<CompressedView>> compressed = find_compressed_views(*root);
    if (!compressed) return document.error(compressed.error().element, compressed.error().what);
    const std::vector<bool> needed = find_needed_buffers(*root, *compressed);
    const std::vector<RoughnessImage> roughness_images = convert_specular_glossiness(*root);
    const Json buffers = take(*root, "buffers");
    Json images = take(*root, "images");
    if (Status parsed = parse_model(document, *root); !parsed) return parsed.error();
    if (Status known = check_required(document.model.extensionsRequired); !known)
        return document.error(known.error().element, known.error().what);
    if (Status read = read_buffers(document, buffers, needed, chunks, max_bytes); !read)
        return read.error();
    if (Status decoded = decode_views(document, *compressed, max_bytes); !decoded)
        return decoded.error();
    if (Status noted = note_images(document, images); !noted) return noted.error();
    add_roughness_images(document, roughness_images);
    document.lasting_warnings = document.warnings.size();
    if (root->contains("animations")) {
        // Their counts are all that the check of the structure needs.
        (*root)["buffers"] = Json(buffers.size(), Json::object({{"byteLength", 0u}}));
        (*root)["images"] = Json(document.images.size(), Json::object());
        document.source = std::make_shared<const Json>(std::move(*root));
    }
    return document;
}

Result<std::span<const uint8_t>> view_bytes(const Document& document, size_t buffer_view) {
    const tinygltf::BufferView& view = document.model.bufferViews[buffer_view];
    const std::span<const uint8_t> buffer =
        document.buffers[static_cast<size_t>(view.buffer)].bytes;
    if (view.byteOffset > buffer.size() || view.byteLength > buffer.size() - view.byteOffset) {
        return document.error(element_name("bufferViews", buffer_view),
                              "reaches to byte " +
                                  std::to_string(view.byteOffset + view.byteLength) +
                                  " of a buffer of " + std::to_string(buffer.size()));
    }
    return buffer.subspan(view.byteOffset, view.byteLength);
}

}  // namespace talbot::gltf
