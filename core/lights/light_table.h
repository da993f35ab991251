// Everything that sends light, and how a shading point picks from it: emissive triangles and
// spheres, punctual lights and the environment. With LightSelection::tree those with a place are
// chosen by a light tree from kTreeLights lights on. Radiance in nits, densities per solid angle
// and including the probability of the choice.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/lights/environment_light.h"
#include "core/lights/light_sampling.h"
#include "core/lights/light_tree.h"
#include "core/lights/sun_disc.h"
#include "core/math/distribution.h"
#include "core/math/ray.h"
#include "core/scene/scene.h"

namespace talbot {

// Fewer lights are chosen by power alone: they would not repay the descent.
inline constexpr std::ptrdiff_t kTreeLights = 3;

enum class LightKind : uint8_t { triangle, quad, sphere, point, spot, directional };

struct Light {
    LightKind kind = LightKind::triangle;
    bool two_sided = false;
    // Spheres: an alpha mode lets the far side be seen through the near one.
    bool has_holes = false;
    // Of the triangle, and of a quad's other half: the corner from which its edges run.
    uint8_t first_corner[2] = {0, 0};
    uint32_t material = 0;
    PrimitiveId id{};       // of emissive surfaces; a quad is this triangle and the next one
    uint32_t punctual = 0;  // index of a punctual light
    // Triangle and quad (a parallelogram): corner and edges; punctual: position in p0, direction in
    // e1.
    Vec3f p0{0}, e1{0}, e2{0};
    Vec3f n{0};            // triangle and quad: front side
    uint32_t sun = kNoId;  // directional: its disc among suns()
    float area = 0;
    float slack = 0;   // of quads: how far their two halves lie off the parallelogram
    Rgb radiance{0};   // factor x strength, before textures; intensity of punctual lights
    double power = 0;  // estimated luminous power, for the choice
};

struct LightSample {
    Vec3f wi{0, 0, 1};  // towards the light, unit
    Rgb radiance{0};    // arriving, were nothing in the way
    float pdf = 0;      // solid angle x choice; the probability of the choice for delta lights
    bool delta = false;
    bool infinite = false;  // the shadow ray has no end
    Vec3f target{0};        // else it ends here, already moved off the light's surface
    PrimitiveId id{};       // the emitter, which cannot hide itself
};

class LightTable {
  public:
    LightTable() = default;
    // Reuses environment tables of `previous` where the image is the same.
    explicit LightTable(const Scene& scene, const LightTable* previous = nullptr,
                        const LightSampling& sampling = {});

    const LightSampling& sampling() const { return sampling_; }

    const std::vector<Light>& lights() const { return lights_; }
    const EnvironmentLight& environment() const { return environment_; }
    bool can_sample() const {
        return !choice_.is_empty() || !tree_.is_empty() || environment_.is_sampled();
    }

    // One light for a point p. u_choice picks it, or, while there is no tree, u.x does and u_choice
    // fills its low bits. n: the surface's unit normal on the side that is lit, zero where light
    // from both sides counts. Empty when the chosen light cannot send anything to p.
    std::optional<LightSample> sample(const Scene& scene, const Vec3f& p, const Vec3f& n,
                                      float u_choice, const Vec2f& u) const;

    // Density with which sample() at p gives the direction that hits `hit_point` on emitter `id`; 0
    // for surfaces that are not sampled.
    float pdf_surface(const Vec3f& p, const Vec3f& n, PrimitiveId id, const Vec3f& hit_point) const;
    // The same for the environment seen along d.
    float pdf_environment(const Vec3f& d) const;
    // Directional lights that are discs.
    std::span<const SunDisc> suns() const { return suns_; }

  private:
    void make_choice(const Scene& scene);
    void add_surface_lights(const Scene& scene);
    void add_punctual_lights(const Scene& scene);
    void choose_suns();
    std::optional<LightSample> sample_light(const Scene& scene, const Light& light, const Vec3f& p,
                                            const Vec2f& u) const;
    uint32_t light_of(PrimitiveId id) const;

    LightSampling sampling_;
    // Without a tree choice_ picks among all lights, beside one among those without a place.
    std::vector<Light> lights_;
    DiscreteDistribution choice_;  // with a tree: of lights without a place
    LightTree tree_;
    float tree_probability_ = 0;  // of the tree, unless the environment is chosen
    EnvironmentLight environment_;
    float environment_probability_ = 0;
    std::vector<uint32_t> first_triangle_of_instance_;  // kNoId where nothing is emitted
    std::vector<uint32_t> light_of_triangle_;           // of the instances that emit
    std::vector<uint32_t> light_of_sphere_;
    std::vector<SunDisc> suns_;
};

// Radiance that an emissive surface sends towards its front (or both sides), with its texture at
// uv, in a direction at that cosine >= 0 to its normal; black on the back. A clear coat keeps what
// its Fresnel reflects (KHR_materials_clearcoat), by the geometric normal here.
Rgb emitted_radiance(const Scene& scene, const Material& material, const Vec2f& uv0,
                     const Vec2f& uv1, bool front, float cos_theta);

// Chance that a surface with an alpha mode is there at uv: 0 or 1 for masks. vertex_alpha is that
// of the vertex colour.
float surface_coverage(const Scene& scene, const Material& material, const Vec2f& uv0,
                       const Vec2f& uv1, float vertex_alpha);

}  // namespace talbot
