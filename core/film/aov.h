// Arbitrary output variables: what else than the beauty image is known of a pixel. One table drives
// the panel, the command line and the layers of EXR files.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "core/film/film.h"
#include "core/film/image.h"

namespace talbot {

enum class Aov : uint8_t {
    beauty,
    albedo,
    shading_normal,
    geometric_normal,
    depth,
    position,
    uv,
    material_id,
    object_id,
    direct,
    indirect,
    emission,
    samples,
    block_error,
    time,
    bounces,
    traversal_steps,
    bvh_depth,
    bvh_leaf,
};

// Where the values come from.
enum class AovSource : uint8_t {
    first_hit,  // of camera rays
    path,       // of whole paths, traced again
    film,       // of what was rendered
};

// How the values are looked at.
enum class AovLook : uint8_t { radiance, color, direction, place, id, scalar };

struct AovInfo {
    Aov aov;
    std::string_view name;   // command line, EXR layer
    std::string_view label;  // panel
    std::string_view unit;
    uint32_t channels;  // 1 or 3
    AovSource source;
    AovLook look;
    bool averaged;  // over samples; else of a pixel's first sample
    std::string_view note;
};
inline constexpr std::array<AovInfo, 19> kAovs{{
    {Aov::beauty, "beauty", "Beauty", "nt", 3, AovSource::film, AovLook::radiance, true,
     "The image itself."},
    {Aov::albedo, "albedo", "Albedo", "", 3, AovSource::first_hit, AovLook::color, true,
     "Base colour at the first hit, textures and vertex colours included."},
    {Aov::shading_normal, "shading_normal", "Shading normal", "", 3, AovSource::first_hit,
     AovLook::direction, true, "World space, towards the camera, normal map included."},
    {Aov::geometric_normal, "geometric_normal", "Geometric normal", "", 3, AovSource::first_hit,
     AovLook::direction, true, "World space, towards the camera."},
    {Aov::depth, "depth", "Depth", "m", 1, AovSource::first_hit, AovLook::scalar, false,
     "Distance along the camera's ray; infinite where nothing is hit."},
    {Aov::position, "position", "Position", "m", 3, AovSource::first_hit, AovLook::place, false,
     "World space; 0 where nothing is hit."},
    {Aov::uv, "uv", "UV", "", 3, AovSource::first_hit, AovLook::place, false,
     "TEXCOORD of the first set; 0 where there is none."},
    {Aov::material_id, "material_id", "Material id", "", 1, AovSource::first_hit, AovLook::id,
     false, "0 is glTF's default material, i + 1 the file's material i; -1 where nothing is hit."},
    {Aov::object_id, "object_id", "Object id", "", 1, AovSource::first_hit, AovLook::id, false,
     "-1 where nothing is hit."},
    {Aov::direct, "direct", "Direct light", "nt", 3, AovSource::path, AovLook::radiance, true,
     "Light that was scattered once on its way from a light to the camera."},
    {Aov::indirect, "indirect", "Indirect light", "nt", 3, AovSource::path, AovLook::radiance, true,
     "Light that was scattered twice or more."},
    {Aov::emission, "emission", "Emission", "nt", 3, AovSource::path, AovLook::radiance, true,
     "Lights and environment as the camera sees them. Emission, direct and indirect light add up "
     "to the image."},
    {Aov::samples, "samples", "Samples", "", 1, AovSource::film, AovLook::scalar, true,
     "Of the pixel, so far."},
    {Aov::block_error, "block_error", "Block error", "%", 1, AovSource::film, AovLook::scalar, true,
     "Estimated relative RMS error of 8 x 8 pixels, as of the last power of two of samples."},
    {Aov::time, "time", "Time", "us", 1, AovSource::path, AovLook::scalar, true,
     "Microseconds a sample; not reproducible."},
    {Aov::bounces, "bounces", "Bounces", "", 1, AovSource::path, AovLook::scalar, true,
     "Surfaces that a path meets."},
    {Aov::traversal_steps, "traversal_steps", "Traversal steps", "", 1, AovSource::first_hit,
     AovLook::scalar, true, "Nodes of the acceleration structure that a camera ray visits."},
    {Aov::bvh_depth, "bvh_depth", "BVH depth", "", 1, AovSource::first_hit, AovLook::scalar, false,
     "Level of the acceleration structure's leaf that holds the first hit; -1 where nothing is "
     "hit."},
    {Aov::bvh_leaf, "bvh_leaf", "BVH leaves", "", 1, AovSource::first_hit, AovLook::id, false,
     "The acceleration structure's leaf that holds the first hit, as an id; -1 where nothing is "
     "hit."},
}};
constexpr const AovInfo& aov_info(Aov aov) {
    return kAovs[static_cast<std::size_t>(aov)];
}
std::optional<Aov> aov_from_name(std::string_view name);

// Values of one variable, one Rgb a pixel (scalars three times). What is not finite stays so.
struct AovImage {
    Aov aov = Aov::beauty;
    uint32_t samples = 0;  // a pixel, that were averaged
    ImageRgba image;
    // Range of the finite values, without the outermost 1 % of scalars on either side.
    Rgb lower{0};
    Rgb upper{1};
};

// Sets the range.
void find_range(AovImage& image);

// The layer of an EXR file.
ImageLayer aov_layer(const AovImage& image);

// Those of AovSource::film. Block errors are row by row, 8 x 8 pixels each; empty before there are
// any.
AovImage film_aov(Aov aov, const Film& film, const std::vector<float>& block_errors);

}  // namespace talbot
