// S09: the weight and density of a sample are those of a fresh evaluation, and light sampling, BSDF
// sampling and both together estimate the same.
#include "app/hardcases/cases/shading_setup.h"
#include "oracles/bsdf_agreement.h"
#include "oracles/stats/ztest.h"

namespace talbot::hardcases::s09 {
namespace {

// The control: half diffuse, half GGX; a sample carries the density of its own lobe alone.
class HalfGlossy {
  public:
    HalfGlossy(float alpha, const Vec3f& wo) : ggx_(alpha), wo_(wo) {}

    BsdfEval eval(const Vec3f& wi) const {
        if (!(wi.z > 0)) return {};
        const GgxReflection r = ggx_.eval_reflection(wo_, ggx_.slant(wo_), wi);
        return {Rgb(0.5f * wi.z * kInvPi + 0.5f * r.value_cos),
                0.5f * wi.z * kInvPi + 0.5f * r.pdf};
    }
    std::optional<BsdfSample> sample(float u_lobe, const Vec2f& u) const {
        BsdfSample s;
        if (u_lobe < 0.5f) {
            s.wi = sample_cosine_hemisphere(u);
            s.pdf = s.wi.z * kInvPi;
        } else {
            const Vec3f h = ggx_.sample_visible_normal(wo_, u);
            s.wi = reflect_about(wo_, h, dot(wo_, h));
            if (!(s.wi.z > 0)) return std::nullopt;
            s.pdf = ggx_.eval_reflection(wo_, ggx_.slant(wo_), s.wi).pdf;
        }
        s.weight = eval(s.wi).f_cos * (1 / s.pdf);
        return s;
    }

  private:
    Ggx ggx_;
    Vec3f wo_;
};

// A lamp above a point at the origin of the shading frame.
struct Lamp {
    std::shared_ptr<const Scene> scene;
    LightTable lights;
    Vec3f p;

    explicit Lamp(WorkerPool& pool) {
        SceneBuilder builder;
        Material lamp = SceneBuilder::diffuse(0);
        lamp.emissive_factor = Rgb(1);
        builder.mesh(SceneBuilder::quad(Vec3f(-1.5f, -1, 0.7f), Vec3f(0, 2, 0), Vec3f(2, 0, 0.5f)),
                     builder.material(lamp));
        scene = builder.build(pool);
        lights = LightTable(*scene);
        p = Vec3f(-scene->origin());
    }

