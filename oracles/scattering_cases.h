// Surfaces of every kind, and their integrals by quadrature.
#pragma once

#include <string>
#include <vector>

#include "core/scattering/bsdf.h"
#include "oracles/stats/sphere_cells.h"

namespace talbot {

using FullBsdf = Bsdf<EffectSet::all()>;

struct ScatteringCase {
    std::string name;
    ShadingParams params;
    bool outside = true;

    bool transmits() const { return params.transmission > 0 || params.diffuse_transmission > 0; }
    // Of the sharpest lobe; 0 where light is scattered by delta lobes and diffusely alone.
    double lobe_width() const {
        const bool stretched = params.anisotropy > 0;
        float width = stretched ? std::max(params.alpha, kDeltaAlpha) : params.alpha;
        if (params.clearcoat > 0 && !(params.clearcoat_alpha < kDeltaAlpha))
            width = width < kDeltaAlpha ? params.clearcoat_alpha
                                        : std::min(width, params.clearcoat_alpha);
        return width < kDeltaAlpha ? 0.0 : double{width};
    }
    float eta() const {
        if (params.thin || params.ior == 0 || params.transmission == 0) return 1;
        return outside ? params.ior : 1 / params.ior;
    }
};

// A local set-up: the geometric normal is z, the shading normal tilted from it towards azimuth
// `tilt_azimuth`.
struct View {
    float mu = 1;    // cosine of wo to the geometric normal
    float tilt = 0;  // radians
    float tilt_azimuth = 0;

