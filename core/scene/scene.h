// The scene that is rendered: immutable tables addressed by index. Heavy tables are shared between
// a scene and its edited copies. Geometry is re-centred: float coordinates are world coordinates
// minus origin().
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <stop_token>
#include <vector>

#include "core/base/worker_pool.h"
#include "core/geometry/accel.h"
#include "core/scene/alpha_ranges.h"
#include "core/scene/motion.h"
#include "core/scene/scene_desc.h"

namespace talbot {

// One placed mesh as the intersector names it (Hit.id.instance).
struct SceneInstance {
    uint32_t mesh = 0;
    uint32_t object = 0;
    bool identity = true;            // then the mesh is stored in re-centred world coordinates
    bool mirrored = false;           // negative determinant: the winding's normal is flipped
    Mat4d world_from_object{1.0};    // re-centred
    Mat3f linear{1.0f};              // its linear part
    Mat3f normal_from_object{1.0f};  // cofactor matrix, for normals
    uint32_t material = 0;
};

// Geometry tables that edits never touch.
struct SceneGeometry {
    std::vector<Mesh> meshes;  // baked to re-centred world where used once
    std::vector<SceneInstance> instances;
    std::vector<Sphere> spheres;  // centres re-centred
    std::vector<Object> objects;
    Vec3d origin{0};
    Bounds bounds;  // re-centred; empty when there is nothing
    std::shared_ptr<const Accel> accel;
};

// From so many triangles in one place on a warning says so: a ray there tests them all.
inline constexpr uint64_t kCrowdWorthSaying = 256;

// What the intersector is built from; spans point into the geometry.
AccelInput accel_input(const SceneGeometry& geometry, BuildQuality quality);

class Scene;

struct SceneBuildOptions {
    bool brute_force = false;  // no acceleration structure
    BuildQuality quality = BuildQuality::high;
    // Another moment of the same file: its acceleration structure is refitted where that serves.
    std::shared_ptr<const Scene> previous;
    std::stop_token stop;
    std::function<void(float)> progress;
};

class Scene {
  public:
    // Takes the loader's tables. Null only when stop was requested.
    static std::shared_ptr<const Scene> build(SceneDesc desc, WorkerPool& pool,
                                              const SceneBuildOptions& options = {});

    const SceneGeometry& geometry() const { return *geometry_; }
    const Accel& accel() const { return *geometry_->accel; }
    const std::shared_ptr<const SceneGeometry>& shared_geometry() const { return geometry_; }
    std::span<const Texture> textures() const { return *textures_; }
    // Over the whole image of a texture.
    const TexelRange& texel_range(uint32_t texture) const { return texel_facts_->ranges[texture]; }
    // Alpha per triangle of a mesh, where its texture's alpha varies and nothing but the material's
    // factor comes on top; else null.
    const MeshAlpha* mesh_alpha(uint32_t mesh) const {
        return mesh < texel_facts_->alpha.size() ? texel_facts_->alpha[mesh].get() : nullptr;
    }
    const std::vector<Material>& materials() const { return materials_; }
    const std::vector<PunctualLight>& punctual_lights() const { return lights_; }
    const std::vector<Camera>& cameras() const { return cameras_; }
    const Environment& environment() const { return environment_; }
    // Null where nothing moves while the shutter is open.
    const std::shared_ptr<const SceneMotion>& motion() const { return motion_; }
    const std::vector<Object>& objects() const { return geometry_->objects; }
    const Vec3d& origin() const { return geometry_->origin; }

    const std::string& file() const { return about_->file; }
    const std::string& name() const { return about_->name; }
    const std::string& sha256() const { return about_->sha256; }
    const std::string& reading() const { return about_->reading; }
    const std::vector<ExtensionUse>& extensions() const { return about_->extensions; }
    const std::vector<std::string>& warnings() const { return about_->warnings; }

    uint32_t material_of(PrimitiveId id) const {
        return id.instance == kSphereInstance ? geometry_->spheres[id.primitive].material
                                              : geometry_->instances[id.instance].material;
    }
    uint32_t object_of(PrimitiveId id) const {
        return id.instance == kSphereInstance ? geometry_->spheres[id.primitive].object
                                              : geometry_->instances[id.instance].object;
    }

    // World-space bounds of everything or of one object; empty bounds give a unit box round the
    // origin.
    void world_bounds(Vec3d& lower, Vec3d& upper) const;
    void object_bounds(uint32_t object, Vec3d& lower, Vec3d& upper) const;

    // Edited copies that share all heavy tables. A change that alters which instances are filtered
    // (alpha mode, sidedness) is answered from the material at hit time, so no rebuild is needed.
    std::shared_ptr<const Scene> with_material(uint32_t index, Material material) const;
    std::shared_ptr<const Scene> with_materials(std::vector<Material> materials) const;
    std::shared_ptr<const Scene> with_geometry(std::shared_ptr<const SceneGeometry> geometry) const;
    std::shared_ptr<const Scene> with_punctual_light(uint32_t index, PunctualLight light) const;
    std::shared_ptr<const Scene> with_environment(Environment environment) const;
    std::shared_ptr<const Scene> with_motion(std::shared_ptr<const SceneMotion> motion) const;

  private:
    struct TexelFacts {
        std::vector<TexelRange> ranges;                       // by texture
        std::vector<std::unique_ptr<const MeshAlpha>> alpha;  // by mesh
    };
    void measure_textures(WorkerPool& pool);

    struct About {
        std::string file, name, sha256, reading;
        std::vector<ExtensionUse> extensions;
        std::vector<std::string> warnings;
    };

    std::shared_ptr<const SceneGeometry> geometry_;
    std::shared_ptr<const std::vector<Texture>> textures_;
    std::shared_ptr<const TexelFacts> texel_facts_ = std::make_shared<const TexelFacts>();
    std::vector<Material> materials_;
    std::vector<PunctualLight> lights_;
    std::vector<Camera> cameras_;
    Environment environment_;
    std::shared_ptr<const SceneMotion> motion_;
    std::shared_ptr<const About> about_;
};

// A camera that frames the bounds from a three-quarter view (the default when a file has none).
Camera frame_bounds(const Vec3d& lower, const Vec3d& upper, double aspect);

}  // namespace talbot
