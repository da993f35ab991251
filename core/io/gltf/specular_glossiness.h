// The archived KHR_materials_pbrSpecularGlossiness, rewritten as metallic-roughness with
// KHR_materials_specular and KHR_materials_ior.
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <vector>

namespace talbot::gltf {

// An image that holds roughness = 1 - factor * alpha of another in its green channel.
struct RoughnessImage {
    uint32_t source = 0;
    double factor = 1;
};

// Rewrites every such material of a document whose structure has been checked. An index of
// refraction of 0 makes the specular colour the reflectance at normal incidence, as the old model
// has it. The new images come behind those of the file, in this order; the textures over them are
// in the JSON.
std::vector<RoughnessImage> convert_specular_glossiness(nlohmann::json& root);

}  // namespace talbot::gltf
