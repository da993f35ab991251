// S05: reflectance at the ends of its parameters. glTF's metals are a colour under Schlick's curve;
// a complex index of refraction (absorption k above 0) cannot be asked for.
#include "app/hardcases/cases/quad_float.h"
#include "app/hardcases/cases/shading_setup.h"
#include "oracles/scattering_cases.h"

namespace talbot::hardcases::s05 {
namespace {

// Index n with no absorption.
Quad dielectric(float cos_i, float n) {
    const Quad c = cos_i;
    const Quad cos2_t = 1 - (1 - c * c) / (Quad(n) * n);
    if (!(cos2_t > 0)) return 1;
    const Quad ct = square_root(cos2_t);
    const Quad s = (c - n * ct) / (c + n * ct);
    const Quad p = (n * c - ct) / (n * c + ct);
    return (s * s + p * p) / 2;
}

Quad schlick(Quad f0, Quad f90, float cos_i) {
    const Quad m = 1 - Quad(cos_i);
    return f0 + (f90 - f0) * m * m * m * m * m;
}

// What a mirror returns, by its delta lobe.
Rgb mirror_reflectance(const ShadingParams& p, float mu) {
    const View v{mu};
    Rgb sum(0);
    for (const BsdfSample& s : delta_events(make_bsdf({"mirror", p, true}, v)))
        if (!s.transmitted) sum += s.weight * s.pdf;
    return sum;
}

struct Figures {
    WorstError error, outside;

    void add(double value, Quad expected, const std::string& where) {
        const auto describe = [&] { return where; };
        error.add(std::abs(value - static_cast<double>(expected)), describe);
        outside.add(value >= 0 && value <= 1 + 0x1p-23 ? 0 : 1, describe);
    }
};

CaseResult run(Effort effort) {
    Figures naive;
    Figures own;
    const int steps = effort == Effort::full ? 500 : 200;
    for (const float n : {0.0f, 1e-4f, 0.1f, 0.9f, 1.1f, 1.5f, 2.4f, 100.0f, 1e4f}) {
        for (int i = 0; i <= steps; ++i) {
            const float c = static_cast<float>(i) / static_cast<float>(steps);
            const std::string where = "index " + exact(n) + " cosine " + exact(c);
            // An index of 0 reflects everything, by KHR_materials_ior.
            if (n > 0)
                own.add(static_cast<double>(fresnel_dielectric(c, n).reflectance), dielectric(c, n),
                        where);
            const float ct = std::sqrt(1 - (1 - c * c) / (n * n));
            const float s = (c - n * ct) / (c + n * ct);
            const float p = (n * c - ct) / (n * c + ct);
            naive.add(static_cast<double>(0.5f * (s * s + p * p)),
                      n > 0 ? dielectric(c, n) : Quad(1), where);
        }
    }
    // Schlick's curve through the real surface: metals, specular colours above 1, index 0 and huge.
    const int cosines = effort == Effort::full ? 16 : 6;
    for (const float f0 : {0.0f, 0.02f, 0.5f, 1.0f}) {
        for (const float colour : {0.0f, 0.3f, 1.0f, 25.0f, 1e4f}) {
            for (const float ior : {0.0f, 1.0f, 1.5f, 1e4f}) {
                for (int i = 0; i <= cosines; ++i) {
                    const float mu = static_cast<float>(i) / static_cast<float>(cosines);
                    const std::string where = "F0 " + exact(f0) + " specular colour " +
                                              exact(colour) + " index " + exact(ior) + " cosine " +
                                              exact(mu);
                    ShadingParams metal;
                    metal.alpha = 0;
                    metal.metallic = 1;
                    metal.base_color = Rgb(f0);
                    own.add(static_cast<double>(mirror_reflectance(metal, mu).x),
                            schlick(f0, 1, mu), where);
                    ShadingParams plastic;
                    plastic.alpha = 0;
                    plastic.ior = ior;
                    plastic.base_color = Rgb(0);
                    plastic.specular = f0;
                    plastic.specular_color = Rgb(colour);
                    const Quad r = (Quad(ior) - 1) / (Quad(ior) + 1);
                    const Quad normal = r * r * colour;
                    const Quad expected = schlick((normal < 1 ? normal : Quad(1)) * f0, f0, mu);
                    own.add(static_cast<double>(mirror_reflectance(plastic, mu).x), expected,
                            where);
                    // Without the clamp of the extension.
                    const float r2 = normal_reflectance(ior) * colour * f0;
                    naive.add(static_cast<double>(r2 + (f0 - r2) * schlick_weight(mu)), expected,
                              where);
                }
            }
        }
    }
    CaseResult result;
    result.measures.push_back({"error of a reflectance", naive.error.or_infinite(),
                               own.error.or_infinite(), 1e-5, Gate::at_most, own.error.where});
    result.measures.push_back({"reflectance outside [0, 1], largest of 0 and 1",
                               naive.outside.or_infinite(), own.outside.or_infinite(), 0,
                               Gate::at_most, own.outside.where});
    return result;
}

const bool kAdded =
    add_case({"S05", Priority::p1, "reflectance at the ends of index and colour (k = 0)",
              "index 0 taken literally, F0 not clamped",
              "index 0 means Fresnel 1; F0 clamped before the factor; radicands in double",
              "playcanvas/engine#5239", run});

}  // namespace
}  // namespace talbot::hardcases::s05
