// What of a material cannot be seen: textures that are the same everywhere become factors, flat
// normal maps, textures under a zero factor and identity transforms go. Every step is exact to the
// last bit, so the folded material gives the same image.
#pragma once

#include <vector>

#include "core/scene/effects.h"
#include "core/scene/scene.h"

namespace talbot {

// The scene's materials, folded but for what belongs to the effects of `keep`; empty where nothing
// changes.
std::vector<Material> fold_materials(const Scene& scene, EffectSet keep = {});

// The same scene with its materials folded; itself where nothing changes.
std::shared_ptr<const Scene> fold_scene(std::shared_ptr<const Scene> scene, EffectSet keep = {});

// Whether the alpha of an instance (or of a sphere, with no mesh) has to be asked at hits. With
// `exact` off also where its texels say that it need not be.
bool asks_alpha(const Scene& scene, const Material& material, const Mesh* mesh,
                const MeshAlpha* alpha, bool exact = true);

}  // namespace talbot
