// S14: cosine-weighted directions at the ends of the unit square: the rim has z = 0, density 0 and
// a value of 0 / 0.
#include <numbers>

#include "app/hardcases/cases/shading_setup.h"
#include "core/math/warp.h"

namespace talbot::hardcases::s14 {
namespace {

// The same map, its height from what x and y leave.
Vec3f naive_sample(const Vec2f& u) {
    const Vec2f p = sample_concentric_disk(u);
    return Vec3f(p.x, p.y, std::sqrt(std::max(0.0f, 1 - p.x * p.x - p.y * p.y)));
}

struct Figures {
    double unusable = 0;
    WorstError length_error;

    void add(const Vec3f& w, const Vec2f& u) {
        // What an estimator forms of it: value over density, for a white diffuse surface.
        const float f_cos = w.z * kInvPi;
        const float weight = f_cos / pdf_cosine_hemisphere(w.z);
        if (!is_finite(w) || !is_finite(weight) || !(weight > 0)) ++unusable;
        length_error.add(std::abs(length(Vec3d(w)) - 1),
                         [&] { return "u " + exact(u.x) + " " + exact(u.y); });
    }
};

CaseResult run(Effort effort) {
    const int ends = effort == Effort::full ? 512 : 128;
    std::vector<float> line;
    float low = 0;
    float high = 1;
    for (int i = 0; i < ends; ++i) {
        line.push_back(low);
        line.push_back(high = next_float_down(high));
        low = next_float_up(low);
        // The grid that 24 random bits give, too.
        line.push_back(static_cast<float>(i) * 0x1p-24f);
        line.push_back((static_cast<float>(i) + 0.5f) / static_cast<float>(ends));
    }
    Figures naive;
    Figures own;
    for (const float x : line) {
        for (const float y : line) {
            naive.add(naive_sample({x, y}), {x, y});
            own.add(sample_cosine_hemisphere({x, y}), {x, y});
        }
    }
    CaseResult result;
    result.measures.push_back({"samples whose value over density is not usable", naive.unusable,
                               own.unusable, 0, Gate::at_most, ""});
    result.measures.push_back({"largest |length - 1|", naive.length_error.or_infinite(),
                               own.length_error.or_infinite(), 4 * 0x1p-24, Gate::at_most,
                               own.length_error.where});
    return result;
}

const bool kAdded =
    add_case({"S14", Priority::p0, "cosine hemisphere at the ends of [0, 1)",
              "z from 1 - x^2 - y^2", "concentric map with its exact 1 - r^2; z never zero",
              "mmp/pbrt-v4#313, mmp/pbrt-v2#22, RayTracing/raytracing.github.io#1021", run});

}  // namespace
}  // namespace talbot::hardcases::s14
