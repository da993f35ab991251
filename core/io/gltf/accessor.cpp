// Accessors: typed arrays over buffer views.
#include "core/io/gltf/accessor.h"

#include <algorithm>
#include <cstring>

namespace talbot::gltf {

namespace {

template <typename T>
T load(const uint8_t* bytes) {
    T value;
    std::memcpy(&value, bytes, sizeof(T));
    return value;
}

// Signed ones map -128 and -127 to -1 (glTF 2.0, section 3.6.2.2).
template <typename T, bool kNormalized>
float to_float(T value) {
    if constexpr (!kNormalized || std::is_same_v<T, float>) {
        return static_cast<float>(value);
    } else {
        const float scaled =
            static_cast<float>(value) / static_cast<float>(std::numeric_limits<T>::max());
        return scaled < -1 ? -1.0f : scaled;
    }
}

template <typename T, bool kNormalized>
void convert(const uint8_t* data, size_t stride, size_t count, size_t components, size_t width,
             float* out) {
    const size_t used = std::min(components, width);
    for (size_t i = 0; i < count; ++i) {
        const uint8_t* element = data + i * stride;
        for (size_t c = 0; c < used; ++c)
            out[i * width + c] = to_float<T, kNormalized>(load<T>(element + c * sizeof(T)));
    }
}

template <typename T>
void convert(bool normalized, const uint8_t* data, size_t stride, size_t count, size_t components,
             size_t width, float* out) {
    if (normalized) return convert<T, true>(data, stride, count, components, width, out);
    convert<T, false>(data, stride, count, components, width, out);
}

void convert_any(const AccessorView& view, const uint8_t* data, size_t stride, size_t count,
                 size_t width, float* out) {
    switch (view.component_type) {
        case TINYGLTF_COMPONENT_TYPE_BYTE:
            return convert<int8_t>(view.normalized, data, stride, count, view.components, width,
                                   out);
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
            return convert<uint8_t>(view.normalized, data, stride, count, view.components, width,
                                    out);
        case TINYGLTF_COMPONENT_TYPE_SHORT:
            return convert<int16_t>(view.normalized, data, stride, count, view.components, width,
                                    out);
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
            return convert<uint16_t>(view.normalized, data, stride, count, view.components, width,
                                     out);
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
            return convert<uint32_t>(view.normalized, data, stride, count, view.components, width,
                                     out);
        default:
            return convert<float>(false, data, stride, count, view.components, width, out);
    }
}

uint32_t load_index(const uint8_t* data, int type) {
    if (type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE) return *data;
    if (type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT) return load<uint16_t>(data);
    return load<uint32_t>(data);
}

bool is_index_type(int type) {
    return type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE ||
           type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ||
           type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
}

uint32_t sparse_index(const AccessorView& view, size_t i) {
    return load_index(view.sparse_indices + i * component_size(view.sparse_index_type),
                      view.sparse_index_type);
}

// `count` elements of `size` bytes, `stride` apart, from `offset` on, within `available` bytes.
bool fits(uint64_t offset, uint64_t stride, uint64_t size, uint64_t count, uint64_t available) {
    if (count == 0) return true;
    if (offset > available || size > available - offset) return false;
    return count - 1 <= (available - offset - size) / stride;
}

struct Bytes {
    const uint8_t* data = nullptr;
};

Result<Bytes> checked_bytes(const Document& document, const std::string& element, int buffer_view,
                            uint64_t offset, uint64_t stride, uint64_t size, uint64_t count) {
    const Result<std::span<const uint8_t>> bytes =
        view_bytes(document, static_cast<size_t>(buffer_view));
    if (!bytes) return bytes.error();
    if (!fits(offset, stride, size, count, bytes->size())) {
        return document.error(element, "needs " + std::to_string(count) + " elements of " +
                                           std::to_string(size) + " bytes from byte " +
                                           std::to_string(offset) + " on, but bufferViews[" +
                                           std::to_string(buffer_view) + "] has " +
                                           std::to_string(bytes->size()) + " bytes");
    }
    return Bytes{bytes->data() + std::min<uint64_t>(offset, bytes->size())};
}

Status open_sparse(const Document& document, const tinygltf::Accessor& accessor,
                   const std::string& element, AccessorView& view) {
    const std::string name = element + ".sparse";
    view.sparse_count = static_cast<size_t>(std::max(accessor.sparse.count, 0));
    view.sparse_index_type = accessor.sparse.indices.componentType;
    if (!is_index_type(view.sparse_index_type))
        return document.error(name + ".indices", "has no unsigned component type");
    const size_t index_size = component_size(view.sparse_index_type);
    const Result<Bytes> indices =
        checked_bytes(document, name + ".indices", accessor.sparse.indices.bufferView,
                      static_cast<uint64_t>(accessor.sparse.indices.byteOffset), index_size,
                      index_size, view.sparse_count);
    if (!indices) return indices.error();
    const size_t size = component_size(view.component_type) * view.components;
    const Result<Bytes> values = checked_bytes(
        document, name + ".values", accessor.sparse.values.bufferView,
        static_cast<uint64_t>(accessor.sparse.values.byteOffset), size, size, view.sparse_count);
    if (!values) return values.error();
    view.sparse_indices = indices->data;
    view.sparse_values = values->data;
    for (size_t i = 0; i < view.sparse_count; ++i) {
        if (sparse_index(view, i) >= view.count) {
            return document.error(name + ".indices", std::to_string(sparse_index(view, i)) +
                                                         " is out of range: there are " +
                                                         std::to_string(view.count) + " elements");
        }
    }
    return Done{};
}

}  // namespace

size_t component_size(int component_type) {
    switch (component_type) {
        case TINYGLTF_COMPONENT_TYPE_BYTE:
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
            return 1;
        case TINYGLTF_COMPONENT_TYPE_SHORT:
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
            return 2;
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
        case TINYGLTF_COMPONENT_TYPE_FLOAT:
            return 4;
        default:
            return 0;
    }
}

// Zeros cost a file nothing, so a small one could ask for any amount of memory: an accessor without
// a buffer view may be as long as the longest that has one.
size_t most_implicit_elements(const Document& document) {
    size_t most = size_t{1} << 16;
    for (const tinygltf::Accessor& accessor : document.model.accessors) {
        if (accessor.bufferView >= 0) most = std::max(most, accessor.count);
    }
    return most;
}

Result<AccessorView> open_accessor(const Document& document, int index) {
    const tinygltf::Accessor& accessor = document.model.accessors[static_cast<size_t>(index)];
    const std::string element = element_name("accessors", static_cast<size_t>(index));
    AccessorView view;
    view.component_type = accessor.componentType;
    view.count = accessor.count;
    view.normalized = accessor.normalized;
    const size_t component = component_size(accessor.componentType);
    if (component == 0) {
        return document.error(
            element,
            "its component type " + std::to_string(accessor.componentType) + " is not supported");
    }
    const int components = tinygltf::GetNumComponentsInType(static_cast<uint32_t>(accessor.type));
    const bool padded_matrix =
        (accessor.type == TINYGLTF_TYPE_MAT2 || accessor.type == TINYGLTF_TYPE_MAT3) &&
        component < 4;
    if (components <= 0 || padded_matrix)
        return document.error(element, "its type is not supported");
    view.components = static_cast<size_t>(components);
    const size_t size = component * view.components;
    view.stride = size;
    if (view.count == 0) return document.error(element, "has no elements");
    if (accessor.bufferView >= 0) {
        const size_t byte_stride =
            document.model.bufferViews[static_cast<size_t>(accessor.bufferView)].byteStride;
        if (byte_stride != 0) view.stride = byte_stride;
        if (view.stride < size)
            return document.error(element,
                                  "its elements are longer than the stride of its buffer view");
        const Result<Bytes> bytes =
            checked_bytes(document, element, accessor.bufferView, accessor.byteOffset, view.stride,
                          size, view.count);
        if (!bytes) return bytes.error();
        view.data = bytes->data;
    } else if (const size_t most = most_implicit_elements(document); view.count > most) {
        return document.error(element, "declares " + std::to_string(view.count) +
                                           " elements without a buffer view; at most " +
                                           std::to_string(most) + " zeros are made up");
    }
    if (accessor.sparse.isSparse) {
        if (Status sparse = open_sparse(document, accessor, element, view); !sparse)
            return sparse.error();
    }
    return view;
}

void read_floats(const AccessorView& view, size_t first, size_t count, size_t width, float* out) {
    if (view.data) {
        convert_any(view, view.data + first * view.stride, view.stride, count, width, out);
    } else {
        const size_t used = std::min(view.components, width);
        for (size_t i = 0; i < count; ++i) std::fill_n(out + i * width, used, 0.0f);
    }
    const size_t value_size = component_size(view.component_type) * view.components;
    for (size_t i = 0; i < view.sparse_count; ++i) {
        const size_t element = sparse_index(view, i);
        if (element < first || element - first >= count) continue;
        convert_any(view, view.sparse_values + i * value_size, value_size, 1, width,
                    out + (element - first) * width);
    }
}

void read_indices(const AccessorView& view, uint32_t* out) {
    if (!view.data) std::fill_n(out, view.count, 0u);
    for (size_t i = 0; view.data && i < view.count; ++i) {
        out[i] = load_index(view.data + i * view.stride, view.component_type);
    }
    const size_t value_size = component_size(view.component_type);
    for (size_t i = 0; i < view.sparse_count; ++i) {
        out[sparse_index(view, i)] =
            load_index(view.sparse_values + i * value_size, view.component_type);
    }
}

}  // namespace talbot::gltf
