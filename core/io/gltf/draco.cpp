// KHR_draco_mesh_compression, with the Draco library's mesh decoders. What a stream declares is
// compared with the file's accessors and the memory before it is believed.
#include "core/io/gltf/draco.h"

#include <draco/compression/mesh/mesh_edgebreaker_decoder.h>
#include <draco/compression/mesh/mesh_sequential_decoder.h>
#include <draco/core/varint_decoding.h>
#include <draco/mesh/mesh.h>
#include <draco/metadata/metadata_decoder.h>

#include <optional>

#include "core/io/gltf/values.h"

namespace talbot::gltf {

namespace {

constexpr const char* kExtension = "KHR_draco_mesh_compression";
constexpr uint16_t kBitstreamVersion = 0x0202;
constexpr uint8_t kSequential = 0;
constexpr uint8_t kEdgebreaker = 1;

// Real streams take over one bit a triangle; the entropy coder has no hard limit.
constexpr uint64_t kMaxFacesPerByte = 256;

// What the decoder holds per triangle and per point beside the attributes, by its data structures.
constexpr uint64_t kBytesPerFace = 128;
constexpr uint64_t kBytesPerPoint = 64;

struct Expected {
    std::optional<uint64_t> faces;
    uint64_t points = 0;
};

// A mesh decoder that stops once the connectivity and the kinds of attributes are known, when the
// points are not as many as expected or their attributes do not fit.
template <typename Decoder>
class GuardedDecoder : public Decoder {
  public:
    GuardedDecoder(uint64_t points, MemoryBudget& budget) : points_(points), budget_(budget) {}

    uint64_t declared_points() const { return declared_points_; }
    bool is_over_budget() const { return is_over_budget_; }

  protected:
    bool DecodeAllAttributes() override {
        const draco::PointCloud* cloud = this->point_cloud();
        declared_points_ = cloud->num_points();
        if (declared_points_ != points_) return false;
        uint64_t bytes = kBytesPerPoint;
        for (int32_t i = 0; i < cloud->num_attributes(); ++i) {
            // Once as stored, once more as the integers that prediction works on.
            const draco::PointAttribute* attribute = cloud->attribute(i);
            bytes += static_cast<uint64_t>(attribute->byte_stride()) +
                     4u * static_cast<uint64_t>(attribute->num_components());
        }
        is_over_budget_ = !budget_.reserve(points_ * bytes);
        return !is_over_budget_ && Decoder::DecodeAllAttributes();
    }

  private:
    uint64_t points_;
    MemoryBudget& budget_;
    uint64_t declared_points_ = 0;
    bool is_over_budget_ = false;
};

class DracoReader {
  public:
    DracoReader(const Document& document, const tinygltf::Primitive& primitive,
                const std::string& element, MemoryBudget& budget, uint64_t max_bytes)
        : document_(document),
          primitive_(primitive),
          element_(element + ".extensions." + kExtension),
          budget_(budget),
          max_bytes_(max_bytes) {}

    Result<DracoMesh> run() {
        const tinygltf::Value& extension = *find_extension_value(primitive_.extensions, kExtension);
        const std::optional<uint32_t> view = index_member(extension, "bufferView");
        if (!view || *view >= document_.model.bufferViews.size())
            return fail("its bufferView is missing or out of range: there are " +
                        std::to_string(document_.model.bufferViews.size()));
        const Result<std::span<const uint8_t>> bytes = view_bytes(document_, *view);
        if (!bytes) return bytes.error();
        const auto position = primitive_.attributes.find("POSITION");
        if (position == primitive_.attributes.end()) return fail("its primitive has no POSITION");
        if (primitive_.mode != TINYGLTF_MODE_TRIANGLES &&
            primitive_.mode != TINYGLTF_MODE_TRIANGLE_STRIP)
            return fail("its primitive must have the mode TRIANGLES or TRIANGLE_STRIP");
        expected_.points = accessor(position->second).count;
        if (primitive_.indices >= 0 && primitive_.mode == TINYGLTF_MODE_TRIANGLES)
            expected_.faces = accessor(primitive_.indices).count / 3;
        if (talbot::Status decoded = decode(*bytes); !decoded) return decoded.error();
        if (talbot::Status copied = copy_indices(); !copied) return copied.error();
        const tinygltf::Value* attributes = member(extension, "attributes");
        if (!attributes || !attributes->IsObject()) return fail("lacks attributes");
        for (const std::string& name : attributes->Keys()) {
            if (talbot::Status copied =
                    copy_attribute(name, index_member(*attributes, name.c_str()));
                !copied)
                return copied.error();
        }
        return std::move(out_);
    }