    Vec3f wo() const { return Vec3f(std::sqrt(std::max(0.0f, 1 - mu * mu)), 0, mu); }
    Frame frame() const {
        if (tilt == 0) return {};
        return Frame::from_normal(
            normalize(Vec3f(std::sin(tilt) * std::cos(tilt_azimuth),
                            std::sin(tilt) * std::sin(tilt_azimuth), std::cos(tilt))));
    }
    std::string text() const {
        return " mu " + std::to_string(mu) + " tilt " + std::to_string(tilt) + " towards " +
               std::to_string(tilt_azimuth);
    }
};

inline FullBsdf make_bsdf(const ScatteringCase& c, const View& v) {
    return FullBsdf(c.params, v.frame(), Vec3f(0, 0, 1), v.wo(), c.outside);
}

// Every kind of surface, with reflectance 1, at one alpha.
inline std::vector<ScatteringCase> white_surfaces(float alpha) {
    std::vector<ScatteringCase> cases;
    const auto add = [&](const std::string& name, auto edit, bool outside = true) {
        ScatteringCase c{name, {}, outside};
        c.params.alpha = alpha;
        edit(c.params);
        cases.push_back(c);
    };
    add("lambert", [](ShadingParams& p) { p.specular = 0; });
    add("plastic", [](ShadingParams&) {});
    add("dense plastic", [](ShadingParams& p) { p.ior = 2.4f; });
    add("half specular", [](ShadingParams& p) { p.specular = 0.5f; });
    add("index 0", [](ShadingParams& p) { p.ior = 0; });
    add("metal", [](ShadingParams& p) { p.metallic = 1; });
    add("half metal", [](ShadingParams& p) { p.metallic = 0.5f; });
    add("glass from outside", [](ShadingParams& p) { p.transmission = 1, p.thin = false; });
    add(
        "glass from inside", [](ShadingParams& p) { p.transmission = 1, p.thin = false; }, false);
    add("thin glass", [](ShadingParams& p) { p.transmission = 1; });
    add("half glass", [](ShadingParams& p) { p.transmission = 0.5f, p.thin = false; });
    add("half thin glass", [](ShadingParams& p) { p.transmission = 0.5f; });
    return cases;
}

// Surfaces with the lobes of the extensions over white ones, at one alpha.
inline std::vector<ScatteringCase> layered_surfaces(float alpha) {
    std::vector<ScatteringCase> cases;
    const auto add = [&](const std::string& name, auto edit, bool outside = true) {
        ScatteringCase c{name, {}, outside};
        c.params.alpha = alpha;
        edit(c.params);
        cases.push_back(c);
    };
    const auto stretch = [](ShadingParams& p) {
        p.anisotropy = 0.7f;
        p.anisotropy_direction = Vec3f(0.8f, 0.6f, 0);
    };
    const auto film = [](ShadingParams& p) {
        p.iridescence = 1;
        p.iridescence_thickness = 500;
    };
    add("coat", [&](ShadingParams& p) { p.clearcoat = 1, p.clearcoat_alpha = alpha; });
    add("smooth coat on metal", [](ShadingParams& p) { p.clearcoat = 1, p.metallic = 1; });
    add("half coat on glass", [&](ShadingParams& p) {
        p.clearcoat = 0.5f, p.clearcoat_alpha = 0.25f, p.transmission = 1, p.thin = false;
    });
    // Sharper sheen is all but zero, down to underflow, away from grazing.
    add("sheen",
        [&](ShadingParams& p) { p.sheen_color = Rgb(1), p.sheen_alpha = std::max(alpha, 0.1f); });
    add("dim sheen on metal",
        [](ShadingParams& p) { p.sheen_color = Rgb(0.5f), p.sheen_alpha = 0.25f, p.metallic = 1; });
    add("stretched metal", [&](ShadingParams& p) { stretch(p), p.metallic = 1; });
    add("stretched plastic", [&](ShadingParams& p) { stretch(p); });
    add("stretched thin glass", [&](ShadingParams& p) { stretch(p), p.transmission = 1; });
    add("stretched glass",
        [&](ShadingParams& p) { stretch(p), p.transmission = 1, p.thin = false; });
    add("film on metal", [&](ShadingParams& p) { film(p), p.metallic = 1; });
    add("film on plastic", [&](ShadingParams& p) { film(p); });
    add("film on glass", [&](ShadingParams& p) { film(p), p.transmission = 1, p.thin = false; });
    add("diffusely transmitting", [](ShadingParams& p) { p.diffuse_transmission = 0.6f; });
    add("leaf", [](ShadingParams& p) {
        p.diffuse_transmission = 1, p.transmission = 0.3f, p.clearcoat = 0.8f;
        p.clearcoat_alpha = 0.01f;
    });
    add("everything", [&](ShadingParams& p) {
        stretch(p), p.metallic = 0.5f, p.sheen_color = Rgb(0.6f), p.sheen_alpha = 0.3f;
        p.clearcoat = 0.7f, p.clearcoat_alpha = 0.04f, p.diffuse_transmission = 0.5f;
    });
    return cases;
}

// Direction about which the light scattered to one side crowds.
inline Vec3d lobe_axis(const ScatteringCase& c, const View& v, bool transmitted) {
    const Vec3d wo(v.wo());
    const Vec3d n(bend_shading_normal(v.frame().n, Vec3f(0, 0, 1), v.wo()));
    const double cos_o = std::abs(dot(wo, n));
    const Vec3d mirrored = normalize(2 * dot(wo, n) * n - wo);
    const auto on_side = [&](Vec3d w) {
        if ((w.z < 0) != transmitted) w.z = -w.z;
        return w;
    };
    if (!transmitted) return on_side(mirrored);
    const double eta = c.eta();
    const double cos2_t = 1 - (1 - cos_o * cos_o) / (eta * eta);
    if (cos2_t <= 0) return -wo;
    if (eta == 1) return on_side(mirrored - 2 * dot(mirrored, n) * n);
    return on_side(normalize(-wo / eta + (cos_o / eta - std::sqrt(cos2_t)) * n));
}

// Integral of value(wi, eval(wi)) over both hemispheres of the geometric surface.
template <typename Value>
double integrate_sphere(const ScatteringCase& c, const View& v, const Value& value,
                        double tolerance = 1e-5) {
    const FullBsdf bsdf = make_bsdf(c, v);
    if (!bsdf.has_smooth_lobe()) return 0;
    double sum = 0;
    for (const bool transmitted : {false, true}) {
        if (transmitted && !c.transmits()) continue;
        const stats::SphereCells cells(lobe_axis(c, v, transmitted), c.lobe_width(), 12, 6);
        sum += cells.integrate(
            [&](const Vec3f& wi) {
                return (wi.z < 0) == transmitted ? value(wi, bsdf.eval(wi)) : 0.0;
            },
            tolerance, v.tilt == 0 && c.params.anisotropy == 0);
    }
    return sum;
}

// Delta events of a surface: each with its probability in `pdf`, found by running through u_lobe.
inline std::vector<BsdfSample> delta_events(const FullBsdf& bsdf) {
    std::vector<BsdfSample> events;
    constexpr int kSteps = 8192;
    for (int i = 0; i < kSteps; ++i) {
        const auto s = bsdf.sample((static_cast<float>(i) + 0.5f) / kSteps, Vec2f(0.3f, 0.6f));
        if (s && s->delta &&
            (events.empty() || events.back().wi != s->wi || events.back().pdf != s->pdf))
            events.push_back(*s);
    }
    return events;
}

// The same as albedo() by sample() alone, over the points of an even sequence (Kronecker's, with
// the root of x^4 = x + 1): for lobes too slender for quadrature.
inline double sampled_albedo(const ScatteringCase& c, const View& v) {
    constexpr int kPoints = 200000;
    constexpr double kRoot = 1.2207440846057596;
    const FullBsdf bsdf = make_bsdf(c, v);
    const auto u = [](double step, int i) {
        const double x = 0.5 + step * i;
        return std::min(static_cast<float>(x - std::floor(x)), kOneMinusEpsilon);
    };
    double sum = 0;
    for (int i = 0; i < kPoints; ++i) {
        const auto s = bsdf.sample(
            u(1 / kRoot, i), Vec2f(u(1 / (kRoot * kRoot), i), u(1 / (kRoot * kRoot * kRoot), i)));
        if (s) sum += static_cast<double>(mean_component(s->weight) * s->eta * s->eta);
    }
    return sum / kPoints;
}

// What the surface returns of a uniform surrounding: power, radiance scaling of refraction undone.
// Mean of the channels.
inline double albedo(const ScatteringCase& c, const View& v) {
    const double eta2 = double{c.eta()} * c.eta();
    double sum = integrate_sphere(c, v, [&](const Vec3f& wi, const BsdfEval& e) {
        return static_cast<double>(mean_component(e.f_cos)) * (wi.z < 0 ? eta2 : 1.0);
    });
    for (const BsdfSample& s : delta_events(make_bsdf(c, v))) {
        sum += static_cast<double>(mean_component(s.weight) * s.pdf * s.eta * s.eta);
    }
    return sum;
}

// Albedo of a view averaged over azimuths of the tilt.
inline double tilted_albedo(const ScatteringCase& c, float mu, float tilt, double& lowest) {
    constexpr int kAzimuths = 4;
    double sum = 0;
    for (int k = 0; k < kAzimuths; ++k) {
        const double a =
            albedo(c, {mu, tilt, (static_cast<float>(k) + 0.25f) * (2 * kPi / kAzimuths)});
        lowest = std::min(lowest, a);
        sum += a;
    }
    return sum / kAzimuths;
}

}  // namespace talbot
