// The attributes of a primitive, from accessors or from its compressed stream.
#pragma once

#include <optional>
#include <string>

#include "core/io/gltf/accessor.h"
#include "core/io/gltf/draco.h"

namespace talbot::gltf {

class AttributeSource {
  public:
    AttributeSource(const Document& document, const tinygltf::Primitive& primitive,
                    std::string element)
        : document_(document), primitive_(primitive), element_(std::move(element)) {}

    // Decodes the compressed stream, if there is one.
    Status decompress(MemoryBudget& budget, uint64_t max_bytes);

    // What the stream holds; null for a plain primitive.
    DracoMesh* draco() { return draco_ ? &*draco_ : nullptr; }

    bool has(const std::string& name) const;

    // An attribute that is there.
    Result<AccessorView> open(const std::string& name) const;

    // With `count` elements of width_min..width_max components; the error names the attribute.
    Result<AccessorView> open(const std::string& name, size_t count, size_t width_min,
                              size_t width_max) const;

    // The same for an attribute of a morph target, which is always a plain accessor.
    Result<AccessorView> open_target(size_t target, const std::string& name, size_t count,
                                     size_t width) const;

    const Document& document() const { return document_; }
    const tinygltf::Primitive& primitive() const { return primitive_; }
    Error fail(const std::string& what) const { return document_.error(element_, what); }

  private:
    Result<AccessorView> checked(const Result<AccessorView>& view, const std::string& name,
                                 size_t count, size_t width_min, size_t width_max) const;

    const Document& document_;
    const tinygltf::Primitive& primitive_;
    std::string element_;
    std::optional<DracoMesh> draco_;
};

}  // namespace talbot::gltf