  private:
    Error fail(const std::string& what) const { return document_.error(element_, what); }

    const tinygltf::Accessor& accessor(int index) const {
        return document_.model.accessors[static_cast<size_t>(index)];
    }

    // The header, and the number of triangles that follows it in both methods' connectivity.
    talbot::Status check_header(std::span<const uint8_t> bytes, uint8_t& method) {
        draco::DecoderBuffer buffer;
        buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
        draco::DracoHeader header{};
        if (!draco::PointCloudDecoder::DecodeHeader(&buffer, &header).ok())
            return fail("is no Draco stream");
        const unsigned version = unsigned{header.version_major} << 8 | header.version_minor;
        if (version != kBitstreamVersion) {
            return fail("has the Draco bitstream version " + std::to_string(header.version_major) +
                        "." + std::to_string(header.version_minor) + "; only 2.2 is supported");
        }
        if (header.encoder_type != draco::TRIANGULAR_MESH ||
            (header.encoder_method != kSequential && header.encoder_method != kEdgebreaker))
            return fail("is a Draco stream, but not of triangles");
        buffer.set_bitstream_version(kBitstreamVersion);
        draco::GeometryMetadata metadata;
        if (header.flags & METADATA_FLAG_MASK &&
            !draco::MetadataDecoder().DecodeGeometryMetadata(&buffer, &metadata))
            return fail("its Draco stream is broken");
        method = header.encoder_method;
        uint8_t traversal = 0;
        uint32_t vertices = 0;
        uint32_t faces = 0;
        bool read = true;
        if (method == kEdgebreaker)
            read = buffer.Decode(&traversal) && draco::DecodeVarint(&vertices, &buffer);
        if (!read || !draco::DecodeVarint(&faces, &buffer))
            return fail("its Draco stream is broken");
        if (expected_.faces && faces != *expected_.faces) {
            return fail("its Draco stream has " + std::to_string(faces) +
                        " triangles, its accessor of indices " + std::to_string(*expected_.faces));
        }
        if (faces / kMaxFacesPerByte > bytes.size()) {
            return fail("declares " + std::to_string(faces) + " triangles, more than its " +
                        std::to_string(bytes.size()) + " compressed bytes can hold");
        }
        if (!budget_.reserve(faces * kBytesPerFace)) return over_budget(document_, max_bytes_);
        return Done{};
    }

    template <typename Decoder>
    talbot::Status decode_with(std::span<const uint8_t> bytes) {
        draco::DecoderBuffer buffer;
        buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
        GuardedDecoder<Decoder> decoder(expected_.points, budget_);
        const draco::DecoderOptions options;
        const bool decoded = decoder.Decode(options, &buffer, &mesh_).ok();
        if (decoder.is_over_budget()) return over_budget(document_, max_bytes_);
        if (decoder.declared_points() != 0 && decoder.declared_points() != expected_.points) {
            return fail("its Draco stream has " + std::to_string(decoder.declared_points()) +
                        " vertices, its accessor of POSITION " + std::to_string(expected_.points));
        }
        if (!decoded) return fail("its Draco stream is broken");
        return Done{};
    }

    talbot::Status decode(std::span<const uint8_t> bytes) {
        uint8_t method = 0;
        if (talbot::Status header = check_header(bytes, method); !header) return header;
        return method == kEdgebreaker ? decode_with<draco::MeshEdgebreakerDecoder>(bytes)
                                      : decode_with<draco::MeshSequentialDecoder>(bytes);
    }

