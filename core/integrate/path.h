// The path tracer: the estimator of one sample, written once for every effect tier. Unidirectional,
// with next-event estimation and multiple importance sampling by the power heuristic (Veach 1997)
// and Russian roulette on the throughput.
//   Li    radiance along the camera ray, nits      beta  throughput so far
//   wo    unit, towards where the path came from   wi    unit, where it goes on
// Read trace_path from top to bottom; everything else here is a step of it.
#pragma once

#include "core/integrate/coverage.h"
#include "core/integrate/pixel_filter.h"
#include "core/integrate/sampler.h"
#include "core/scattering/bsdf.h"
#include "core/scattering/dispersion.h"

namespace talbot {

// The first vertex at which Russian roulette may end a path.
inline constexpr uint32_t kRouletteStart = 3;

struct PathSample {
    Rgb Li{0};
    bool covered = false;  // the camera path met a surface
    uint32_t rays = 0;
};

// Steps that a replay writes down; a kernel's recorder does nothing and costs nothing.
struct NoRecorder {
    static constexpr bool kActive = false;
};

// State of one path between two vertices.
struct PathState {
    Rgb beta{1};
    Rgb Li{0};
    float eta_scale = 1;  // undoes the radiance scaling of refraction for the roulette
    float bsdf_pdf = 0;   // density of the last scattering direction
    bool specular =
        true;  // the last event was the camera or a delta lobe: no other strategy finds its light
    bool specular_chain = true;  // nothing but delta events since the camera
    Vec3f from{0};               // the last vertex
    Vec3f n_from{0};             // its normal as light sampling was given it
    float wavelength = 0;        // nanometres; 0 until a dispersive surface is met
    Rgb sigma_a{0};              // absorption of the medium that the ray crosses
};

template <EffectSet kTier>
inline constexpr bool kHasAlpha = kTier.has(Effect::alpha_mask) || kTier.has(Effect::alpha_blend);

// Closest hit as this kind of ray sees the scene.
template <EffectSet kTier>
bool intersect(const RenderScene& rs, const Sampler& sampler, uint32_t bounce, const Ray& ray,
               Hit& hit) {
    const uint8_t asked =
        kHasAlpha<kTier> ? (kCoverageAlpha | kCoverageSingleSided) : kCoverageSingleSided;
    const uint8_t relevant =
        rs.any_coverage() & (bounce == 0 ? asked : static_cast<uint8_t>(asked & kCoverageAlpha));
    // Most hits need no question: the filter is asked of the nearest one, and traversal runs again
    // with it only where that one is no hit.
    if (!rs.scene().accel().closest(ray, hit)) return false;
    if ((rs.coverage_flags(hit.id) & relevant) == 0) return true;
    const CoverageContext context{&rs, sampler.coverage_seed(bounce, 0), bounce == 0};
    if (accept_coverage<kTier>(&context, ray, hit)) return true;
    hit = Hit{};
    return rs.scene().accel().closest(ray, hit, HitFilter{&accept_coverage<kTier>, &context});
}

template <EffectSet kTier>
bool is_occluded(const RenderScene& rs, const Sampler& sampler, uint32_t bounce, const Ray& ray) {
    if (!kHasAlpha<kTier> || (rs.any_coverage() & kCoverageAlpha) == 0)
        return rs.scene().accel().occluded(ray);
    const CoverageContext context{&rs, sampler.coverage_seed(bounce, 1), false};
    return rs.scene().accel().occluded(ray, HitFilter{&accept_coverage<kTier>, &context});
}

// Light of the environment that the ray escapes to.
inline void add_environment(const RenderScene& rs, const PathSettings& settings, uint32_t bounce,
                            const Ray& ray, PathState& path) {
    const EnvironmentLight& environment = rs.lights().environment();
    if (environment.is_black() || (bounce == 0 && settings.transparent_background)) return;
    float weight = 1;
    if (!path.specular && settings.next_event_estimation) {
        weight = power_heuristic(path.bsdf_pdf, rs.lights().pdf_environment(ray.d));
    }
    path.Li += path.beta * weight * environment.eval(ray.d);
}

// Light that the surface itself sends back along the ray.
inline void add_emission(const RenderScene& rs, const PathSettings& settings, const Ray& ray,
                         const Material& material, const SurfaceInteraction& si, PathState& path) {
    if (!material.is_emissive()) return;
    const Rgb Le = emitted_radiance(rs.scene(), material, si.uv[0], si.uv[1], si.front,
                                    std::abs(dot(ray.d, si.n_geometric)));
    if (is_black(Le)) return;
    float weight = 1;
    if (!path.specular && settings.next_event_estimation) {
        weight = power_heuristic(path.bsdf_pdf,
                                 rs.lights().pdf_surface(path.from, path.n_from, si.id, si.p));
    }
    path.Li += path.beta * weight * Le;
}

// Next-event estimation: one light, one shadow ray.
template <EffectSet kTier>
void add_direct_light(const RenderScene& rs, const Sampler& sampler, uint32_t bounce,
                      const Bounce& numbers, const SurfaceInteraction& si, const Vec3f& n_lit,
                      const Bsdf<kTier>& bsdf, PathState& path, uint32_t& rays) {
    const std::optional<LightSample> light = rs.lights().sample(
        rs.scene(), si.lit_point(), n_lit, numbers.light_choice(), numbers.light());
    if (!light || is_black(light->radiance)) return;
    const BsdfEval f = bsdf.eval(light->wi);
    if (is_black(f.f_cos)) return;
    const Ray shadow =
        light->infinite ? si.spawn(light->wi) : si.spawn_to(light->target, light->id);
    ++rays;
    if (is_occluded<kTier>(rs, sampler, bounce, shadow)) return;
    const float weight = light->delta ? 1.0f : power_heuristic(light->pdf, f.pdf);
    path.Li += path.beta * f.f_cos * light->radiance * (weight / light->pdf);
}

// The index at the path's wavelength, which is drawn here if the path has none yet.
inline void disperse(const Sampler& sampler, const Material& material, ShadingParams& params,
                     PathState& path) {
    if (path.wavelength == 0) {
        const WavelengthSample hero = sample_wavelength(sampler.single(Purpose::wavelength));
        path.wavelength = hero.nanometres;
        path.beta *= hero.weight;
    }
    if (params.ior > 1)
        params.ior = dispersed_ior(params.ior, material.dispersion, path.wavelength);
}

template <EffectSet kTier, typename Recorder>
PathSample trace_path(const RenderScene& rs, const CameraRays& camera, const PathSettings& settings,
                      uint32_t x, uint32_t y, uint64_t sample_index, Recorder& recorder) {
    const Sampler sampler(settings.sampler, settings.seed, x, y, sample_index);
    const Vec2f offset = sample_pixel_filter(settings.filter, sampler.pair(Purpose::pixel));
    const Vec2f lens = camera.has_lens() ? sampler.pair(Purpose::lens) : Vec2f(0);
    Ray ray = camera.ray(static_cast<float>(x) + offset.x, static_cast<float>(y) + offset.y, lens);
    PathSample result;
    PathState path;

    for (uint32_t bounce = 0;; ++bounce) {
        Hit hit;
        ++result.rays;
        const bool found = intersect<kTier>(rs, sampler, bounce, ray, hit);
        if constexpr (Recorder::kActive) recorder.ray(bounce, ray, found, hit, path);
        if (!found) {
            add_environment(rs, settings, bounce, ray, path);
            break;
        }
        result.covered = true;
        SurfaceInteraction si = make_surface_interaction<kTier>(rs.scene(), ray, hit);
        const Material& material = rs.scene().materials()[si.material];
        if constexpr (kTier.has(Effect::volume_absorption)) {
            if (!is_black(path.sigma_a)) path.beta *= transmittance(path.sigma_a, hit.t);
        }
        if constexpr (kTier.has(Effect::unlit)) {
            if (material.unlit) {
                // Seen as it is by the camera and in mirrors; it does not light other surfaces.
                if (path.specular_chain)
                    path.Li += path.beta * Rgb(eval_base_color<kTier>(rs.scene(), material, si));
                break;
            }
        }
        add_emission(rs, settings, ray, material, si, path);
        if (bounce == settings.max_depth) break;

        // The surface: everything below sees it from wo's side.
        apply_normal_map<kTier>(rs.scene(), material, si);
        ShadingParams params = eval_shading_params<kTier>(rs.scene(), material, si);
        if constexpr (kTier.has(Effect::dispersion)) {
            if (material.dispersion > 0 && params.transmission > 0 && !params.thin)
                disperse(sampler, material, params, path);
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
        const Bsdf<kTier> bsdf(params, frame, n_surface, -ray.d, si.front || params.thin);
        const Bounce numbers = sampler.bounce(bounce);
        const Vec3f n_lit = lit_through ? Vec3f(0) : n_surface;
        if (settings.next_event_estimation && bsdf.has_smooth_lobe() && rs.lights().can_sample()) {
            add_direct_light<kTier>(rs, sampler, bounce, numbers, si, n_lit, bsdf, path,
                                    result.rays);
        }

        // Where the path goes on.
        float u_lobe = 0;
        if constexpr (kTier.has(Effect::glossy) || kTier.has(Effect::transmission)) {
            u_lobe = numbers.lobe();
        }
        const std::optional<BsdfSample> scattered = bsdf.sample(u_lobe, numbers.bsdf());
        if constexpr (Recorder::kActive)
            recorder.vertex(bounce, si, material, params, scattered, path);
        if (!scattered) break;
        path.beta *= scattered->weight;
        if (is_black(path.beta)) break;
        path.bsdf_pdf = scattered->pdf;
        path.specular = scattered->delta;
        path.specular_chain = path.specular_chain && scattered->delta;
        path.from = si.lit_point();
        path.n_from = n_lit;
        if constexpr (kTier.has(Effect::transmission) || kTier.has(Effect::diffuse_transmission)) {
            path.eta_scale *= scattered->eta * scattered->eta;
            if (scattered->transmitted && !params.thin)
                path.sigma_a = si.front ? absorption(material) : Rgb(0);
        }

        // Russian roulette on what the path can still bring.
        if (settings.russian_roulette && bounce >= kRouletteStart) {
            const float q = std::max(max_component(path.beta) * path.eta_scale, kMinSurvival);
            if (q < 1) {
                if (numbers.roulette() >= q) break;
                path.beta /= q;
            }
        }
        ray = si.spawn(scattered->wi);
    }
    result.Li = path.Li;
    return result;
}

}  // namespace talbot
