// V02: Henyey and Greenstein's phase function for g from 0 to all but 1, forwards and backwards.
// The textbook divides a difference by g and takes the sine from the cosine.
#include "app/hardcases/cases/quad_float.h"
#include "app/hardcases/cases/shading_setup.h"
#include "core/scattering/henyey_greenstein.h"
#include "oracles/stats/chi2.h"
#include "oracles/stats/random.h"
#include "oracles/stats/ztest.h"

namespace talbot::hardcases::v02 {
namespace {

// 1 - cos of the turn from the forward peak (for g < 0 from the backward one) at quantile u, by the
// textbook's cosine in 113 bits.
Quad reference_turn(float g, float u) {
    const Quad a = g < 0 ? -Quad(g) : Quad(g);
    if (a < Quad(1e-12)) return 2 * (1 - Quad(u));
    const Quad s = (1 - a * a) / (1 - a + 2 * a * u);
    return 1 - (1 + a * a - s * s) / (2 * a);
}
// Probability of a turn of at most t.
double probability(float g, double turn) {
    const Quad a = g < 0 ? -Quad(g) : Quad(g);
    const Quad t = turn;
    if (a < Quad(1e-12)) return static_cast<double>(t / 2);
    const Quad cosine = 1 - t;
    const Quad u =
        (1 - a * a) / (2 * a) * (1 / square_root(1 + a * a - 2 * a * cosine) - 1 / (1 + a));
    return static_cast<double>(1 - u);
}
Quad reference_pdf(float g, Quad t) {
    const Quad a = g < 0 ? -Quad(g) : Quad(g);
    const Quad s = 1 + a * a - 2 * a * (1 - t);
    return (1 - a * a) / (4 * Quad(std::numbers::pi_v<long double>) * s * square_root(s));
}

// The turn of a direction against the z axis, with all its digits.
double turn_of(float g, const Vec3f& wi) {
    const double z = g < 0 ? -static_cast<double>(wi.z) : static_cast<double>(wi.z);
    const double r2 = static_cast<double>(wi.x) * static_cast<double>(wi.x) +
                      static_cast<double>(wi.y) * static_cast<double>(wi.y);
    return z > 0.5 ? r2 / (1 + std::sqrt(std::max(0.0, 1 - r2))) : 1 - z;
}

// The control: the textbook in float.
Vec3f naive_sample(float g, const Vec2f& u) {
    const float s = (1 - g * g) / (1 - g + 2 * g * u.x);
    const float cosine = (1 + g * g - s * s) / (2 * g);
    const float sine = std::sqrt(1 - cosine * cosine);
    return Vec3f(sine * std::cos(2 * kPi * u.y), sine * std::sin(2 * kPi * u.y), cosine);
}

struct Figures {
    WorstError turn, pdf;
    double nonfinite = 0;
};

std::vector<float> anisotropies() {
    std::vector<float> list{0,    1e-30f, 1e-8f,  1e-4f,   0.1f,     0.5f,     0.75f,
                            0.9f, 0.99f,  0.999f, 0.9999f, 0.99999f, 0.999999f};
    for (std::size_t i = list.size(); i-- > 1;) list.push_back(-list[i]);
    return list;
}

double evenness(float g, int draws, uint64_t seed, bool naive, double& mean_off) {
    const HenyeyGreenstein phase(g);
    constexpr std::size_t kBins = 64;
    std::vector<double> observed(kBins, 0.0);
    stats::Random random(case_seed(seed));
    stats::Moments cosine;
    for (int i = 0; i < draws; ++i) {
        const Vec2f u = random.pair();
        const Vec3f wi = naive ? naive_sample(g, u) : phase.sample(Vec3f(0, 0, 1), u);
        const double t = turn_of(g, wi);
        if (!is_finite(t)) continue;
        const double p = probability(g, t);
        ++observed[std::min(static_cast<std::size_t>(std::max(0.0, p) * kBins), kBins - 1)];
        cosine.add(g < 0 ? t - 1 : 1 - t);
    }
    mean_off = std::abs(cosine.mean() - static_cast<double>(g)) / cosine.standard_error();
    const std::vector<double> expected(kBins, static_cast<double>(draws) / kBins);
    return stats::chi2_test(observed, expected).p;
}

CaseResult run(Effort effort) {
    const bool full = effort == Effort::full;
    const int steps = full ? 20000 : 400;
    Figures naive;
    Figures own;
    Sweep sweep{"1 - |g|", "largest relative error of 1 - cos", true, 2e-6, {}};
    for (const float g : anisotropies()) {
        const HenyeyGreenstein phase(g);
        WorstError naive_here;
        WorstError own_here;
        for (int i = 0; i <= steps; ++i) {
            float x = static_cast<float>(i) / static_cast<float>(steps);
            if (i % 3 == 1) x = x * x * x * 1e-3f;
            if (i == steps) x = kOneMinusEpsilon;
            const Quad t = reference_turn(g, x);
            const auto where = [&] { return "g " + exact(g) + " u " + exact(x); };
            const Vec3f wi = phase.sample(Vec3f(0, 0, 1), Vec2f(x, 0));
            const double error = relative(turn_of(g, wi), static_cast<long double>(t));
            own.turn.add(error, where);
            own_here.add(error);
            if (!is_finite(wi)) ++own.nonfinite;
            const Quad density = reference_pdf(g, Quad(turn_of(g, wi)));
            own.pdf.add(relative(static_cast<double>(phase.pdf(Vec3f(0, 0, 1), wi)),
                                 static_cast<long double>(density)),
                        where);
            const Vec3f n = naive_sample(g, Vec2f(x, 0));
            const double naive_error = relative(turn_of(g, n), static_cast<long double>(t));
            if (!is_finite(n)) ++naive.nonfinite;
            naive.turn.add(naive_error);
            naive_here.add(naive_error);
            const float c = g < 0 ? -wi.z : wi.z;
            const float a = std::abs(g);
            const float s = 1 + a * a - 2 * a * c;
            naive.pdf.add(relative(static_cast<double>((1 - a * a) / (4 * kPi * s * std::sqrt(s))),
                                   static_cast<long double>(density)));
        }
        if (g >= 0)
            sweep.points.push_back({1 - static_cast<double>(g),
                                    std::min(naive_here.or_infinite(), 10.0), own_here.value});
    }
    std::reverse(sweep.points.begin(), sweep.points.end());

    double p = 1;
    double naive_p = 1;
    WorstError mean;
    WorstError naive_mean;
    std::string where;
    for (const float g : {0.0f, 0.5f, -0.9f, 0.999f, 0.999999f, -0.999999f}) {
        const int draws = full ? 2000000 : 20000;
        double off = 0;
        const double here =
            confirmed_p(31, [&](uint64_t seed) { return evenness(g, draws, seed, false, off); });
        if (here < p) p = here, where = "g " + exact(g);
        mean.add(off, [&] { return "g " + exact(g); });
        naive_p = std::min(naive_p, evenness(g, draws, 31, true, off));
        naive_mean.add(off);
    }
    CaseResult result;
    result.measures.push_back({"relative error of 1 - cos at a quantile", naive.turn.or_infinite(),
                               own.turn.or_infinite(), 2e-6, Gate::at_most, own.turn.where});
    result.measures.push_back({"relative error of the density there", naive.pdf.or_infinite(),
                               own.pdf.or_infinite(), 2e-6, Gate::at_most, own.pdf.where});
    result.measures.push_back(
        {"directions that are not finite", naive.nonfinite, own.nonfinite, 0, Gate::at_most, ""});
    result.measures.push_back({"smallest p of chi-square over quantiles of 1 - cos", naive_p, p,
                               significance(), Gate::at_least, where});
    result.measures.push_back({"mean cosine off g, in standard errors", naive_mean.or_infinite(),
                               mean.or_infinite(), 4, Gate::at_most, mean.where});
    result.sweeps.push_back(sweep);
    return result;
}

const bool kAdded = add_case(
    {"V02", Priority::p0, "Henyey-Greenstein towards both ends", "the textbook's cosine in float",
     "1 - cos from a quotient of positive terms, the density from the difference of directions",
     "mmp/pbrt-v4#333, LuxCoreRender/LuxCore#550", run});

}  // namespace
}  // namespace talbot::hardcases::v02
