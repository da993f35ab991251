#include "core/lights/light_table.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/lights/emission_map.h"
#include "core/lights/surface_light.h"
#include "core/math/robust.h"
#include "core/scene/compiled_effects.h"

namespace talbot {
namespace {

// Between two numbers of a sampler (unit_float).
constexpr float kUnitStep = 0x1p-24f;

// What a triangle of the mesh shows of its emissive texture.
double triangle_emission(const EmissionMap& emission, const TextureSlot& slot, const Mesh& mesh,
                         uint32_t triangle) {
    if (!slot.used()) return emission.mean();
    const std::vector<Vec2f>& uv = mesh.uv[slot.uv_set];
    Vec2f lower(kInfinity);
    Vec2f upper(-kInfinity);
    for (std::size_t corner = 0; corner < 3; ++corner) {
        const uint32_t vertex = mesh.indices[std::size_t{3} * triangle + corner];
        const Vec2f p = slot.apply(uv.empty() ? Vec2f(0) : uv[vertex]);
        if (!is_finite(p)) return emission.mean();
        lower = glm::min(lower, p);
        upper = glm::max(upper, p);
    }
    return emission.mean(lower, upper);
}

double punctual_power(const PunctualLight& light, double scene_radius) {
    const double intensity = light.intensity * static_cast<double>(luminance(light.color));
    switch (light.kind) {
        case PunctualKind::point:
            return 4 * std::numbers::pi * intensity;
        case PunctualKind::spot: {
            const double cosine = std::cos(0.5 * (light.inner_cone_angle + light.outer_cone_angle));
            return 2 * std::numbers::pi * (1 - cosine) * intensity;
        }
        case PunctualKind::directional:
            return std::numbers::pi * scene_radius * scene_radius * intensity;
    }
    return 0;
}

// Power is that relative to all lights; 0 for lights without a place.
LightBounds bounds_of(const Scene& scene, const Light& light, double power) {
    LightBounds b;
    b.power = static_cast<float>(power);
    b.lower = b.upper = light.p0;
    switch (light.kind) {
        case LightKind::quad:
            b.lower = glm::min(b.lower, light.p0 + light.e1 + light.e2);
            b.upper = glm::max(b.upper, light.p0 + light.e1 + light.e2);
            [[fallthrough]];
        case LightKind::triangle:
            b.lower = glm::min(b.lower, glm::min(light.p0 + light.e1, light.p0 + light.e2));
            b.upper = glm::max(b.upper, glm::max(light.p0 + light.e1, light.p0 + light.e2));
            b.axis = light.n;
            b.two_sided = light.two_sided;
            break;
        case LightKind::sphere:
            b.lower = light.p0 - Vec3f(light.e1.x);
            b.upper = light.p0 + Vec3f(light.e1.x);
            b.cos_theta_o = -1;
            break;
        case LightKind::point:
            b.cos_theta_o = -1;
            break;
        case LightKind::spot:
            b.axis = light.e1;
            b.cos_theta_e = std::cos(scene.punctual_lights()[light.punctual].outer_cone_angle);
            break;
        case LightKind::directional:
            b.power = 0;
            break;
    }
    return b;
}

}  // namespace

namespace {

Vec4f texel(const Scene& scene, const TextureSlot& slot, const Vec2f& uv0, const Vec2f& uv1,
            TextureEncoding encoding) {
    return eval_texture(scene.textures()[slot.texture], slot.apply(slot.uv_set == 0 ? uv0 : uv1),
                        encoding);
}

}  // namespace

Rgb emitted_radiance(const Scene& scene, const Material& material, const Vec2f& uv0,
                     const Vec2f& uv1, bool front, float cos_theta) {
    if (!front && !material.double_sided) return Rgb(0);
    Rgb radiance = material.emissive_factor * material.emissive_strength;
    if (kCompiledEffects.has(Effect::emissive_texture) && material.emissive_texture.used())
        radiance *= Rgb(texel(scene, material.emissive_texture, uv0, uv1, TextureEncoding::srgb));
    if (kCompiledEffects.has(Effect::clearcoat) && material.clearcoat_factor > 0) {
        float coat = material.clearcoat_factor;
        if (material.clearcoat_texture.used())
            coat *= texel(scene, material.clearcoat_texture, uv0, uv1, TextureEncoding::linear).x;
        constexpr float kF0 = 0.04f;
        const float m = 1 - std::min(cos_theta, 1.0f);
        radiance *= 1 - coat * (kF0 + (1 - kF0) * (m * m * m * m * m));
    }
    return radiance;
}

float surface_coverage(const Scene& scene, const Material& material, const Vec2f& uv0,
                       const Vec2f& uv1, float vertex_alpha) {
    if (material.alpha_mode == AlphaMode::opaque) return 1;
    float alpha = material.base_color_factor.w * vertex_alpha;
    if (kCompiledEffects.has(Effect::base_color_texture) && material.base_color_texture.used())
        alpha *= texel(scene, material.base_color_texture, uv0, uv1, TextureEncoding::srgb).w;
    if (material.alpha_mode == AlphaMode::mask) return alpha >= material.alpha_cutoff ? 1.0f : 0.0f;
    return clamp01(alpha);
}

LightTable::LightTable(const Scene& scene, const LightTable* previous,
                       const LightSampling& sampling)
    : sampling_(sampling),
      environment_(scene.environment(), previous ? &previous->environment_ : nullptr,
                   sampling.environment) {
    add_surface_lights(scene);
    add_punctual_lights(scene);
    make_choice(scene);
    const bool any = !choice_.is_empty() || !tree_.is_empty();
    if (environment_.is_sampled()) {
        environment_probability_ = any ? 0.5f : 1.0f;
        if (sampling_.selection == LightSelection::uniform)
            environment_probability_ = static_cast<float>(1 / (1 + choice_.total()));
    }
    choose_suns();
}

// Density with which sample() finds each of them.
void LightTable::choose_suns() {
    for (uint32_t i = 0; i < lights_.size(); ++i) {
        if (lights_[i].sun == kNoId) continue;
        SunDisc& sun = suns_[lights_[i].sun];
        sun.pdf = pdf_sun_disc(sun) * (1 - environment_probability_) * (1 - tree_probability_) *
                  choice_.probability(i);
    }
}

void LightTable::make_choice(const Scene& scene) {
    std::vector<double> powers;
    powers.reserve(lights_.size());
    const bool alike = sampling_.selection == LightSelection::uniform;
    for (const Light& light : lights_)
        powers.push_back(alike && light.power > 0 ? 1.0 : light.power);
    choice_ = DiscreteDistribution(powers);
    if (sampling_.selection != LightSelection::tree) return;
    const auto sends = [](double power) { return power > 0; };
    if (std::count_if(powers.begin(), powers.end(), sends) < kTreeLights) return;
    std::vector<LightBounds> bounds;
    bounds.reserve(lights_.size());
    double placed = 0;
    for (std::size_t i = 0; i < lights_.size(); ++i) {
        bounds.push_back(bounds_of(scene, lights_[i], powers[i] / choice_.total()));
        if (!(bounds.back().power > 0)) continue;
        placed += powers[i];
        powers[i] = 0;
    }
    const double total = choice_.total();
    tree_ = LightTree(bounds);
    choice_ = DiscreteDistribution(powers);
    if (tree_.is_empty()) return;
    // Neither may starve: the tree knows what is near, power does not.
    constexpr double kLeast = 0.25;
    tree_probability_ = choice_.is_empty()
                            ? 1.0f
                            : static_cast<float>(std::clamp(placed / total, kLeast, 1 - kLeast));
}

void LightTable::add_surface_lights(const Scene& scene) {
    const SceneGeometry& geometry = scene.geometry();
    std::vector<std::optional<EmissionMap>> emission(scene.materials().size());
    // Made for materials that something wears.
    const auto emission_of = [&](uint32_t index) -> const EmissionMap* {
        const Material& material = scene.materials()[index];
        if (!material.is_emissive() || material.unlit) return nullptr;
        if (!emission[index]) emission[index].emplace(material, scene.textures());
        return emission[index]->mean() > 0 ? &*emission[index] : nullptr;
    };
    first_triangle_of_instance_.assign(geometry.instances.size(), kNoId);
    for (uint32_t i = 0; i < geometry.instances.size(); ++i) {
        const SceneInstance& instance = geometry.instances[i];
        const EmissionMap* const map = emission_of(instance.material);
        if (!map) continue;
        const TextureSlot& slot = scene.materials()[instance.material].emissive_texture;
        const Mesh& mesh = geometry.meshes[instance.mesh];
        first_triangle_of_instance_[i] = static_cast<uint32_t>(light_of_triangle_.size());
        const uint64_t triangles = mesh.triangle_count();
        for (uint32_t t = 0; t < triangles; ++t) {
            const std::optional<Light> quad =
                t + 1 < triangles ? make_quad_light(scene, {i, t}) : std::nullopt;
            Light light = quad ? *quad : make_triangle_light(scene, {i, t});
            double mean = triangle_emission(*map, slot, mesh, t);
            if (quad) mean = 0.5 * (mean + triangle_emission(*map, slot, mesh, ++t));
            light.power = std::numbers::pi * light.area * mean * (light.two_sided ? 2 : 1);
            light_of_triangle_.insert(light_of_triangle_.end(), quad ? 2 : 1,
                                      static_cast<uint32_t>(lights_.size()));
            lights_.push_back(light);
        }
    }
    light_of_sphere_.assign(geometry.spheres.size(), kNoId);
    for (uint32_t i = 0; i < geometry.spheres.size(); ++i) {
        const EmissionMap* const map = emission_of(geometry.spheres[i].material);
        if (!map) continue;
        light_of_sphere_[i] = static_cast<uint32_t>(lights_.size());
        Light light = make_sphere_light(scene, i);
        light.power = std::numbers::pi * light.area * map->mean();
        lights_.push_back(light);
    }
}

void LightTable::add_punctual_lights(const Scene& scene) {
    const Bounds& bounds = scene.geometry().bounds;
    const double radius =
        bounds.is_empty() ? 1.0 : 0.5 * length(Vec3d(bounds.upper) - Vec3d(bounds.lower));
    for (uint32_t i = 0; i < scene.punctual_lights().size(); ++i) {
        const PunctualLight& source = scene.punctual_lights()[i];
        if (!source.shines()) continue;
        Light light;
        light.kind = source.kind == PunctualKind::point  ? LightKind::point
                     : source.kind == PunctualKind::spot ? LightKind::spot
                                                         : LightKind::directional;
        light.punctual = i;
        light.p0 = Vec3f(source.position - scene.origin());
        light.e1 = source.direction;
        light.radiance = source.color * source.intensity;
        light.power = punctual_power(source, radius);
        if (source.is_disc()) {
            light.sun = static_cast<uint32_t>(suns_.size());
            suns_.push_back(make_sun_disc(source));
        }
        lights_.push_back(light);
    }
}

std::optional<LightSample> LightTable::sample(const Scene& scene, const Vec3f& p, const Vec3f& n,
                                              float u_choice, const Vec2f& u_light) const {
    // Without a tree the first number of the point picks, too: a stretched part of a
    // low-discrepancy sequence is one, so that each of a few lights is sampled as evenly as one
    // alone. The bits that stretching moves up are filled with those of u_choice.
    Vec2f u = u_light;
    const bool joint = tree_.is_empty();
    const float u_spare = u_choice;
    if (joint) u_choice = u.x;
    const auto stretched = [u_spare](float rest, float part) {
        return std::min(rest + u_spare * (kUnitStep / part), kOneMinusEpsilon);
    };
    float probability = 1;
    if (kCompiledEffects.has(Effect::environment_image) && environment_probability_ > 0) {
        if (u_choice < environment_probability_) {
            if (joint)
                u.x = stretched(u_choice / environment_probability_, environment_probability_);
            const std::optional<EnvironmentSample> found = environment_.sample(u);
            if (!found || !(found->pdf > 0)) return std::nullopt;
            LightSample sample;
            sample.wi = found->wi;
            sample.radiance = found->radiance;
            sample.pdf = found->pdf * environment_probability_;
            sample.infinite = true;
            return sample;
        }
        probability = 1 - environment_probability_;
        u_choice = std::min((u_choice - environment_probability_) / probability, kOneMinusEpsilon);
    }
    uint32_t index = 0;
    if (u_choice < tree_probability_) {
        const float u_tree = std::min(u_choice / tree_probability_, kOneMinusEpsilon);
        const std::optional<LightTree::Pick> pick = tree_.sample(p, n, u_tree);
        if (!pick) return std::nullopt;
        index = pick->index;
        probability *= tree_probability_ * pick->probability;
    } else {
        if (choice_.is_empty()) return std::nullopt;
        if (tree_probability_ > 0) {
            probability *= 1 - tree_probability_;
            u_choice = std::min((u_choice - tree_probability_) / (1 - tree_probability_),
                                kOneMinusEpsilon);
        }
        if (lights_.size() > 1) {
            const DiscreteDistribution::Pick pick = choice_.sample(u_choice);
            index = pick.index;
            probability *= pick.probability;
            u_choice = pick.u;
        }
        if (joint) u.x = probability < 1 ? stretched(u_choice, probability) : u.x;
    }
    std::optional<LightSample> sample = sample_light(scene, lights_[index], p, u);
    if (sample) sample->pdf *= probability;
    return sample;
}

std::optional<LightSample> LightTable::sample_light(const Scene& scene, const Light& light,
                                                    const Vec3f& p, const Vec2f& u) const {
    if (kCompiledEffects.has(Effect::emissive_meshes)) {
        if (light.kind == LightKind::triangle) return sample_triangle_light(scene, light, p, u);
        if (light.kind == LightKind::quad) return sample_quad_light(scene, light, p, u);
        if (kCompiledEffects.has(Effect::analytic_spheres) && light.kind == LightKind::sphere)
            return sample_sphere_light(scene, light, p, u);
    }
    if (!kCompiledEffects.has(Effect::punctual_lights)) return std::nullopt;
    if (light.sun != kNoId) {
        const SunDisc& sun = suns_[light.sun];
        LightSample sample;
        sample.wi = sample_sun_disc(sun, u);
        sample.radiance = sun.radiance;
        sample.pdf = pdf_sun_disc(sun);
        sample.infinite = true;
        return sample;
    }
    return sample_punctual_light(scene.punctual_lights()[light.punctual], light, p);
}

uint32_t LightTable::light_of(PrimitiveId id) const {
    if (id.instance == kSphereInstance) return light_of_sphere_[id.primitive];
    const uint32_t first = first_triangle_of_instance_[id.instance];
    return first == kNoId ? kNoId : light_of_triangle_[first + id.primitive];
}

float LightTable::pdf_surface(const Vec3f& p, const Vec3f& n, PrimitiveId id,
                              const Vec3f& hit_point) const {
    const uint32_t index = light_of(id);
    if (index == kNoId) return 0;
    const Light& light = lights_[index];
    // Of spheres only the near side is drawn.
    if (light.has_holes && dot(hit_point - light.p0, p - hit_point) < 0) return 0;
    float probability = 1 - environment_probability_;
    if (tree_probability_ > 0) {
        // Surfaces have a place.
        probability *= tree_probability_ * tree_.probability(p, n, index);
        if (!(probability > 0)) return 0;
    } else if (lights_.size() > 1) {
        probability *= choice_.probability(index);
    }
    return probability * (light.kind == LightKind::sphere ? pdf_sphere_light(light, p)
                                                          : pdf_flat_light(light, p, hit_point));
}

float LightTable::pdf_environment(const Vec3f& d) const {
    if (!kCompiledEffects.has(Effect::environment_image)) return 0;
    return environment_probability_ > 0 ? environment_probability_ * environment_.pdf(d) : 0.0f;
}

}  // namespace talbot