    // Density of light sampling towards wi; 0 where it misses.
    float pdf(const Vec3f& wi) const {
        Hit hit;
        Ray ray;
        ray.o = p;
        ray.d = wi;
        if (!scene->accel().closest(ray, hit)) return 0;
        return lights.pdf_surface(p, Vec3f(0), hit.id, p + hit.t * wi);
    }
};

// Largest difference between the three estimators in units of its standard error. Of what light
// sampling can find: mirrored lamps are left to BSDF sampling alone (S11).
template <typename Surface>
double disagreement(const Surface& bsdf, const Lamp& lamp, int draws, uint64_t seed) {
    stats::Random random(case_seed(seed));
    stats::Moments by_light;
    stats::Moments by_bsdf;
    stats::Moments both;
    for (int i = 0; i < draws; ++i) {
        double mixed = 0;
        double value = 0;
        const float u_choice = random();
        if (const auto l =
                lamp.lights.sample(*lamp.scene, lamp.p, Vec3f(0), u_choice, random.pair())) {
            const BsdfEval e = bsdf.eval(l->wi);
            value = static_cast<double>(e.f_cos.y * l->radiance.y / l->pdf);
            mixed = value * static_cast<double>(power_heuristic(l->pdf, e.pdf));
        }
        by_light.add(value);
        value = 0;
        const float u_lobe = random();
        if (const auto s = bsdf.sample(u_lobe, random.pair()); s && !s->delta) {
            const float pdf = lamp.pdf(s->wi);
            if (pdf > 0) {
                value = static_cast<double>(s->weight.y);
                mixed += value * static_cast<double>(power_heuristic(s->pdf, pdf));
            }
        }
        by_bsdf.add(value);
        both.add(mixed);
    }
    const auto apart = [](const stats::Moments& a, const stats::Moments& b) {
        return std::abs(a.mean() - b.mean()) / std::hypot(a.standard_error(), b.standard_error());
    };
    return std::max({apart(by_light, by_bsdf), apart(by_light, both), apart(by_bsdf, both)});
}

template <typename Surface>
double record_error(const Surface& bsdf, const Surface& fresh, int draws, uint64_t seed) {
    stats::Random random(case_seed(seed));
    double worst = 0;
    for (int i = 0; i < draws; ++i) {
        const float u_lobe = random();
        const auto s = bsdf.sample(u_lobe, random.pair());
        if (!s || s->delta) continue;
        const BsdfEval e = fresh.eval(s->wi);
        worst = std::max(worst, relative(static_cast<double>(s->pdf), static_cast<double>(e.pdf)));
        for (int k = 0; k < 3; ++k) {
            if (e.f_cos[k] > 0)
                worst = std::max(worst, relative(static_cast<double>(s->weight[k]) * s->pdf,
                                                 static_cast<double>(e.f_cos[k])));
        }
    }
    return worst;
}

CaseResult run(Effort effort) {
    const bool full = effort == Effort::full;
    WorkerPool pool(run_settings().threads);
    const Lamp lamp(pool);
    WorstError record;
    const std::vector<Setting> settings = scattering_settings();
    const int per_setting = full ? 2000 : 100;
    uint64_t seed = 1;
    for (const Setting& s : settings) {
        const double alpha = std::max(1e-3, static_cast<double>(s.surface.params.alpha));
        const double bound =
            std::max(1e-4, 16 * 0x1p-24 / (alpha * static_cast<double>(s.view.mu)));
        record.add(record_error(make_bsdf(s.surface, s.view), make_bsdf(s.surface, s.view),
                                per_setting, ++seed) /
                       bound,
                   [&] {
                       return s.surface.name + " alpha " + exact(s.surface.params.alpha) +
                              s.view.text();
                   });
    }
    const View view{0.6f};
    const HalfGlossy control(0.2f, view.wo());
    const double naive_record = record_error(control, control, 10000, 5) / 1e-4;

    // One scene per kind of surface.
    const std::vector<ScatteringCase> surfaces = coloured_surfaces(0.2f);
    const std::size_t step = full ? 1 : 4;
    const int draws = full ? 200000 : 10000;
    std::vector<double> z((surfaces.size() + step - 1) / step);
    pool.parallel_for(z.size(), [&](uint64_t i, unsigned) {
        z[i] = disagreement(make_bsdf(surfaces[i * step], view), lamp, draws, 100 + i);
    });
    WorstError apart;
    for (std::size_t i = 0; i < z.size(); ++i)
        apart.add(z[i], [&] { return surfaces[i * step].name; });
    const double naive_apart = disagreement(control, lamp, draws, 99);

    CaseResult result;
    result.measures.push_back(
        {"weight and density against fresh ones, over max(1e-4, 16 eps / (alpha cos))",
         naive_record, record.or_infinite(), 1, Gate::at_most, record.where});
    result.measures.push_back({"light, BSDF and combined estimates, apart in standard errors",
                               naive_apart, apart.or_infinite(), 4, Gate::at_most, apart.where});
    return result;
}

const bool kAdded = add_case(
    {"S09", Priority::p0, "sample, value and density agree",
     "a sample carries the density of its own lobe alone",
     "a drawn direction is valued by the routine that light sampling uses",
     "gkjohnson/three-gpu-pathtracer#847, #174; mmp/pbrt-v4#187; mitsuba-renderer/mitsuba3#134",
     run});

}  // namespace
}  // namespace talbot::hardcases::s09
