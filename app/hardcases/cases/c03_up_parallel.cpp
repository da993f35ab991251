// C03: looking along the up vector, at oneself, and over the poles of an orbit.
#include <vector>

#include "app/hardcases/worst.h"
#include "core/math/robust.h"
#include "oracles/scene_builder.h"

namespace talbot::hardcases::c03 {
namespace {

struct Axes {
    Vec3d right{0}, up{0}, backward{0};
};

// Cross products without a thought for parallel vectors.
Axes naive_axes(const Vec3d& eye, const Vec3d& target) {
    Axes a;
    a.backward = normalize(eye - target);
    a.right = normalize(cross(Vec3d(0, 1, 0), a.backward));
    a.up = cross(a.backward, a.right);
    return a;
}

Axes axes_of(const Camera& camera) {
    return {camera.right, camera.up, camera.backward};
}

// Departure from a right-handed orthonormal frame, in units of float's roundoff.
double skew(const Axes& a) {
    Worst worst;
    worst.add(std::abs(dot(a.right, a.right) - 1));
    worst.add(std::abs(dot(a.up, a.up) - 1));
    worst.add(std::abs(dot(a.backward, a.backward) - 1));
    worst.add(std::abs(dot(a.right, a.up)));
    worst.add(std::abs(dot(a.right, a.backward)));
    worst.add(std::abs(dot(a.up, a.backward)));
    worst.add(length(cross(a.right, a.up) - a.backward));
    return worst.figure / static_cast<double>(kFloatEpsilon);
}

CaseResult run(Effort effort) {
    Worst naive, own;
    std::vector<double> angles{0};
    for (int exponent = -16; exponent <= -1; ++exponent) angles.push_back(std::pow(10.0, exponent));
    for (const double angle : angles) {
        for (const double pole : {-1.0, 1.0}) {
            for (int heading = 0; heading < 16; ++heading) {
                const double h = heading * 0.4;
                const Vec3d eye(std::sin(angle) * std::cos(h), pole * std::cos(angle),
                                std::sin(angle) * std::sin(h));
                Camera camera;
                look_at(camera, eye, Vec3d(0));
                const auto where = [&] {
                    return "angle " + std::to_string(angle) + " to the pole";
                };
                naive.add(skew(naive_axes(eye, Vec3d(0))), where);
                own.add(skew(axes_of(camera)), where);
            }
        }
    }
    Camera self;
    look_at(self, Vec3d(1, 2, 3), Vec3d(1, 2, 3));
    naive.add(skew(naive_axes(Vec3d(1, 2, 3), Vec3d(1, 2, 3))));
    own.add(skew(axes_of(self)), [] { return std::string("eye at the target"); });

    // An orbit over both poles in small steps: what turns more than the step allows is a jump.
    const int steps = effort == Effort::full ? 200000 : 20000;
    Worst jump, naive_jump, orbit_skew;
    Axes before{}, naive_before{};
    for (int i = 0; i <= steps; ++i) {
        Orbit orbit;
        orbit.theta_degrees = 30;
        orbit.phi_degrees = 360.0 * i / steps;
        const Axes a = axes_of(make_orbit_camera(orbit));
        const Axes n = naive_axes(a.backward, Vec3d(0));
        orbit_skew.add(skew(a), [&] { return "phi " + std::to_string(orbit.phi_degrees); });
        // Past a pole the world is upside down: the heading turns by half a turn at that one step,
        // and nowhere else.
        const bool at_pole = i % (steps / 2) <= 1;
        if (i > 0 && !at_pole) {
            const double allowed = 2 * std::numbers::pi / steps;
            const auto where = [&] { return "phi " + std::to_string(orbit.phi_degrees); };
            jump.add(length(a.right - before.right) / allowed, where);
            naive_jump.add(length(n.right - naive_before.right) / allowed, where);
        }
        before = a;
        naive_before = n;
    }

    WorkerPool pool(run_settings().threads);
    SceneBuilder builder;
    builder.mesh(SceneBuilder::quad(Vec3f(-2, 0, -2), Vec3f(0, 0, 4), Vec3f(4, 0, 0)),
                 builder.material(SceneBuilder::diffuse(0.5f)));
    builder.environment(Rgb(1));
    const auto scene = builder.build(pool);
    NonFiniteCount counts;
    double bad = 0;
    for (const Vec3d& eye : {Vec3d(0, 3, 0), Vec3d(0, -3, 0), Vec3d(0)}) {
        const Film film =
            render_film(scene, camera_at(eye, Vec3d(0)), {}, 16, 16, 2, pool, -1, &counts);
        for (const Rgb& c : film.image(false).rgb)
            bad += is_finite(c) && (max_component(c) > 0 || eye == Vec3d(0)) ? 0 : 1;
    }
    CaseResult result;
    result.measures.push_back({"departure from an orthonormal frame in roundoffs, views along up",
                               naive.figure, own.figure, 4, Gate::at_most, own.where});
    result.measures.push_back({"the same on an orbit over the poles", kNoControl, orbit_skew.figure,
                               4, Gate::at_most, orbit_skew.where});
    result.measures.push_back({"turn of the right vector off the poles over the orbit's step",
                               naive_jump.figure, jump.figure, 1, Gate::at_most, jump.where});
    result.measures.push_back(
        {"black or not finite pixels looking straight down, up and at oneself", kNoControl, bad, 0,
         Gate::at_most, ""});
    result.nonfinite = counts.total();
    return result;
}

const bool kAdded = add_case(
    {"C03", Priority::p0, "up parallel to the view, eye at the target", "normalised cross products",
     "another up where the sine is below 1e-6; orbits by their heading",
     "tylermorganwall/rayrender#7, g-truc/glm#881, toji/gl-matrix#503", run});

}  // namespace
}  // namespace talbot::hardcases::c03
