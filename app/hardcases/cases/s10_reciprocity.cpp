// S10: f(i, o) = f(o, i) for reflection, / eta^2 for refraction. Energy compensation looks at wo
// alone (a documented exception, like the scaling below coat and sheen); it is divided out here.
#include "app/hardcases/cases/shading_setup.h"
#include "oracles/scattering_cases.h"
#include "oracles/stats/random.h"

namespace talbot::hardcases::s10 {
namespace {

Vec3f random_direction(stats::Random& random) {
    Vec3f w = sample_uniform_hemisphere(random.pair());
    w.z = std::max(w.z, 0.02f);
    return normalize(w);
}

double value(const ScatteringCase& c, const Vec3f& wo, const Vec3f& wi) {
    const FullBsdf bsdf(c.params, Frame{}, Vec3f(0, 0, 1), wo, c.outside);
    return static_cast<double>(mean_component(bsdf.eval(wi).f_cos)) / std::abs(double{wi.z});
}

double asymmetry(double a, double b) {
    return a > 0 || b > 0 ? std::abs(a - b) / std::max(a, b) : 0.0;
}

// The control: diffuse light scaled by what Fresnel lets through on the way in alone.
double layered_naively(const Vec3f& wo, float f0) {
    return 1 - static_cast<double>(f0 + (1 - f0) * schlick_weight(wo.z));
}

CaseResult run(Effort effort) {
    const int pairs = effort == Effort::full ? 1000000 : 10000;
    stats::Random random(case_seed(1));
    WorstError reflection, diffuse, refraction, naive_diffuse, naive_refraction;
    constexpr float kAlphas[] = {0.1f, 0.3f, 1.0f};
    constexpr float kIndices[] = {1.33f, 1.5f, 2.4f};
    for (int i = 0; i < pairs; ++i) {
        const float alpha = kAlphas[i % 3];
        const Vec3f a = random_direction(random);
        const Vec3f b = random_direction(random);
        const auto where = [&] {
            return "alpha " + exact(alpha) + " " + exact(a) + " " + exact(b);
        };
        ScatteringCase metal{"metal", {}};
        metal.params.metallic = 1;
        metal.params.alpha = alpha;
        const AlbedoRow row(alpha);
        reflection.add(asymmetry(static_cast<double>(row(a.z).e()) * value(metal, a, b),
                                 static_cast<double>(row(b.z).e()) * value(metal, b, a)),
                       where);
        ScatteringCase plastic{"plastic", {}};
        plastic.params.alpha = 0;
        plastic.params.ior = kIndices[i / 3 % 3];
        diffuse.add(asymmetry(value(plastic, a, b), value(plastic, b, a)), where);
        const float f0 = normal_reflectance(plastic.params.ior);
        naive_diffuse.add(asymmetry(layered_naively(a, f0), layered_naively(b, f0)));

        // Near the refracted direction, so that the lobe is met; not where it grazes the facet: a
        // half vector off by (1 + eta) / (eta - 1) * 2 eps, 8e-7, changes what passes and the two
        // factors of the Jacobian by that over the cosine each; from 0.3 on, 8e-6 in all.
        const float ior = kIndices[i / 3 % 3];
        const float cos_t = fresnel_dielectric(a.z, ior).cos_t;
        const Vec3f straight = -refract_through(a, Vec3f(0, 0, 1), a.z, cos_t, ior);
        const Vec3f c = normalize(straight + alpha * sample_uniform_sphere(random.pair()));
        if (!(c.z > 0.05f) || std::abs(dot(a, normalize(a - ior * c))) < 0.3f) continue;
        ScatteringCase glass{"glass", {}};
        glass.params.transmission = 1;
        glass.params.thin = false;
        glass.params.alpha = alpha;
        glass.params.ior = ior;
        ScatteringCase inside = glass;
        inside.outside = false;
        const auto flip = [](const Vec3f& w) { return Vec3f(w.x, w.y, -w.z); };
        const double out =
            value(glass, a, -c) * static_cast<double>(glass_albedo(a.z, alpha, ior, true));
        const double in = value(inside, flip(-c), flip(a)) *
                          static_cast<double>(glass_albedo(c.z, alpha, ior, false));
        refraction.add(asymmetry(out, in / (double{ior} * ior)), [&] {
            return "alpha " + exact(alpha) + " index " + exact(ior) + " " + exact(a) + " " +
                   exact(c);
        });
        naive_refraction.add(asymmetry(out, in));
    }
    CaseResult result;
    result.measures.push_back({"asymmetry of rough reflection", std::nan(""),
                               reflection.or_infinite(), 1e-5, Gate::at_most, reflection.where});
    result.measures.push_back({"asymmetry of diffuse light under a smooth layer",
                               naive_diffuse.value, diffuse.or_infinite(), 1e-5, Gate::at_most,
                               diffuse.where});
    result.measures.push_back(
        {"asymmetry of rough refraction over eta^2, facets met at cosines from 0.3",
         naive_refraction.value, refraction.or_infinite(), 1e-5, Gate::at_most, refraction.where});
    return result;
}

const bool kAdded = add_case({"S10", Priority::p1, "reciprocity",
                              "no 1 / eta^2 for radiance; Fresnel on the way in alone",
                              "height-correlated shadowing, radiance scaling (Veach 1997, section "
                              "5.2), Kulla-Conty's diffuse",
                              "appleseedhq/appleseed#2886", run});

}  // namespace
}  // namespace talbot::hardcases::s10
