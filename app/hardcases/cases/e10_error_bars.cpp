// E10: the printed error must hold the truth, and say so where it cannot; nothing is clamped in
// silence.
#include <vector>

#include "app/hardcases/worst.h"
#include "core/accuracy/error_estimate.h"
#include "core/film/film.h"
#include "core/math/sample_bits.h"
#include "tests/synthetic_render.h"

namespace talbot::hardcases::e10 {
namespace {

constexpr uint32_t kSide = 32;
constexpr uint64_t kSamples = 64;

// Sample deviation of each pixel over the root of its samples, as if they were independent.
struct IndependentError {
    std::vector<double> sum, square;

    double percent(const synthetic::Picture& picture, uint64_t n) const {
        double total = 0;
        const auto count = static_cast<double>(n);
        for (std::size_t p = 0; p < sum.size(); ++p) {
            const double mean = sum[p] / count;
            const double variance = (square[p] / count - mean * mean) / (count - 1);
            total += variance / (mean * mean + 0.01);
        }
        return 100 * std::sqrt(total / static_cast<double>(picture.size * picture.size));
    }
};

struct Coverage {
    double inside = 0, above = 0, naive_inside = 0, claims = 0;
};

// One picture of each seed: whether the truth lies in the interval of the estimate, and in one of
// the same width round the error by sample deviations.
Coverage cover(const synthetic::Scene& scene, int seeds) {
    Coverage c;
    for (int seed = 0; seed < seeds; ++seed) {
        synthetic::Picture picture(
            scene, kSide, true,
            hash32(static_cast<uint32_t>(seed) + 1) ^ static_cast<uint32_t>(run_settings().seed));
        ErrorTracker tracker;
        tracker.reset(0);
        IndependentError independent;
        independent.sum.assign(kSide * kSide, 0);
        independent.square.assign(kSide * kSide, 0);
        std::vector<double> before(kSide * kSide, 0);
        for (uint64_t n = 1; n <= kSamples; ++n) {
            picture.render_until(n);
            tracker.observe(picture.film, n, static_cast<double>(n));
            for (std::size_t p = 0; p < before.size(); ++p) {
                const double total = picture.film.pixels()[p].sum[1].value();
                const double x = total - before[p];
                before[p] = total;
                independent.sum[p] += x;
                independent.square[p] += x * x;
            }
        }
        const ErrorEstimate e = tracker.estimate();
        if (e.trust != Trust::green) continue;
        const double truth = 100 * std::sqrt(picture.true_relmse());
        const double naive = independent.percent(picture, kSamples);
        c.inside += truth >= e.lo95 && truth <= e.hi95 ? 1 : 0;
        c.above += truth > e.hi95 ? 1 : 0;
        const double up = e.hi95 / e.relrmse_percent;
        c.naive_inside += truth >= naive / up && truth <= naive * up ? 1 : 0;
        ++c.claims;
    }
    return c;
}

// Pictures whose light is carried by events too rare to be seen in most renders, and how many of
// them are called trustworthy.
double trusted_fireflies(int seeds) {
    double trusted = 0;
    double pictures = 0;
    for (int seed = 0; seed < seeds; ++seed) {
        Draw draw(0xE10F00 + static_cast<uint64_t>(seed));
        Film film(kSide, kSide);
        ErrorTracker tracker;
        tracker.reset(0);
        NonFiniteCount counts;
        uint64_t fireflies = 0;
        for (uint64_t n = 1; n <= kSamples; ++n) {
            for (uint32_t y = 0; y < kSide; ++y) {
                for (uint32_t x = 0; x < kSide; ++x) {
                    const bool firefly = draw.unit() < 6e-5;
                    fireflies += firefly ? 1 : 0;
                    const double value = firefly ? 1e4 : 0.5 + draw.unit();
                    film.add(x, y, Rgb(static_cast<float>(value)), true, n, counts);
                }
            }
            tracker.observe(film, n, static_cast<double>(n));
        }
        if (fireflies == 0) continue;  // what was never seen cannot be flagged
        ++pictures;
        trusted += tracker.estimate().trust == Trust::green ? 1 : 0;
    }
    return trusted / pictures;
}

// Energy that the film takes from bright finite samples without counting it.
double removed_energy() {
    Film film(1, 1);
    NonFiniteCount counts;
    double sum = 0;
    for (uint64_t i = 0; i <= 40; ++i) {
        const float x = std::ldexp(1.0f, static_cast<int>(i));
        film.add(0, 0, Rgb(x), true, i, counts);
        sum += static_cast<double>(x);
    }
    return std::abs(film.pixels()[0].sum[0].value() - sum) / sum;
}

CaseResult run(Effort effort) {
    const bool full = effort == Effort::full;
    const int seeds = full ? 1000 : 24;
    Worst low, high, understated, smooth;
    double naive_least = 1;
    for (const synthetic::Scene& scene : synthetic::scenes()) {
        const Coverage c = cover(scene, seeds);
        if (c.claims < 0.5 * seeds) continue;  // heavy-tailed: the trust light was not green
        const double share = c.inside / c.claims;
        // What three standard errors of a share do not explain.
        const double slack = 3 * std::sqrt(0.95 * 0.05 / c.claims);
        const auto where = [&] { return std::string("picture ") + scene.name; };
        understated.add(std::max(0.0, c.above / c.claims - 0.025 - slack), where);
        const bool is_smooth = std::string(scene.name) == "smooth";
        (is_smooth ? smooth : low).add(std::max(0.0, 0.95 - share - slack), where);
        high.add(std::max(0.0, share - 0.95 - slack), where);
        naive_least = std::min(naive_least, c.naive_inside / c.claims);
    }
    CaseResult result;
    result.measures.push_back(
        {"shortfall of the coverage of 95 % intervals, beyond 3 standard errors",
         0.95 - naive_least, low.figure, 0.02, Gate::at_most, low.where});
    result.measures.push_back({"the same of a picture of nothing but smooth light", kNoControl,
                               smooth.figure, 0.02, Gate::at_most,
                               "its error is stated too high, never too low"});
    result.measures.push_back({"truths above the interval, beyond 2.5 % and 3 standard errors",
                               kNoControl, understated.figure, 0.02, Gate::at_most,
                               understated.where});
    result.measures.push_back({"excess of the coverage, beyond 3 standard errors", kNoControl,
                               high.figure, 0.02, Gate::at_most, high.where});
    result.measures.push_back({"share of firefly pictures called trustworthy", 1,
                               trusted_fireflies(full ? 200 : 20), 0.05, Gate::at_most, ""});
    result.measures.push_back({"energy of bright samples that is clamped unseen", kNoControl,
                               removed_energy(), 0, Gate::at_most, ""});
    return result;
}

const bool kAdded =
    add_case({"E10", Priority::p1, "error bars hold the truth, fireflies are flagged",
              "sample deviations as of independent samples; no trust light",
              "differences at powers of two, trust by the tail; no clamping", "", run});

}  // namespace
}  // namespace talbot::hardcases::e10
