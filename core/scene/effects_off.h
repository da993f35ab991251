// A scene without some of its effects: another scene, with factors, lights or geometry taken away.
// The kernels know nothing of it.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "core/scene/effects.h"
#include "core/scene/scene.h"

namespace talbot {

// Reads "auto", "all", names and -names with commas between, from left to right: `on` gets what is
// forced on, `off` what is forced off. Returns the first word that is none of these.
std::optional<std::string> parse_effect_list(std::string_view text, EffectSet& on, EffectSet& off);

// Names with commas between.
std::string effect_names(EffectSet effects);

// What an effect leaves behind when it is off, in the words of the documentation.
std::string_view without_effect_text(Effect effect);

// Geometry without what belongs to vertex colours, analytic spheres and instancing; itself where
// `off` has none of them. Builds a structure where things go.
std::shared_ptr<const SceneGeometry> geometry_without(std::shared_ptr<const SceneGeometry> geometry,
                                                      EffectSet off, WorkerPool& pool);

// The scene without the effects, on a geometry made by geometry_without().
std::shared_ptr<const Scene> scene_without(const std::shared_ptr<const Scene>& scene, EffectSet off,
                                           std::shared_ptr<const SceneGeometry> geometry);

Camera camera_without(Camera camera, EffectSet off);

}  // namespace talbot
