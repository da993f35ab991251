// S01: the GGX distribution near specular. cos^2 (a^2 - 1) + 1 cancels where all of the lobe lies.
#include <numbers>

#include "app/hardcases/cases/quad_float.h"
#include "app/hardcases/cases/shading_setup.h"
#include "core/scattering/ggx.h"

namespace talbot::hardcases::s01 {
namespace {

Quad reference(float ax, float ay, const Vec3f& h) {
    const Quad x = Quad(h.x) / ax;
    const Quad y = Quad(h.y) / ay;
    const Quad q = x * x + y * y + Quad(h.z) * h.z;
    return 1 / (Quad(std::numbers::pi_v<long double>) * ax * ay * q * q);
}

// The textbook's forms: isotropic from the cosine, anisotropic from the tangent.
float textbook(float ax, float ay, const Vec3f& h) {
    const float cos2 = h.z * h.z;
    if (ax == ay) {
        const float a2 = ax * ax;
        const float t = cos2 * (a2 - 1) + 1;
        return a2 / (kPi * t * t);
    }
    const float tan2 = (1 - cos2) / cos2;
    const float cos2_phi = h.x * h.x / (h.x * h.x + h.y * h.y);
    const float e = tan2 * (cos2_phi / (ax * ax) + (1 - cos2_phi) / (ay * ay));
    return 1 / (kPi * ax * ay * cos2 * cos2 * (1 + e) * (1 + e));
}

CaseResult run(Effort effort) {
    const int steps = effort == Effort::full ? 400 : 40;
    CaseResult result;
    Sweep sweep{"alpha", "largest relative error of D", true, 2e-6, {}};
    WorstError naive;
    WorstError own;
    const auto clamp = [](double a) { return static_cast<float>(std::clamp(a, 1e-4, 1.0)); };
    for (int i = 0; i <= steps; ++i) {
        const double alpha = std::pow(10.0, -4 + 4.0 * i / steps);
        WorstError naive_here;
        WorstError own_here;
        for (int k = -3; k <= 3; ++k) {
            const float ax = clamp(alpha * std::pow(10.0, 0.5 * k));
            const float ay = clamp(alpha * std::pow(10.0, -0.5 * k));
            for (int j = 0; j <= 160; ++j) {
                const double theta = std::min(0.25 * j * std::min<double>(ax, ay), 1.57);
                const double phi = 0.1 + 0.7 * j;
                const Vec3f h(Vec3d(std::sin(theta) * std::cos(phi),
                                    std::sin(theta) * std::sin(phi), std::cos(theta)));
                const Quad d = reference(ax, ay, h);
                const auto judge = [&](WorstError& total, WorstError& here, float value) {
                    const double error = is_finite(value)
                                             ? std::abs(static_cast<double>((value - d) / d))
                                             : std::numeric_limits<double>::infinity();
                    total.add(error, [&] {
                        return "alpha " + exact(ax) + " " + exact(ay) + " h " + exact(h);
                    });
                    here.add(error);
                };
                judge(naive, naive_here, textbook(ax, ay, h));
                judge(own, own_here, Ggx(ax, ay).d(h));
            }
        }
        sweep.points.push_back({alpha, naive_here.value, own_here.value});
    }
    result.measures.push_back(
        {"largest relative error of D", naive.value, own.value, 2e-6, Gate::at_most, own.where});
    result.measures.push_back({"values not finite", static_cast<double>(naive.nonfinite),
                               static_cast<double>(own.nonfinite), 0, Gate::at_most, ""});
    result.sweeps.push_back(sweep);
    return result;
}

const bool kAdded = add_case(
    {"S01", Priority::p0, "GGX distribution near specular", "D from the cosine of the normal alone",
     "D from (x / ax)^2 + (y / ay)^2 + z^2, only positive terms",
     "gkjohnson/three-gpu-pathtracer#161, armory3d/armory#2880, bevyengine/bevy#21921", run});

}  // namespace
}  // namespace talbot::hardcases::s01
