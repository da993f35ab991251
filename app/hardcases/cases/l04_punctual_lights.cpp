// L04: punctual lights in degenerate set-ups: at the light itself, next to it, equal cone angles, a
// cone of nothing, no power.
#include "app/hardcases/cases/light_setup.h"

namespace talbot::hardcases::l04 {
namespace {

using Real = long double;

// KHR_lights_punctual, without a range.
Real expected_radiance(const PunctualLight& light, const Vec3d& to) {
    const Real d2 = static_cast<Real>(to.x) * to.x + static_cast<Real>(to.y) * to.y +
                    static_cast<Real>(to.z) * to.z;
    Real value = light.intensity / d2;
    if (light.kind == PunctualKind::spot) {
        const Vec3d axis(light.direction);
        const Real cosine = -(static_cast<Real>(to.x) * axis.x + static_cast<Real>(to.y) * axis.y +
                              static_cast<Real>(to.z) * axis.z) /
                            std::sqrt(d2);
        const Real outer = std::cos(static_cast<Real>(light.outer_cone_angle));
        const Real inner = std::cos(static_cast<Real>(light.inner_cone_angle));
        const Real s = inner > outer ? std::clamp<Real>((cosine - outer) / (inner - outer), 0, 1)
                                     : (cosine > outer ? 1 : 0);
        value *= s * s;
    }
    return value;
}

// The control: all in float, the edge by division.
float naive_radiance(const PunctualLight& light, const Vec3f& to) {
    const float d2 = dot(to, to);
    float value = light.intensity / d2;
    if (light.kind == PunctualKind::spot) {
        const float cosine = -dot(to / std::sqrt(d2), light.direction);
        const float outer = std::cos(light.outer_cone_angle);
        const float inner = std::cos(light.inner_cone_angle);
        const float s = std::min(std::max((cosine - outer) / (inner - outer), 0.0f), 1.0f);
        value *= std::isnan((cosine - outer) / (inner - outer)) ? (cosine - outer) / (inner - outer)
                                                                : s * s;
    }
    return value;
}

CaseResult run(Effort) {
    WorkerPool pool(run_settings().threads);
    constexpr double kLargestFloat = 3.4028234e38;
    WorstError error;
    double naive_bad = 0;
    double own_bad = 0;
    std::string where;
    Sweep sweep{
        "distance in metres", "relative error of what arrives from a point light", true, 1e-6, {}};

    const auto judge = [&](const PunctualLight& light, const Vec3d& at, const std::string& name) {
        SceneBuilder builder;
        builder.light(light);
        const LampScene lamp(builder, pool);
        Light record;
        record.kind = light.kind == PunctualKind::spot ? LightKind::spot : LightKind::point;
        record.e1 = light.direction;
        record.radiance = light.color * light.intensity;
        const Vec3f p(at);
        const auto s = sample_punctual_light(light, record, p);
        const Vec3d to = -Vec3d(p);
        const Real expected = expected_radiance(light, to);
        const float naive = naive_radiance(light, -p);
        // What a float cannot hold counts as lost by the film; at the light itself nothing arrives.
        const bool at_light = p == Vec3f(0);
        const bool holds = !at_light && expected < static_cast<Real>(kLargestFloat);
        const double got = s ? static_cast<double>(s->radiance.y) : 0.0;
        if (std::isnan(got) || (s && !is_finite(s->wi)) || (holds && !is_finite(got))) {
            if (own_bad++ == 0) where = name;
        }
        if (std::isnan(naive) || (holds && !is_finite(naive)) || (at_light && !is_finite(naive)))
            ++naive_bad;
        if (holds && expected > Real(1e-30))
            error.add(relative(got, expected), [&] { return name; });
        return holds ? relative(got, expected) : 0.0;
    };

    PunctualLight point;
    point.kind = PunctualKind::point;
    point.intensity = 7;
    judge(point, Vec3d(0), "point light, at itself");
    for (int e = -40; e <= 14; ++e) {
        const double d = std::pow(10.0, e);
        const double own =
            judge(point, Vec3d(0.6 * d, -0.8 * d, 0), "point light, distance " + exact(d));
        const Vec3f to(Vec3d(-0.6 * d, 0.8 * d, 0));
        const Real expected = expected_radiance(point, Vec3d(to));
        if (expected < static_cast<Real>(kLargestFloat))
            sweep.points.push_back(
                {d,
                 std::min(relative(static_cast<double>(naive_radiance(point, to)), expected), 1e3),
                 own});
    }
    PunctualLight spot = point;
    spot.kind = PunctualKind::spot;
    spot.direction = Vec3f(0, -1, 0);
    const float half_pi = kPi / 2;
    const std::pair<float, float> cones[] = {{0, 0.5f},          {0.5f, 0.5f}, {0, 0},
                                             {half_pi, half_pi}, {0, 1e-6f},   {0.5f, 0.50000006f},
                                             {0, half_pi}};
    for (const auto& [inner, outer] : cones) {
        spot.inner_cone_angle = inner;
        spot.outer_cone_angle = outer;
        // On the axis, in the cone, at its very edge, outside and at the light.
        const double angles[] = {0, 0.3 * static_cast<double>(outer), static_cast<double>(outer),
                                 2};
        for (const double a : angles) {
            for (const double d : {1e-18, 1.0, 1e6}) {
                // At the edge itself the answer is a matter of the last bit: only finite is asked.
                const std::string name =
                    "spot " + exact(inner) + " " + exact(outer) + " angle " + exact(a);
                const Vec3d at(d * std::sin(a), -d * std::cos(a), 0);
                if (a == static_cast<double>(outer) || inner >= 0.5f) {
                    Light record;
                    record.kind = LightKind::spot;
                    record.e1 = spot.direction;
                    record.radiance = Rgb(spot.intensity);
                    const auto s = sample_punctual_light(spot, record, Vec3f(at));
                    if (s && !(is_finite(s->radiance) && is_finite(s->wi))) ++own_bad;
                    if (!is_finite(naive_radiance(spot, -Vec3f(at)))) ++naive_bad;
                    continue;
                }
                judge(spot, at, name);
            }
        }
        judge(spot, Vec3d(0), "spot, at itself");
    }
    // No power at all: nothing to sample, no light anywhere.
    double lit = 0;
    PunctualLight dark = point;
    dark.intensity = 0;
    SceneBuilder builder;
    builder.light(dark);
    builder.mesh(SceneBuilder::quad(Vec3f(-1, -1, -1), Vec3f(0, 0, 2), Vec3f(2, 0, 0)),
                 builder.material(SceneBuilder::diffuse(0.5f)));
    NonFiniteCount bad;
    const Film film = render_film(builder.build(pool), camera_at(Vec3d(0, 1, 2), Vec3d(0, -1, 0)),
                                  PathSettings{}, 8, 8, 4, pool, -1, &bad);
    lit += film_mean(film) + static_cast<double>(bad.total());

    CaseResult result;
    result.nonfinite = bad.total();
    result.measures.push_back({"results that are not finite where the true one is", naive_bad,
                               own_bad, 0, Gate::at_most, where});
    result.measures.push_back({"relative error of what arrives", std::nan(""), error.or_infinite(),
                               1e-6, Gate::at_most, error.where});
    result.measures.push_back(
        {"light of a lamp without power", std::nan(""), lit, 0, Gate::at_most, ""});
    result.sweeps.push_back(sweep);
    return result;
}

const bool kAdded = add_case(
    {"L04", Priority::p1, "punctual lights in degenerate set-ups",
     "float throughout, the cone's edge by division",
     "distances in double; equal cone angles are a step; nothing arrives at the light itself",
     "mmp/pbrt-v4#130, appleseedhq/appleseed#1467", run});

}  // namespace
}  // namespace talbot::hardcases::l04
