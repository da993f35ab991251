// V01: light through homogeneous matter at optical depths of 1e-8 to 1e8, channel by channel.
// Talbot's media absorb and do not scatter, so transmittance is all there is.
#include "app/hardcases/cases/shading_scene.h"
#include "app/hardcases/cases/shading_setup.h"
#include "core/scattering/medium.h"

namespace talbot::hardcases {
namespace {

// The control: the depth rounded to float, no case for a channel without absorption (0 times
// infinity).
float naive_transmittance(float sigma, float distance) {
    return std::exp(-sigma * distance);
}

// A slab of index 1 before a glowing wall; `depth` is its thickness over the attenuation distance.
SceneBuilder slab(const Rgb& color, double thickness, double depth) {
    SceneBuilder builder;
    Material lamp = SceneBuilder::diffuse(0);
    lamp.emissive_factor = Rgb(1);
    const auto s = static_cast<float>(thickness);
    builder.mesh(
        SceneBuilder::quad(s * Vec3f(-9, -9, -3), s * Vec3f(18, 0, 0), s * Vec3f(0, 18, 0)),
        builder.material(lamp));
    Material matter;
    matter.metallic_factor = 0;
    matter.roughness_factor = 0;
    matter.transmission_factor = 1;
    matter.thickness_factor = 1;
    matter.ior = 1;
    matter.attenuation_color = color;
    matter.attenuation_distance = static_cast<float>(thickness / depth);
    builder.mesh(SceneBuilder::box(s * Vec3f(-2, -2, -1), s * Vec3f(2, 2, 0)),
                 builder.material(matter));
    return builder;
}

CaseResult run(Effort effort) {
    const bool full = effort == Effort::full;
    CaseResult result;
    Worst naive;
    Worst own;
    Sweep sweep{"optical depth", "relative error of the transmittance", true, 1e-6, {}};
    const int steps = full ? 200000 : 4000;
    for (int i = 0; i <= steps; ++i) {
        // Depths that a float can still say; beyond, both are 0.
        const double depth = std::pow(10.0, -8 + 9.9 * i / steps);
        if (depth > 87) break;
        Worst naive_here;
        Worst own_here;
        for (const double distance : {1e-6, 1e-3, 0.7, 13.0, 1e6}) {
            const auto d = static_cast<float>(distance);
            const auto sigma = static_cast<float>(depth / distance);
            const long double expected = std::exp(-static_cast<long double>(sigma) * d);
            const auto where = [&] { return "sigma " + exact(sigma) + " distance " + exact(d); };
            const double e =
                relative(static_cast<double>(transmittance(Rgb(sigma), d).x), expected);
            const double n = relative(static_cast<double>(naive_transmittance(sigma, d)), expected);
            own.add(e, where);
            naive.add(n, where);
            own_here.add(e);
            naive_here.add(n);
        }
        if (i % (steps / 40) == 0)
            sweep.points.push_back({depth, naive_here.value, own_here.value});
    }
    // Channels with nothing, next to nothing and everything, over no way, a way and an endless one.
    double naive_bad = 0;
    double own_bad = 0;
    for (const float sigma : {0.0f, 1e-38f, 1e-8f, 1.0f, 1e8f, 3e38f, kInfinity}) {
        for (const float d : {0.0f, 1e-38f, 1e-6f, 1.0f, 1e6f, 3e38f, kInfinity}) {
            const Rgb t = transmittance(Rgb(sigma, 0, 1), d);
            const auto sound = [](float x) { return x >= 0 && x <= 1; };
            if (!sound(t.x) || t.y != 1 || !sound(t.z)) ++own_bad;
            if (!sound(naive_transmittance(sigma, d))) ++naive_bad;
        }
    }
    // The path tracer through a slab.
    WorkerPool pool(run_settings().threads);
    const Rgb color(0.5f, 1, 1e-3f);
    PathSettings settings;
    NonFiniteCount bad;
    Worst image;
    for (const double thickness : {1e-6, 1e-2, 1.0, 1e3, 1e6}) {
        for (const double depth : {1e-6, 1e-3, 0.5}) {
            const Camera camera = camera_at(Vec3d(0, 0, 5 * thickness), Vec3d(0), 1e-4);
            const Film film = render_film(slab(color, thickness, depth).build(pool), camera,
                                          settings, 4, 4, 2, pool, -1, &bad);
            const ImageRgba mean = film.image(false);
            for (const Rgb& c : mean.rgb) {
                for (int k = 0; k < 3; ++k) {
                    const long double expected = std::pow(static_cast<long double>(color[k]),
                                                          static_cast<long double>(depth));
                    image.add(relative(static_cast<double>(c[k]), expected), [&] {
                        return "thickness " + exact(thickness) + " over " + exact(depth) +
                               " channel " + std::to_string(k);
                    });
                }
            }
        }
    }
    result.nonfinite = bad.total();
    result.measures.push_back({"relative error of the transmittance", naive.or_infinite(),
                               own.or_infinite(), 1e-6, Gate::at_most, own.where});
    result.measures.push_back({"transmittances outside [0, 1] or not exact without absorption",
                               naive_bad, own_bad, 0, Gate::at_most, ""});
    result.measures.push_back({"relative error of a slab's image", std::nan(""),
                               image.or_infinite(), 1e-6, Gate::at_most, image.where});
    result.sweeps.push_back(sweep);
    return result;
}

const bool kAdded = add_case(
    {"V01", Priority::p0, "homogeneous absorption, thin to opaque", "exp of the rounded product",
     "what rounding took from the optical depth is put back; channels without absorption keep 1",
     "mitsuba-renderer/mitsuba3#1387, mitsuba-renderer/mitsuba2#323, mmp/pbrt-v4#333", run});

const bool kNoScattering[] = {
    add_not_simulated({"V02", "Henyey-Greenstein at its limits",
                       "media absorb and do not scatter, so there is no phase function"}),
    add_not_simulated(
        {"V03", "white medium furnace and mean chord", "media absorb and do not scatter"}),
    add_not_simulated({"V04", "nested and overlapping dielectrics",
                       "a path knows the medium that it entered last; glTF has no priorities"}),
    add_not_simulated({"V05", "point light inside a medium",
                       "media absorb and do not scatter light towards the eye"}),
    add_not_simulated({"V06", "heterogeneous media", "glTF has homogeneous volumes only"}),
};

}  // namespace
}  // namespace talbot::hardcases
