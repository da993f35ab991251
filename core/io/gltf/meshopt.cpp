// EXT_meshopt_compression: what the JSON declares, what it may declare, and the decoding.
#include "core/io/gltf/meshopt.h"

#include <meshoptimizer.h>

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

namespace talbot::gltf {

namespace {

using Json = nlohmann::json;
using Mode = CompressedView::Mode;
using Filter = CompressedView::Filter;

constexpr const char* kExtension = "EXT_meshopt_compression";
constexpr uint64_t kMaxInteger = 1ull << 53;

// A block of 16 bytes of one channel takes two bits at least, so 64 is the best ratio of a stream
// of attributes; the tail of a stream is left out of the count.
constexpr uint64_t kMaxAttributeRatio = 64;

std::string element_of(size_t view) {
    return element_name("bufferViews", view) + ".extensions." + kExtension;
}

Error fail(size_t view, const std::string& what) {
    return {ErrorKind::bad_input, "", element_of(view), what};
}

// Null when the view is not compressed.
const Json* extension_of(const Json& object) {
    const auto extensions = object.find("extensions");
    if (extensions == object.end() || !extensions->is_object()) return nullptr;
    const auto found = extensions->find(kExtension);
    return found == extensions->end() || !found->is_object() ? nullptr : &*found;
}

// A non-negative integer member; empty when it is missing (and has no default) or anything else.
std::optional<uint64_t> integer(const Json& object, const char* key,
                                std::optional<uint64_t> fallback = std::nullopt) {
    const auto found = object.find(key);
    if (found == object.end()) return fallback;
    if (!found->is_number_unsigned() || found->get<uint64_t>() > kMaxInteger) return std::nullopt;
    return found->get<uint64_t>();
}

std::string text(const Json& object, const char* key, const char* fallback) {
    const auto found = object.find(key);
    if (found == object.end()) return fallback;
    return found->is_string() ? found->get<std::string>().substr(0, 40) : "not a string";
}

std::optional<Mode> mode_of(const std::string& name) {
    if (name == "ATTRIBUTES") return Mode::attributes;
    if (name == "TRIANGLES") return Mode::triangles;
    if (name == "INDICES") return Mode::indices;
    return std::nullopt;
}

std::optional<Filter> filter_of(const std::string& name) {
    if (name == "NONE") return Filter::none;
    if (name == "OCTAHEDRAL") return Filter::octahedral;
    if (name == "QUATERNION") return Filter::quaternion;
    if (name == "EXPONENTIAL") return Filter::exponential;
    return std::nullopt;
}

// Empty when mode, filter, stride and count go together, else what is wrong.
std::string mismatch(const CompressedView& view) {
    const uint64_t stride = view.stride;
    if (view.mode != Mode::attributes) {
        if (view.filter != Filter::none) return "only ATTRIBUTES may have a filter";
        if (stride != 2 && stride != 4) return "byteStride of indices must be 2 or 4";
        if (view.mode == Mode::triangles && view.count % 3 != 0)
            return "count of TRIANGLES must be a multiple of 3";
        return "";
    }
    if (stride == 0 || stride > 256 || stride % 4 != 0)
        return "byteStride of ATTRIBUTES must be a multiple of 4 up to 256";
    if (view.filter == Filter::octahedral && stride != 4 && stride != 8)
        return "byteStride under the OCTAHEDRAL filter must be 4 or 8";
    if (view.filter == Filter::quaternion && stride != 8)
        return "byteStride under the QUATERNION filter must be 8";
    return "";
}

Result<CompressedView> parse_view(const Json& root, size_t index, const Json& parent,
                                  const Json& extension) {
    CompressedView view;
    view.view = index;
    const auto buffer = integer(extension, "buffer");
    const auto offset = integer(extension, "byteOffset", 0);
    const auto length = integer(extension, "byteLength");
    const auto stride = integer(extension, "byteStride");
    const auto count = integer(extension, "count");
    if (!buffer || !offset || !length || !stride || !count) {
        return fail(index,
                    "buffer, byteOffset, byteLength, byteStride and count must be non-negative "
                    "integers");
    }
    const size_t buffers = root.contains("buffers") ? root["buffers"].size() : 0;
    if (*buffer >= buffers) {
        return fail(index, "its buffer " + std::to_string(*buffer) +
                               " is out of range: there are " + std::to_string(buffers) +
                               " buffers");
    }
    const std::string mode = text(extension, "mode", "missing");
    const std::string filter = text(extension, "filter", "NONE");
    if (!mode_of(mode)) return fail(index, "mode '" + mode + "' is unknown");
    if (!filter_of(filter)) return fail(index, "filter '" + filter + "' is unknown");
    view.buffer = static_cast<size_t>(*buffer);
    view.offset = *offset;
    view.length = *length;
    view.stride = *stride;
    view.count = *count;
    view.mode = *mode_of(mode);
    view.filter = *filter_of(filter);
    if (const std::string wrong = mismatch(view); !wrong.empty()) return fail(index, wrong);
    if (view.count > kMaxInteger / view.stride) {
        return fail(index, "its count is out of range: at most " +
                               std::to_string(kMaxInteger / view.stride));
    }
    if (const auto outer = integer(parent, "byteStride"); outer && *outer != view.stride) {
        return fail(index, "byteStride is " + std::to_string(view.stride) + ", but " +
                               std::to_string(*outer) + " in the buffer view");
    }
    if (parent["byteLength"].get<uint64_t>() > view.count * view.stride) {
        return fail(index, "the buffer view declares " + parent["byteLength"].dump() +
                               " bytes, the stream " + std::to_string(view.count * view.stride));
    }
    return view;
}

// Whether `length` compressed bytes can give what is declared, by the best ratio of the mode.
bool is_plausible(const CompressedView& view) {
    switch (view.mode) {
        case Mode::attributes:
            return view.count * view.stride / kMaxAttributeRatio <= view.length;
        case Mode::triangles:
            return view.count / 3 <= view.length;  // a byte a triangle
        case Mode::indices:
            return view.count <= view.length;  // a byte an index
    }
    return false;
}

bool decode(const CompressedView& view, std::span<const uint8_t> in, std::vector<uint8_t>& out) {
    out.resize(view.count * view.stride);
    switch (view.mode) {
        case Mode::attributes:
            if (meshopt_decodeVertexBuffer(out.data(), view.count, view.stride, in.data(),
                                           in.size()) != 0)
                return false;
            break;
        case Mode::triangles:
            return meshopt_decodeIndexBuffer(out.data(), view.count, view.stride, in.data(),
                                             in.size()) == 0;
        case Mode::indices:
            return meshopt_decodeIndexSequence(out.data(), view.count, view.stride, in.data(),
                                               in.size()) == 0;
    }
    switch (view.filter) {
        case Filter::none:
            break;
        case Filter::octahedral:
            meshopt_decodeFilterOct(out.data(), view.count, view.stride);
            break;
        case Filter::quaternion:
            meshopt_decodeFilterQuat(out.data(), view.count, view.stride);
            break;
        case Filter::exponential:
            meshopt_decodeFilterExp(out.data(), view.count, view.stride);
            break;
    }
    return true;
}

Status decode_view(Document& document, const CompressedView& view, uint64_t max_bytes) {
    const std::string element = element_of(view.view);
    const std::span<const uint8_t> source = document.buffers[view.buffer].bytes;
    if (view.offset > source.size() || view.length > source.size() - view.offset) {
        return document.error(element, "reaches to byte " +
                                           std::to_string(view.offset + view.length) +
                                           " of a buffer of " + std::to_string(source.size()));
    }
    const uint64_t size = view.count * view.stride;
    if (!is_plausible(view)) {
        return document.error(element, "declares " + std::to_string(size) +
                                           " bytes, more than its " + std::to_string(view.length) +
                                           " compressed bytes can hold");
    }
    if (size > max_bytes - document.decoded_bytes) {
        return document.error(element,
                              "would need more than " + std::to_string(max_bytes >> 20) +
                                  " MiB when decoded; it is refused to protect the memory");
    }
    document.decoded_bytes += size;
    BufferBytes decoded;
    if (!decode(view, source.subspan(view.offset, view.length), decoded.owned))
        return document.error(element, "its compressed stream is broken");
    decoded.bytes = decoded.owned;
    tinygltf::BufferView& target = document.model.bufferViews[view.view];
    target.buffer = static_cast<int>(document.buffers.size());
    target.byteOffset = 0;
    target.byteLength = decoded.owned.size();
    document.buffers.push_back(std::move(decoded));
    return Done{};
}

}  // namespace

Result<std::vector<CompressedView>> find_compressed_views(const Json& root) {
    std::vector<CompressedView> views;
    const auto all = root.find("bufferViews");
    if (all == root.end()) return views;
    for (size_t i = 0; i < all->size(); ++i) {
        const Json* extension = extension_of((*all)[i]);
        if (!extension) continue;
        Result<CompressedView> view = parse_view(root, i, (*all)[i], *extension);
        if (!view) return view.error();
        views.push_back(*view);
    }
    return views;
}

std::vector<bool> find_needed_buffers(const Json& root, const std::vector<CompressedView>& views) {
    const size_t count = root.contains("buffers") ? root["buffers"].size() : 0;
    std::vector<bool> needed(count, true);
    if (views.empty()) return needed;
    const Json& all = root["bufferViews"];
    for (const CompressedView& view : views) needed[all[view.view]["buffer"].get<size_t>()] = false;
    for (const CompressedView& view : views) needed[view.buffer] = true;
    for (const Json& view : all) {
        if (!extension_of(view)) needed[view["buffer"].get<size_t>()] = true;
    }
    return needed;
}

Status decode_views(Document& document, const std::vector<CompressedView>& views,
                    uint64_t max_bytes) {
    for (const CompressedView& view : views) {
        if (Status done = decode_view(document, view, max_bytes); !done) return done;
    }
    return Done{};
}

}  // namespace talbot::gltf
