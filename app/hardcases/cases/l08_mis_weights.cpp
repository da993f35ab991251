// L08: weights of two strategies for densities from 1e-38 to infinity. Squares overflow and
// underflow.
#include "app/hardcases/cases/shading_setup.h"

namespace talbot::hardcases::l08 {
namespace {

float naive_heuristic(float a, float b) {
    return a * a / (a * a + b * b);
}

long double reference(float a, float b) {
    if (std::isinf(a) && std::isinf(b)) return 0.5L;
    if (std::isinf(a)) return 1;
    if (std::isinf(b)) return 0;
    const long double a2 = static_cast<long double>(a) * a;
    const long double b2 = static_cast<long double>(b) * b;
    return a2 / (a2 + b2);
}

CaseResult run(Effort effort) {
    const int steps = effort == Effort::full ? 2000 : 300;
    std::vector<float> densities{0, 0x1p-149f, 0x1p-126f, 3.4028235e38f, kInfinity};
    for (int i = 0; i <= steps; ++i)
        densities.push_back(static_cast<float>(std::pow(10.0, -38 + 76.5 * i / steps)));
    WorstError naive_sum, own_sum, naive_weight, own_weight;
    Sweep sweep{"density of both strategies", "weights' sum, off 1", true, 4 * 0x1p-24, {}};
    for (const float a : densities) {
        for (const float b : densities) {
            if (!(a > 0) && !(b > 0)) continue;
            const auto where = [&] { return exact(a) + " " + exact(b); };
            const auto judge = [&](WorstError& sum, WorstError& weight, float wa, float wb) {
                sum.add(std::abs(static_cast<double>(wa) + static_cast<double>(wb) - 1), where);
                weight.add(std::abs(static_cast<double>(wa - reference(a, b))), where);
            };
            judge(own_sum, own_weight, power_heuristic(a, b), power_heuristic(b, a));
            judge(naive_sum, naive_weight, naive_heuristic(a, b), naive_heuristic(b, a));
        }
        if (!(a > 0) || !is_finite(a)) continue;
        const auto off = [](float wa, float wb) {
            const double e = std::abs(static_cast<double>(wa) + static_cast<double>(wb) - 1);
            return is_finite(e) ? e : 1.0;
        };
        sweep.points.push_back({static_cast<double>(a),
                                off(naive_heuristic(a, 0.7f * a), naive_heuristic(0.7f * a, a)),
                                off(power_heuristic(a, 0.7f * a), power_heuristic(0.7f * a, a))});
    }
    std::sort(sweep.points.begin(), sweep.points.end(),
              [](const SweepPoint& x, const SweepPoint& y) { return x.parameter < y.parameter; });
    if (sweep.points.size() > 100) {
        std::vector<SweepPoint> some;
        for (std::size_t i = 0; i < sweep.points.size(); i += sweep.points.size() / 100)
            some.push_back(sweep.points[i]);
        sweep.points = some;
    }
    CaseResult result;
    result.measures.push_back({"sum of both weights, off 1", naive_sum.or_infinite(),
                               own_sum.or_infinite(), 4 * 0x1p-24, Gate::at_most, own_sum.where});
    result.measures.push_back({"a weight, off the exact one", naive_weight.or_infinite(),
                               own_weight.or_infinite(), 4 * 0x1p-24, Gate::at_most,
                               own_weight.where});
    result.sweeps.push_back(sweep);
    return result;
}

const bool kAdded = add_case(
    {"L08", Priority::p0, "MIS weights of extreme densities", "a^2 / (a^2 + b^2) in float",
     "the ratio of the smaller to the larger density is squared; infinity has its own answers",
     "crocdialer/vierkant#170", run});

}  // namespace
}  // namespace talbot::hardcases::l08
