// What a loader produces and a Scene is made of: plain tables, in double where they place things in
// the world.
#pragma once

#include <string>
#include <vector>

#include "core/scene/camera.h"
#include "core/scene/environment.h"
#include "core/scene/material.h"
#include "core/scene/mesh.h"
#include "core/scene/punctual_light.h"
#include "core/scene/texture.h"

namespace talbot {

// How an extension named by the file fared.
struct ExtensionUse {
    std::string name;
    bool required = false;
    bool supported = false;
};

// A loader has checked every index, size and number in it (see io/gltf_loader.h); material 0 is
// glTF's default material.
struct SceneDesc {
    std::string file;
    std::string name;
    std::string sha256;  // of the main file's bytes, in hex
    std::string
        reading;  // scene, variant and moment that were chosen of the file, as words without blanks
    std::vector<Texture> textures;
    std::vector<Material> materials;
    std::vector<Mesh> meshes;
    std::vector<MeshInstance> instances;
    std::vector<Sphere> spheres;
    std::vector<Object> objects;
    std::vector<PunctualLight> lights;
    std::vector<Camera> cameras;
    Environment environment;
    std::vector<ExtensionUse> extensions;
    std::vector<std::string> warnings;  // one line each, said once
};

}  // namespace talbot