    talbot::Status copy_indices() {
        out_.point_count = mesh_.num_points();
        out_.indices.reserve(size_t{mesh_.num_faces()} * 3);
        for (uint32_t f = 0; f < mesh_.num_faces(); ++f) {
            for (const draco::PointIndex& corner : mesh_.face(draco::FaceIndex(f))) {
                if (corner.value() >= out_.point_count) return fail("its Draco stream is broken");
                out_.indices.push_back(corner.value());
            }
        }
        return Done{};
    }

    template <typename T>
    bool copy_values(const draco::PointAttribute& in, DracoAttribute& out) const {
        const auto width = static_cast<int8_t>(in.num_components());
        const size_t size = sizeof(T) * static_cast<size_t>(width);
        out.bytes.resize(out_.point_count * size);
        std::vector<T> value(static_cast<size_t>(width));
        for (uint32_t p = 0; p < out_.point_count; ++p) {
            const draco::AttributeValueIndex index = in.mapped_index(draco::PointIndex(p));
            if (index.value() >= in.size() || !in.ConvertValue(index, width, value.data()))
                return false;
            std::memcpy(out.bytes.data() + p * size, value.data(), size);
        }
        out.view.data = out.bytes.data();
        out.view.stride = size;
        out.view.count = out_.point_count;
        out.view.components = static_cast<size_t>(width);
        return true;
    }

    bool copy_values(int component_type, const draco::PointAttribute& in,
                     DracoAttribute& out) const {
        out.view.component_type = component_type;
        switch (component_type) {
            case TINYGLTF_COMPONENT_TYPE_BYTE:
                return copy_values<int8_t>(in, out);
            case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
                return copy_values<uint8_t>(in, out);
            case TINYGLTF_COMPONENT_TYPE_SHORT:
                return copy_values<int16_t>(in, out);
            case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
                return copy_values<uint16_t>(in, out);
            case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
                return copy_values<uint32_t>(in, out);
            case TINYGLTF_COMPONENT_TYPE_FLOAT:
                return copy_values<float>(in, out);
            default:
                return false;
        }
    }

    // The type of the values is that of the attribute's accessor.
    talbot::Status copy_attribute(const std::string& name, std::optional<uint32_t> id) {
        const std::string shown = name.substr(0, 60);
        const auto found = primitive_.attributes.find(name);
        if (found == primitive_.attributes.end())
            return fail("attribute " + shown + " is not one of the primitive's");
        const draco::PointAttribute* attribute = id ? mesh_.GetAttributeByUniqueId(*id) : nullptr;
        if (!attribute) return fail("attribute " + shown + " is not in the Draco stream");
        const int width =
            tinygltf::GetNumComponentsInType(static_cast<uint32_t>(accessor(found->second).type));
        if (attribute->num_components() != width) {
            return fail(
                "attribute " + shown + " has " + std::to_string(attribute->num_components()) +
                " components in the Draco stream, " + std::to_string(width) + " in its accessor");
        }
        const int component_type = accessor(found->second).componentType;
        const uint64_t size = component_size(component_type) * static_cast<uint64_t>(width);
        if (!budget_.reserve(size * out_.point_count)) return over_budget(document_, max_bytes_);
        DracoAttribute copy;
        copy.view.normalized = accessor(found->second).normalized;
        if (!copy_values(component_type, *attribute, copy))
            return fail("attribute " + shown + " cannot be read as its accessor's type");
        out_.attributes.emplace(name, std::move(copy));
        return Done{};
    }

    const Document& document_;
    const tinygltf::Primitive& primitive_;
    std::string element_;
    MemoryBudget& budget_;
    uint64_t max_bytes_;
    Expected expected_;
    draco::Mesh mesh_;
    DracoMesh out_;
};

}  // namespace

bool is_draco(const tinygltf::Primitive& primitive) {
    return find_extension_value(primitive.extensions, kExtension) != nullptr;
}

Result<DracoMesh> decode_draco(const Document& document, const tinygltf::Primitive& primitive,
                               const std::string& element, MemoryBudget& budget,
                               uint64_t max_bytes) {
    return DracoReader(document, primitive, element, budget, max_bytes).run();
}

}  // namespace talbot::gltf
