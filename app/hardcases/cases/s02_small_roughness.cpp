// S02: roughness towards 0. One alpha of 0 divides by zero, and small roughness must join the
// mirror.
#include "app/hardcases/cases/shading_setup.h"
#include "oracles/scattering_cases.h"
#include "oracles/stats/random.h"
#include "oracles/stats/ztest.h"

namespace talbot::hardcases::s02 {
namespace {

// A smooth sky: brightens towards one direction.
double sky(const Vec3f& w) {
    return 1 + 0.5 * static_cast<double>(dot(w, Vec3f(-0.57f, 0.456f, 0.684f)));
}

// Light returned of that sky, by sampling.
stats::Moments returned(const ScatteringCase& c, const View& v, int draws, WorstError& bad) {
    const FullBsdf bsdf = make_bsdf(c, v);
    stats::Random random(case_seed(7));
    stats::Moments m;
    for (int i = 0; i < draws; ++i) {
        const float u_lobe = random();
        const auto s = bsdf.sample(u_lobe, random.pair());
        const double value = s ? static_cast<double>(s->weight.y) * sky(s->wi) : 0.0;
        const BsdfEval e = bsdf.eval(s ? s->wi : v.wo());
        const bool finite = is_finite(value) && is_finite(e.f_cos) && is_finite(e.pdf);
        bad.add(finite ? 0 : std::nan(""),
                [&] { return c.name + " alpha " + exact(c.params.alpha) + v.text(); });
        m.add(finite ? value : 0);
    }
    return m;
}

// The control: GGX at the alpha that it is given, whatever that is. For a metal.
stats::Moments returned_naively(float alpha, const View& v, int draws, uint64_t& nonfinite) {
    const Ggx ggx(alpha);
    const Vec3f wo = v.wo();
    stats::Random random(case_seed(7));
    stats::Moments m;
    for (int i = 0; i < draws; ++i) {
        const Vec3f h = ggx.sample_visible_normal(wo, random.pair());
        const Vec3f wi = reflect_about(wo, h, dot(wo, h));
        // A textbook's f cos / pdf with the distribution in both.
        const float d = ggx.d(normalize(wo + wi));
        const float f_cos = d * ggx.g2(wo, wi) / (4 * wo.z);
        const float pdf = d * ggx.g1(wo) / (4 * wo.z);
        const double value = static_cast<double>(f_cos / pdf) * sky(wi);
        const bool finite = is_finite(value) && is_finite(d);
        if (!finite) ++nonfinite;
        m.add(finite && wi.z > 0 ? value : 0);
    }
    return m;
}

// By how many standard errors the change against the mirror exceeds 2 alpha.
double excess(const stats::Moments& m, double mirror, double mirror_error, double alpha) {
    const double error = std::hypot(m.standard_error(), mirror_error) + 1e-6 * mirror;
    return std::max(0.0, std::abs(m.mean() - mirror) - 2 * alpha * mirror) / error;
}

// A metal floor under an area light and a graded sky, by the path tracer with all its strategies.
struct Floor {
    WorkerPool& pool;
    uint64_t passes;

