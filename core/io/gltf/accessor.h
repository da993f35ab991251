// Accessors: typed arrays over buffer views, with stride, normalised integers and sparse overrides
// (glTF 2.0, section 3.6.2).
#pragma once

#include <cstdint>
#include <vector>

#include "core/io/gltf/document.h"

namespace talbot::gltf {

// An accessor whose ranges have been checked: reading elements [0, count) stays within its bytes.
struct AccessorView {
    const uint8_t* data = nullptr;  // null: all zeros (sparse without a buffer view)
    size_t stride = 0;
    size_t count = 0;
    int component_type = 0;  // TINYGLTF_COMPONENT_TYPE_*
    size_t components = 1;
    bool normalized = false;

    size_t sparse_count = 0;
    const uint8_t* sparse_indices = nullptr;
    int sparse_index_type = 0;
    const uint8_t* sparse_values = nullptr;  // tightly packed
};

size_t component_size(int component_type);  // 0 for none of glTF's types

Result<AccessorView> open_accessor(const Document& document, int index);

// Elements [first, first + count) as floats, `width` of them each (missing components are left as
// they are, further ones are skipped). Integers become numbers, or -1..1 and 0..1 when normalised.
void read_floats(const AccessorView& view, size_t first, size_t count, size_t width, float* out);

// An unsigned integer scalar per element.
void read_indices(const AccessorView& view, uint32_t* out);

}  // namespace talbot::gltf
