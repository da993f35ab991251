// The path tracer: the estimator of one sample, written once for every effect tier. Unidirectional,
// with next-event estimation and multiple importance sampling by the power heuristic (Veach 1997)
// and Russian roulette on the throughput.
//   Li    radiance along the camera ray, nits      beta  throughput so far
//   wo    unit, towards where the path came from   wi    unit, where it goes on
// Read trace_path and then meet_surface from top to bottom; everything else here is a step of them.
// kTier is what the kernel is compiled for, kSurface what the shading of one surface is.
#pragma once

#include "core/geometry/force_inline.h"
#include "core/integrate/medium_point.h"
#include "core/integrate/path_rays.h"
#include "core/integrate/path_state.h"
#include "core/integrate/roulette.h"
#include "core/integrate/sampler.h"
#include "core/integrate/tiers.h"
#include "core/scattering/bsdf.h"
#include "core/scattering/dispersion.h"
#include "core/scattering/henyey_greenstein.h"

namespace talbot {

struct PathSample {
    Rgb Li{0};
    bool covered = false;  // the camera path met a surface
    uint32_t rays = 0;
};

// Steps that a replay writes down; a kernel's recorder does nothing and costs nothing. One that
// tampers changes values on their way, to prove that what is wrong with a sample is noticed.
struct NoRecorder {
    static constexpr bool kActive = false;
    static constexpr bool kTampers = false;
};

// Values of a path that a tampering recorder is shown.
enum class PathValue : uint8_t {
    environment,
    environment_pdf,
    emission,
    emission_pdf,
    transmittance,
    base_color,
    light,
    light_pdf,
    bsdf_value,
    bsdf_pdf,
    bsdf_weight,
    bsdf_sample_pdf,
};

template <typename Recorder, typename T>
void show_value(Recorder& recorder, PathValue what, T& value) {
    if constexpr (Recorder::kTampers) recorder.tamper(what, value);
}

template <EffectSet kTier>
inline constexpr bool kHasVolumes =
    kTier.has(Effect::transmission) || kTier.has(Effect::diffuse_transmission);

// Light of the environment that the ray escapes to.
template <EffectSet kTier, typename Recorder>
void add_environment(const RenderScene& rs, const PathSettings& settings, uint32_t bounce,
                     const Ray& ray, PathState& path, Recorder& recorder) {
    if constexpr (!kTier.has(Effect::environment)) return;
    const EnvironmentLight& environment = rs.lights().environment();
    if (environment.is_black() || (bounce == 0 && settings.transparent_background)) return;
    float weight = 1;
    if (!path.specular && settings.next_event_estimation) {
        float pdf = rs.lights().pdf_environment(ray.d);
        show_value(recorder, PathValue::environment_pdf, pdf);
        weight = power_heuristic(path.bsdf_pdf, pdf);
    }
    Rgb Le = environment.eval(ray.d);
    show_value(recorder, PathValue::environment, Le);
    path.Li += path.beta * weight * Le;
}

// Discs of directional lights that the ray escapes to.
template <EffectSet kTier>
void add_suns(const RenderScene& rs, const PathSettings& settings, uint32_t bounce, const Ray& ray,
              PathState& path) {
    if constexpr (!kTier.has(Effect::punctual_lights)) return;
    if (bounce == 0 && settings.transparent_background) return;
    for (const SunDisc& sun : rs.lights().suns()) {
        if (!sun.holds(ray.d)) continue;
        const bool also_sampled = !path.specular && settings.next_event_estimation;
        const float weight = also_sampled ? power_heuristic(path.bsdf_pdf, sun.pdf) : 1.0f;
        path.Li += path.beta * weight * sun.radiance;
    }
}

// Light that the surface itself sends back along the ray.
template <EffectSet kTier, typename Recorder>
void add_emission(const RenderScene& rs, const PathSettings& settings, const Ray& ray,
                  const Material& material, const SurfaceInteraction& si, PathState& path,
                  Recorder& recorder) {
    if constexpr (!kTier.has(Effect::emissive_meshes)) return;
    if (!rs.any_emissive() || !material.is_emissive()) return;
    const UvSets uv = uv_sets(si);
    Rgb Le = emitted_radiance(rs.scene(), material, uv.first, uv.second, si.front,
                              std::abs(dot(ray.d, si.n_geometric)));
    show_value(recorder, PathValue::emission, Le);
    if (is_black(Le)) return;
    float weight = 1;
    if (!path.specular && settings.next_event_estimation && si.id != path.from_id) {
        const Vec3f p = si.p;
        float pdf = rs.lights().pdf_surface(path.from, path.n_from, si.id, p);
        show_value(recorder, PathValue::emission_pdf, pdf);
        weight = power_heuristic(path.bsdf_pdf, pdf);
    }
    path.Li += path.beta * weight * Le;
}

// Next-event estimation: one light, one shadow ray. `crossing` is null where both sides of the
// surface lie in the same volume.
template <EffectSet kTier, EffectSet kSurface, typename Recorder>
void add_direct_light(const RenderScene& rs, const Sampler& sampler, uint32_t bounce,
                      const Bounce& numbers, const SurfaceInteraction& si, Vec3f n_lit,
                      const Bsdf<kSurface>& bsdf, const Crossing* crossing, PathState& path,
                      uint32_t& rays, Recorder& recorder) {
    std::optional<LightSample> light = rs.lights().sample(rs.scene(), si.lit_point(), n_lit,
                                                          numbers.light_choice(), numbers.light());
    if (!light) return;
    show_value(recorder, PathValue::light, light->radiance);
    show_value(recorder, PathValue::light_pdf, light->pdf);
    if (is_black(light->radiance)) return;
    // Rounding can leave a point just behind its own surface, whose light then comes from all
    // round.
    if (light->id == si.id) return;
    BsdfEval f = bsdf.eval(light->wi);
    show_value(recorder, PathValue::bsdf_value, f.f_cos);
    show_value(recorder, PathValue::bsdf_pdf, f.pdf);
    if (is_black(f.f_cos)) return;
    const Ray shadow =
        light->infinite ? si.spawn(light->wi) : si.spawn_to(light->target, light->id);
    ++rays;
    if (is_occluded<kTier>(rs, sampler, bounce, shadow)) return;
    const float weight = light->delta ? 1.0f : power_heuristic(light->pdf, f.pdf);
    Rgb sent = path.beta * f.f_cos * light->radiance;
    if constexpr (kHasVolumes<kTier>) {
        // A light inside a volume; from outside of all the boundary itself is in the way.
        if ((path.in_medium || crossing) && !light->infinite) [[unlikely]] {
            const bool crosses = crossing && (dot(light->wi, si.n_geometric) > 0) != si.front;
            const Rgb sigma = crosses
                                  ? medium_inside(crossing->after, rs.scene().materials()).sigma_t
                                  : path.medium.sigma_t;
            if (!is_black(sigma)) sent *= transmittance(sigma, length(light->target - si.p));
        }
    }
    path.Li += sent * (weight / light->pdf);
}

// Next-event estimation where the path scatters inside a medium.
template <EffectSet kTier>
void add_direct_light_in_medium(const RenderScene& rs, const Sampler& sampler, uint32_t bounce,
                                const Bounce& numbers, const Ray& ray, const Vec3f& p,
                                PathState& path, uint32_t& rays) {
    const std::optional<LightSample> light =
        rs.lights().sample(rs.scene(), p, Vec3f(0), numbers.light_choice(), numbers.light());
    // No light from outside of all comes in unbent.
    if (!light || light->infinite || is_black(light->radiance)) return;
    Ray shadow;
    shadow.o = p;
    shadow.d = light->target - p;
    shadow.t_max = 1;
    shadow.skip_to = light->id;
    ++rays;
    if (is_occluded<kTier>(rs, sampler, bounce, shadow)) return;
    const float phase = HenyeyGreenstein(path.medium.g).pdf(ray.d, light->wi);
    const float weight = light->delta ? 1.0f : power_heuristic(light->pdf, phase);
    const Rgb through = transmittance(path.medium.sigma_t, length(shadow.d));
    path.Li += path.beta * phase * light->radiance * through * (weight / light->pdf);
}

// Russian roulette with survival probability at most 1; false ends the path.
inline bool survives(float q, float u, PathState& path) {
    if (!(q < 1)) return true;
    if (u >= q) return false;
    path.beta /= q;
    return true;
}

inline float survival(const PathState& path) {
    return roulette_survival(max_component(path.beta) * path.eta_scale);
}

inline float walk_survival(uint32_t event) {
    constexpr float kLast = 0.99f;
    const auto n = static_cast<float>(event);
    return event > kEndlessWalk ? kLast : std::sqrt((n - 1) / n);
}

enum class MediumEvent { none, scattered, ended };

// A ray inside a scattering medium, up to its hit, if it is `found`: scatters on the way, and then
// `ray` is the one that goes on, or reaches its end.
template <EffectSet kTier>
MediumEvent cross_medium(const RenderScene& rs, const PathSettings& settings,
                         const Sampler& sampler, uint32_t bounce, bool found, const Hit& hit,
                         Ray& ray, PathState& path, uint32_t& rays) {
    const MediumSample sample = sample_medium(path.medium, path.beta, found ? hit.t : kInfinity,
                                              sampler.pair(medium_pair(bounce)));
    path.beta *= sample.weight;
    if (is_black(path.beta)) return MediumEvent::ended;
    if (!sample.scattered) return MediumEvent::none;
    const Bounce numbers = sampler.bounce(bounce);
    const Vec3f p = point_in_medium(rs.scene(), ray, sample.t, found, hit);
    if (settings.next_event_estimation && rs.lights().can_sample())
        add_direct_light_in_medium<kTier>(rs, sampler, bounce, numbers, ray, p, path, rays);
    const HenyeyGreenstein phase(path.medium.g);
    const Vec3f wi = phase.sample(ray.d, numbers.bsdf());
    path.bsdf_pdf = phase.pdf(ray.d, wi);
    if constexpr (has_cones(kTier)) {
        path.cone.advance(sample.t);
        path.cone.scatter(path.bsdf_pdf);
    }
    path.specular = false;
    path.specular_chain = false;
    path.from = p;
    path.n_from = Vec3f(0);
    path.from_id = {};
    float q = 1;
    if (settings.russian_roulette && bounce >= kRouletteStart) q = survival(path);
    if (++path.medium_events > kLongWalk) q = std::min(q, walk_survival(path.medium_events));
    if (!survives(q, numbers.roulette(), path)) return MediumEvent::ended;
    ray = Ray{};
    ray.o = p;
    ray.d = wi;
    return MediumEvent::scattered;
}

// The index at the path's wavelength, which is drawn here if the path has none yet.
inline void disperse(const Sampler& sampler, const Material& material, ShadingParams& params,
                     PathState& path) {
    if (path.wavelength == 0) {
        const WavelengthSample hero = sample_wavelength(sampler.single(Purpose::wavelength));
        path.wavelength = hero.nanometres;
        path.beta *= hero.weight;
    }
    params.ior = dispersed_ior(params.ior, material.dispersion, path.wavelength);
}

// Index of a volume against what lies around it; 0 stays 0, which means Fresnel 1 everywhere.
inline float relative_ior(float ior, const Material& around, float wavelength) {
    float other = around.ior;
    if (wavelength > 0 && around.dispersion > 0 && other > 1)
        other = dispersed_ior(other, around.dispersion, wavelength);
    return other > 0 ? ior / other : ior;
}

// A ray's hit on a surface: what it sends back, light that falls on it, and where the path goes on,
// as the new `ray`; false where it ends.
template <EffectSet kTier, EffectSet kSurface, typename Recorder>
TALBOT_FORCE_INLINE bool meet_surface(const RenderScene& rs, const PathSettings& settings,
                                      const Sampler& sampler, uint32_t bounce, const Hit& hit,
                                      Ray& ray, PathState& path, uint32_t& rays,
                                      Recorder& recorder) {
    // What is shaded with alike, with cones and without, is compiled once.
    constexpr EffectSet kShading = kSurface & kFullTier;
    SurfaceInteraction si = make_surface_interaction<kShading>(rs.scene(), ray, hit);
    const Material& material = rs.scene().materials()[si.material];
    if constexpr (has_cones(kTier)) path.cone.advance(hit.t);
    std::optional<Crossing> crossing;  // where it bounds a volume
    if constexpr (kHasVolumes<kTier>) {
        if (path.in_medium && !path.medium.scatters()) [[unlikely]] {
            Rgb left = transmittance(path.medium.sigma_t, hit.t);
            show_value(recorder, PathValue::transmittance, left);
            path.beta *= left;
        }
    }
    if constexpr (kHasVolumes<kSurface>) {
        if (material.is_volume()) {
            crossing = cross_boundary(path.media, rs.scene().materials(), si.material, si.front);
            if (!crossing->real) {
                // Light sampling does not see through: what lies behind is left to this path.
                path.enter(crossing->after, rs.scene().materials());
                path.specular = true;
                ++path.false_boundaries;
                ray = si.spawn(ray.d);
                return true;
            }
        }
    }
    if constexpr (kSurface.has(Effect::unlit)) {
        if (material.unlit) {
            // Seen as it is by the camera and in mirrors; it does not light other surfaces.
            if (path.specular_chain) {
                path.Li += path.beta * Rgb(eval_base_color<kShading>(
                                           rs.scene(), material, si,
                                           footprint_at<kSurface>(rs, si, ray.d, path.cone)));
            }
            if constexpr (Recorder::kActive) recorder.seen(bounce, path);
            return false;
        }
    }
    add_emission<kShading>(rs, settings, ray, material, si, path, recorder);
    if constexpr (Recorder::kActive) recorder.seen(bounce, path);
    uint32_t depth = bounce;
    if constexpr (kHasVolumes<kTier>) depth -= path.false_boundaries + path.medium_events;
    if (depth == settings.max_depth) return false;

    // The surface: everything below sees it from wo's side.
    const auto footprint = footprint_at<kSurface>(rs, si, ray.d, path.cone);
    apply_normal_map<kShading>(rs.scene(), material, si, footprint);
    ShadingParams params = eval_shading_params<kShading>(rs.scene(), material, si, footprint);
    show_value(recorder, PathValue::base_color, params.base_color);
    if constexpr (kSurface.has(Effect::dispersion)) {
        if (material.dispersion > 0 && material.ior > 1 && params.transmission > 0 &&
            params.metallic < 1 && !params.thin)
            disperse(sampler, material, params, path);
    }
    if constexpr (kHasVolumes<kSurface>) {
        if (crossing && crossing->other != kVacuum)
            params.ior =
                relative_ior(params.ior, rs.scene().materials()[crossing->other], path.wavelength);
    }
    const float side = si.front ? 1.0f : -1.0f;
    Frame frame = si.shading;
    if (!si.front) {
        frame.n = -frame.n;
        frame.t = -frame.t;
    }
    const bool lit_through = is_lit_through(params);
    if (lit_through) si.lift = Vec3f(0);
    const Vec3f n_surface = side * si.n_surface();
    const Bsdf<kShading> bsdf(params, frame, n_surface, -ray.d, si.front || params.thin);
    const Bounce numbers = sampler.bounce(bounce);
    const Vec3f n_lit = lit_through ? Vec3f(0) : n_surface;
    if (settings.next_event_estimation && bsdf.has_smooth_lobe() && rs.lights().can_sample()) {
        add_direct_light<kTier>(rs, sampler, bounce, numbers, si, n_lit, bsdf,
                                crossing ? &*crossing : nullptr, path, rays, recorder);
    }

    // Where the path goes on.
    float u_lobe = 0;
    if constexpr (kSurface.has(Effect::glossy) || kSurface.has(Effect::transmission)) {
        u_lobe = numbers.lobe();
    }
    std::optional<BsdfSample> scattered = bsdf.sample(u_lobe, numbers.bsdf());
    if constexpr (Recorder::kTampers) {
        if (scattered) {
            recorder.tamper(PathValue::bsdf_weight, scattered->weight);
            recorder.tamper(PathValue::bsdf_sample_pdf, scattered->pdf);
        }
    }
    if constexpr (Recorder::kActive) recorder.vertex(bounce, si, material, params, scattered, path);
    if (!scattered) return false;
    path.beta *= scattered->weight;
    if (is_black(path.beta)) return false;
    path.bsdf_pdf = scattered->pdf;
    path.specular = scattered->delta;
    if constexpr (has_cones(kTier)) {
        if (!scattered->delta) path.cone.scatter(scattered->pdf);
    }
    path.specular_chain = path.specular_chain && scattered->delta;
    path.from = si.lit_point();
    path.n_from = n_lit;
    path.from_id = si.id;
    if constexpr (kHasVolumes<kSurface>) {
        path.eta_scale *= scattered->eta * scattered->eta;
        if (crossing && scattered->transmitted && !params.thin)
            path.enter(crossing->after, rs.scene().materials());
    }

    if (settings.russian_roulette && bounce >= kRouletteStart) {
        if (!survives(survival(path), numbers.roulette(), path)) return false;
    }
    ray = si.spawn(scattered->wi);
    return true;
}

// The same, one function for each surface tier that a kernel has besides its own.
template <EffectSet kTier, EffectSet kSurface, typename Recorder>
[[gnu::noinline]] bool meet_surface_apart(const RenderScene& rs, const PathSettings& settings,
                                          const Sampler& sampler, uint32_t bounce, const Hit& hit,
                                          Ray& ray, PathState& path, uint32_t& rays,
                                          Recorder& recorder) {
    return meet_surface<kTier, kSurface>(rs, settings, sampler, bounce, hit, ray, path, rays,
                                         recorder);
}

// Shades with the code of the surface's tier, looked for from kFirst on.
template <EffectSet kTier, std::size_t kFirst, typename Recorder>
TALBOT_FORCE_INLINE bool meet_surface_of_tier(const RenderScene& rs, const PathSettings& settings,
                                              const Sampler& sampler, uint32_t bounce,
                                              const Hit& hit, Ray& ray, PathState& path,
                                              uint32_t& rays, Recorder& recorder) {
    constexpr EffectSet kSurface = surface_code(kTier, kFirst);
    if constexpr (kSurface == kTier) {
        // Only a kernel that has no other is one with its shading.
        if constexpr (kFirst == 0)
            return meet_surface<kTier, kTier>(rs, settings, sampler, bounce, hit, ray, path, rays,
                                              recorder);
    } else if (rs.surface_tier(hit.id) != kFirst) {
        return meet_surface_of_tier<kTier, kFirst + 1>(rs, settings, sampler, bounce, hit, ray,
                                                       path, rays, recorder);
    }
    return meet_surface_apart<kTier, kSurface>(rs, settings, sampler, bounce, hit, ray, path, rays,
                                               recorder);
}

// `entry`, unless null, is that of a beam which holds the camera ray.
template <EffectSet kTier, typename Recorder>
PathSample trace_path(const RenderScene& rs, const CameraRays& camera, const PathSettings& settings,
                      const CameraSample& start, const BeamEntry* entry, Recorder& recorder) {
    const Sampler& sampler = start.sampler;
    Ray ray = start.ray;
    PathSample result;
    PathState path;
    if constexpr (has_cones(kTier)) path.cone = camera.cone(ray).narrowed(kConeShare);

    for (uint32_t bounce = 0;; ++bounce) {
        Hit hit;
        ++result.rays;
        const bool found =
            intersect<kTier>(rs, sampler, bounce, ray, hit, bounce == 0 ? entry : nullptr);
        if constexpr (Recorder::kActive) recorder.ray(bounce, ray, found, hit, path);
        if constexpr (kTier.has(Effect::scattering_medium)) {
            if (path.in_medium && path.medium.scatters()) {
                const MediumEvent event = cross_medium<kTier>(rs, settings, sampler, bounce, found,
                                                              hit, ray, path, result.rays);
                if (event == MediumEvent::ended) break;
                if (event == MediumEvent::scattered) {
                    if constexpr (Recorder::kActive) recorder.in_medium(bounce, ray.o, path);
                    continue;
                }
            }
        }
        if (!found) {
            add_environment<kTier>(rs, settings, bounce, ray, path, recorder);
            add_suns<kTier>(rs, settings, bounce, ray, path);
            if constexpr (Recorder::kActive) recorder.seen(bounce, path);
            break;
        }
        result.covered = true;
        bool goes_on = false;
        if constexpr (Recorder::kActive || Recorder::kTampers) {
            goes_on = meet_surface<kTier, kTier>(rs, settings, sampler, bounce, hit, ray, path,
                                                 result.rays, recorder);
        } else {
            goes_on = meet_surface_of_tier<kTier, 0>(rs, settings, sampler, bounce, hit, ray, path,
                                                     result.rays, recorder);
        }
        if (!goes_on) break;
    }
    result.Li = path.Li;
    return result;
}

template <EffectSet kTier, typename Recorder>
PathSample trace_path(const RenderScene& rs, const CameraRays& camera, const PathSettings& settings,
                      uint32_t x, uint32_t y, uint64_t sample_index, Recorder& recorder) {
    return trace_path<kTier>(rs, camera, settings,
                             sample_camera<kTier>(camera, settings, x, y, sample_index), nullptr,
                             recorder);
}

}  // namespace talbot
