// Which glTF extensions the loader knows: one table, from which support, refusal and reports
// follow.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.h"
#include "core/scene/scene_desc.h"

namespace talbot::gltf {

enum class ExtensionSupport {
    supported,    // read in full
    ignorable,    // changes no pixel of a still picture: neither refused nor warned about
    unsupported,  // known, not read: refused when required, reported when used
};

struct ExtensionInfo {
    std::string_view name;
    ExtensionSupport support;
    std::string_view loss;  // what the picture lacks without it; empty when supported
};

std::span<const ExtensionInfo> extension_table();

// Null for a name that is not in the table.
const ExtensionInfo* find_extension(std::string_view name);

// Refuses the first required extension that is not supported, by name.
Status check_required(const std::vector<std::string>& required);

// Fills desc.extensions and desc.warnings.
void note_extensions(const std::vector<std::string>& used, const std::vector<std::string>& required,
                     SceneDesc& desc);

}  // namespace talbot::gltf