    stats::Moments mean(double alpha) const {
        SceneBuilder builder;
        Material metal;
        metal.roughness_factor = static_cast<float>(std::sqrt(alpha));
        builder.mesh(SceneBuilder::quad(Vec3f(-4, 0, -4), Vec3f(0, 0, 8), Vec3f(8, 0, 0)),
                     builder.material(metal));
        Material lamp = SceneBuilder::diffuse(0);
        lamp.emissive_factor = Rgb(3);
        builder.mesh(SceneBuilder::quad(Vec3f(-1, 1, -2), Vec3f(2, 0, 0), Vec3f(0, 2, 0)),
                     builder.material(lamp));
        builder.desc().environment.gradient =
            EnvironmentGradient{Vec3f(0, 1, 0), Rgb(0.4f), Rgb(1)};
        const auto scene = builder.build(pool);
        stats::Moments m;
        for (uint64_t seed = 1; seed <= 8; ++seed) {
            PathSettings settings;
            settings.seed = seed;
            settings.max_depth = 4;
            m.add(film_mean(render_film(scene, camera_at(Vec3d(0, 1.2, 2.5), Vec3d(0, 0, -0.2)),
                                        settings, 24, 24, passes, pool)));
        }
        return m;
    }
};

CaseResult run(Effort effort) {
    const int draws = effort == Effort::full ? 100000 : 8000;
    constexpr float kAlphas[] = {1e-8f, 1e-5f, 1e-4f, 9.9e-4f, 1e-3f, 2e-3f, 5e-3f, 1e-2f};
    WorstError naive;
    WorstError own;
    WorstError bad;
    uint64_t naive_bad = 0;
    Sweep sweep{"alpha", "light of a smooth sky: change against the mirror", true, 0.02, {}};
    const std::size_t kinds[] = {1, 5, 7, 8, 9};
    for (const float alpha : kAlphas) {
        WorstError naive_here;
        WorstError own_here;
        for (const float mu : {1.0f, 0.5f, 0.2f}) {
            const View v{mu};
            for (const std::size_t kind : kinds) {
                const stats::Moments mirror = returned(white_surfaces(0)[kind], v, draws, bad);
                const ScatteringCase c = white_surfaces(alpha)[kind];
                const stats::Moments m = returned(c, v, draws, bad);
                own.add(
                    excess(m, mirror.mean(), mirror.standard_error(), static_cast<double>(alpha)),
                    [&] { return c.name + " alpha " + exact(alpha) + v.text(); });
                own_here.add(relative(m.mean(), mirror.mean()));
            }
            const double mirror = sky(Vec3f(-v.wo().x, 0, v.wo().z));
            const stats::Moments m = returned_naively(alpha, v, draws, naive_bad);
            naive.add(excess(m, mirror, 0, static_cast<double>(alpha)));
            naive_here.add(relative(m.mean(), mirror));
        }
        sweep.points.push_back({static_cast<double>(alpha), naive_here.value, own_here.value});
    }
    // Stretched to (0, 0.5), and the mirror itself.
    for (const float mu : {1.0f, 0.2f, 1e-4f}) {
        ScatteringCase c{"stretched metal", {}};
        c.params.metallic = 1;
        c.params.alpha = 0;
        c.params.anisotropy = std::sqrt(0.5f);
        c.params.anisotropy_direction = Vec3f(1, 0, 0);
        returned(c, {mu}, draws, bad);
        returned_naively(0, {mu}, draws, naive_bad);
    }
    WorkerPool pool(run_settings().threads);
    const Floor floor{pool, effort == Effort::full ? 128u : 16u};
    const stats::Moments mirror = floor.mean(0);
    WorstError image;
    for (const double alpha : {1e-8, 1e-3, 1e-2}) {
        image.add(excess(floor.mean(alpha), mirror.mean(), mirror.standard_error(), alpha),
                  [&] { return "alpha " + exact(alpha); });
    }
    CaseResult result;
    result.measures.push_back({"values not finite", static_cast<double>(naive_bad),
                               static_cast<double>(bad.nonfinite), 0, Gate::at_most, bad.where});
    result.measures.push_back({"light of a smooth sky: change beyond 2 alpha, in standard errors",
                               naive.value, own.value, 4, Gate::at_most, own.where});
    result.measures.push_back({"mean of an image with an area light: the same", std::nan(""),
                               image.value, 4, Gate::at_most, image.where});
    result.sweeps.push_back(sweep);
    return result;
}

const bool kAdded = add_case(
    {"S02", Priority::p0, "roughness towards 0 joins the mirror",
     "GGX at whatever alpha it is given",
     "below alpha 1e-3 a delta lobe in every routine alike; one axis alone is clamped there",
     "mmp/pbrt-v3#273, mmp/pbrt-v3#274, mmp/pbrt-v3#214, mmp/pbrt-v4#283", run});

}  // namespace
}  // namespace talbot::hardcases::s02
