// tinygltf's own code, compiled here: Debian's Draco library exports a tinygltf of another version,
// which the linker might take in place of the tinygltf library's. What the program itself defines
// comes first.
#define TINYGLTF_IMPLEMENTATION
#define TINYGLTF_NO_INCLUDE_JSON

// clang-format off
#include <fstream>
#include <nlohmann/json.hpp>  // before tinygltf's code, which uses it

#include "core/io/gltf/model.h"
// clang-format on
