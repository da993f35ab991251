// S03: visible normals at grazing views and at alpha 1: their density integrates to one, and the
// density of a sample is that of a fresh evaluation.
#include "app/hardcases/cases/shading_setup.h"
#include "core/scattering/fresnel.h"
#include "oracles/visible_normals.h"

namespace talbot::hardcases::s03 {
namespace {

// The control: D from the cosine of the half vector, the view's cosine kept above 1e-4, G1 by
// tangents.
float textbook_pdf(float alpha, const Vec3f& wo, const Vec3f& h) {
    const float a2 = alpha * alpha;
    const float t = h.z * h.z * (a2 - 1) + 1;
    const float d = a2 / (kPi * t * t);
    const float z = std::max(wo.z, 1e-4f);
    const float tan2 = (1 - z * z) / (z * z);
    const float g1 = 2 / (1 + std::sqrt(1 + a2 * tan2));
    return d * g1 * std::max(dot(wo, h), 0.0f) / z;
}

CaseResult run(Effort effort) {
    const int draws = effort == Effort::full ? 50000 : 2000;
    const int radial = effort == Effort::full ? 1500 : 300;
    WorstError integral;
    WorstError naive_integral;
    WorstError mismatch;
    WorstError naive_mismatch;
    WorstError bad;
    uint64_t naive_bad = 0;
    Sweep sweep{"cosine of the view",
                "density of a sample against a fresh one, in units of its bound",
                true,
                1,
                {}};
    for (const float mu : {1.0f, 0.3f, 1e-2f, 1e-3f, 1e-4f, 1e-5f, 1e-6f, 1e-7f}) {
        WorstError naive_here;
        WorstError own_here;
        for (const float alpha : {1e-4f, 1e-3f, 1e-2f, 0.1f, 0.5f, 1.0f}) {
            const Ggx ggx(alpha);
            const Vec3f wo(std::sqrt(1 - mu * mu), 0, mu);
            const auto where = [&] { return "alpha " + exact(alpha) + " cosine " + exact(mu); };
            const auto pdf = [&](const Vec3f& h) { return ggx.pdf_visible_normal(wo, h); };
            const auto naive_pdf = [&](const Vec3f& h) { return textbook_pdf(alpha, wo, h); };
            integral.add(std::abs(visible_normals_integral(ggx, pdf, radial) - 1), where);
            naive_integral.add(std::abs(visible_normals_integral(ggx, naive_pdf, radial) - 1),
                               where);

            const double bound = std::max(1e-4, 16 * 0x1p-24 / (double{alpha} * mu));
            const float slant = ggx.slant(wo);
            stats::Random random(case_seed(5));
            for (int i = 0; i < draws; ++i) {
                const Vec3f h = ggx.sample_visible_normal(wo, random.pair());
                const float cos_d = dot(wo, h);
                const Vec3f wi = reflect_about(wo, h, cos_d);
                if (!(wi.z > 0)) continue;  // below the surface: carries nothing
                const GgxReflection r = ggx.eval_reflection(wo, slant, wi);
                const double sampled = static_cast<double>(pdf(h)) / (4 * cos_d);
                bad.add(is_finite(r.pdf) && is_finite(r.value_cos) && is_finite(sampled)
                            ? 0
                            : std::nan(""),
                        where);
                const double e = std::abs(static_cast<double>(r.pdf) / sampled - 1) / bound;
                mismatch.add(e, [&] { return where() + " wi " + exact(wi); });
                own_here.add(e);
                const Vec3f fresh = normalize(wo + wi);
                const float naive_sampled = naive_pdf(h) / (4 * cos_d);
                const float naive_fresh = naive_pdf(fresh) / (4 * dot(wo, fresh));
                const double n =
                    std::abs(static_cast<double>(naive_fresh) / naive_sampled - 1) / bound;
                if (!is_finite(n)) ++naive_bad;
                naive_mismatch.add(n);
                naive_here.add(n);
            }
        }
        sweep.points.push_back({static_cast<double>(mu), naive_here.value, own_here.value});
    }
    CaseResult result;
    result.measures.push_back({"integral of the visible normals, off 1",
                               naive_integral.or_infinite(), integral.or_infinite(), 1e-4,
                               Gate::at_most, integral.where});
    result.measures.push_back(
        {"density of a sample against a fresh one, over max(1e-4, 16 eps / (alpha cos))",
         naive_mismatch.value, mismatch.or_infinite(), 1, Gate::at_most, mismatch.where});
    result.measures.push_back({"values not finite", static_cast<double>(naive_bad),
                               static_cast<double>(bad.nonfinite), 0, Gate::at_most, bad.where});
    result.sweeps.push_back(sweep);
    return result;
}

const bool kAdded =
    add_case({"S03", Priority::p1, "visible normals at grazing views",
              "D from the cosine of the half vector, the view's cosine clamped",
              "a cap of the sphere (Dupuy and Benyoub 2023); D and G1 without division",
              "crocdialer/vierkant#170, gkjohnson/three-gpu-pathtracer#84", run});

}  // namespace
}  // namespace talbot::hardcases::s03
