// URIs of a glTF file: data URIs, percent-encoding, and which files a scene may name.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.h"

namespace talbot::gltf {

bool is_data_uri(std::string_view uri);

// The bytes of a data URI (base64 or percent-encoded); empty when it is malformed.
std::optional<std::vector<uint8_t>> decode_data_uri(std::string_view uri);

// "%20" to " "; a '%' that begins no code stays, and '+' is only a plus.
std::string percent_decode(std::string_view text);

// The file that a relative URI names. Refuses other schemes, absolute paths and paths that leave
// the folder; the error holds only `what`.
Result<std::filesystem::path> resolve_uri(const std::filesystem::path& folder,
                                          std::string_view uri);

}  // namespace talbot::gltf
