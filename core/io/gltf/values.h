// Reading numbers and arrays out of tinygltf's untyped values (extensions and extras), with
// defaults and limits.
#pragma once

#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>
#include <string>

#include "core/io/gltf/model.h"
#include "core/math/robust.h"
#include "core/math/vec.h"

namespace talbot::gltf {

inline const tinygltf::Value* find_extension_value(const tinygltf::ExtensionMap& extensions,
                                                   const char* name) {
    const auto found = extensions.find(name);
    return found == extensions.end() || !found->second.IsObject() ? nullptr : &found->second;
}

// A member of an object; null when absent or when `value` is no object.
inline const tinygltf::Value* member(const tinygltf::Value& value, const char* key) {
    if (!value.IsObject() || !value.Has(key)) return nullptr;
    return &value.Get(key);
}

inline double number_member(const tinygltf::Value& value, const char* key, double fallback) {
    const tinygltf::Value* found = member(value, key);
    return found && found->IsNumber() ? found->GetNumberAsDouble() : fallback;
}

// A non-negative integer; empty when absent or anything else.
inline std::optional<uint32_t> index_member(const tinygltf::Value& value, const char* key) {
    const tinygltf::Value* found = member(value, key);
    if (!found || !found->IsInt() || found->GetNumberAsInt() < 0) return std::nullopt;
    return static_cast<uint32_t>(found->GetNumberAsInt());
}

// Exactly `count` numbers into out; false leaves it untouched.
inline bool numbers_member(const tinygltf::Value& value, const char* key, size_t count,
                           double* out) {
    const tinygltf::Value* found = member(value, key);
    if (!found || !found->IsArray() || found->ArrayLen() != count) return false;
    for (size_t i = 0; i < count; ++i) {
        if (!found->Get(static_cast<int>(i)).IsNumber()) return false;
    }
    for (size_t i = 0; i < count; ++i) out[i] = found->Get(static_cast<int>(i)).GetNumberAsDouble();
    return true;
}

// The coordinates that are drawn, in words.
inline std::string world_range() {
    char text[64];
    std::snprintf(text, sizeof text, "%g to %g m", -kMaxWorldCoordinate, kMaxWorldCoordinate);
    return text;
}

// A double as a float within [low, high].
inline float limited(double value, double low, double high) {
    return static_cast<float>(std::min(std::max(value, low), high));
}

// Any factor is kept under this, so that products of a few stay finite.
inline constexpr double kLargestFactor = 1e9;

inline Rgb color_of(const double* c, double high) {
    return Rgb(limited(c[0], 0, high), limited(c[1], 0, high), limited(c[2], 0, high));
}

}  // namespace talbot::gltf
